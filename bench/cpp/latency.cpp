// Measures the time from publish to callback at 1 kHz, and the receiver's processor time: of a program on
// plain liblcm, and of a node. The sender is a process of its own on plain liblcm.
//
//     g++ -O2 bench/cpp/latency.cpp $(lcmtools pkg cpp-path --flags) -o latency
//     ./latency plain; ./latency node
#include <lcmtools/node.hpp>

#include <sys/resource.h>
#include <sys/wait.h>

using Stamp = lcmtools::wire::Clock;  // any small message
constexpr int messages = 5000;
constexpr const char* channel = "/latency";

static void send_all() {
  lcm_t* lcm = lcm_create(nullptr);
  std::this_thread::sleep_for(std::chrono::seconds(1));  // until the receiver is there
  for (int i = 0; i < messages; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto now = lcmtools::detail::steady_now();
    Stamp stamp;
    stamp.sec = static_cast<std::int32_t>(now / 1'000'000'000), stamp.nsec = static_cast<std::int32_t>(now % 1'000'000'000);
    const auto payload = stamp.packed();
    lcm_publish(lcm, channel, payload.data(), static_cast<unsigned>(payload.size()));
  }
  lcm_destroy(lcm);
}

struct Measured {
  std::vector<double> latencies;  // [us]
  void add(const Stamp& stamp) {
    latencies.push_back(static_cast<double>(lcmtools::detail::steady_now() - stamp.sec * INT64_C(1'000'000'000) - stamp.nsec) / 1e3);
  }
  bool is_complete() const { return latencies.size() >= messages * 99 / 100; }
};

static void receive_plainly(Measured& measured) {
  lcm_t* lcm = lcm_create(nullptr);
  const auto take = [](const lcm_recv_buf_t* buffer, const char*, void* user) {
    Stamp stamp;
    if (stamp.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) > 0) static_cast<Measured*>(user)->add(stamp);
  };
  lcm_subscribe(lcm, channel, take, &measured);
  while (!measured.is_complete()) lcm_handle(lcm);
  lcm_destroy(lcm);
}

static void receive_in_node(Measured& measured, int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::Node node("latency");
  node.create_subscription<Stamp>(channel, 10, [&](const Stamp& stamp) {
    measured.add(stamp);
    if (measured.is_complete()) lcmtools::detail::current_context()->stop();
  });
  lcmtools::spin(node);
}

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "node";
  const pid_t sender = ::fork();
  if (sender == 0) return send_all(), 0;
  Measured measured;
  if (mode == "plain") receive_plainly(measured);
  else receive_in_node(measured, argc, argv);
  rusage used = {};
  ::getrusage(RUSAGE_SELF, &used);
  auto& all = measured.latencies;
  std::sort(all.begin(), all.end());
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6; };
  std::printf("%s: median %.1f us, 99 %% below %.1f us; %.1f us of processor time a message\n", mode.c_str(), all[all.size() / 2],
              all[all.size() * 99 / 100], (seconds(used.ru_utime) + seconds(used.ru_stime)) / static_cast<double>(all.size()) * 1e6);
  ::waitpid(sender, nullptr, 0);
}
