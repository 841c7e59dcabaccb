// Publishes from two threads, as a node and its announcements do.
#include <lcmtools/node.hpp>
#include <thread>

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::Node node("two_threads");
  const auto talk = [&node] {
    for (int n = 0; n < 3000; ++n) node.context()->publish("/words", "whole", 5);
  };
  std::thread other(talk);
  talk();
  other.join();
}
