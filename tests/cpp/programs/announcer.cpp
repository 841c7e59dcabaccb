// announcer.c in C++11.
#include <lcmtools/announcer.hpp>

#include <csignal>

namespace sensors {
struct scan_t {
  static std::int64_t getHash() { return static_cast<std::int64_t>(0x8123456789abcdef); }
};
}  // namespace sensors
struct cmd_t {
  static std::int64_t getHash() { return 5; }
};

static void on_signal(int) {}

int main(int argc, char** argv) {
  const std::string mode = argv[2], url = argc > 3 ? argv[3] : "";
  lcm::LCM lcm(url);
  lcmtools::Announcer announcer(lcm, argv[1], url);
  announcer.publishes<sensors::scan_t>("SCAN");
  if (mode == "listen") announcer.subscribes<cmd_t>("CMD.\"");
  std::signal(SIGUSR1, on_signal);
  std::puts("ready");
  std::fflush(stdout);
  while (mode == "listen" && lcm.handle() == 0) continue;
  ::pause();
  if (mode == "exit") std::exit(3);  // without the announcer's end
}
