// Publish a text ten times a second.
//
//     lcmtools msg generate --lang cpp types std_msgs
//     g++ talker.cpp -Itypes $(lcmtools pkg cpp-path --flags) -o talker
//     ./talker
//
// Look at it with   lcmtools echo /chatter
#include <lcmtools/node.hpp>

#include <std_msgs/String.hpp>

using namespace std::chrono_literals;

// Publishes a text with a number that counts up.
class Talker : public lcmtools::Node {
 public:
  Talker() : Node("talker") {
#ifdef SKELETON
    // TODO 1: make a publisher of std_msgs::String on the topic chatter, with a queue of 10, and
    // keep it: publisher_ = create_publisher<TYPE>(TOPIC, QUEUE);

    // TODO 2: have timer_callback called every 100 ms: create_wall_timer(100ms, FUNCTION);
    // with [this] { timer_callback(); } as the function.
#else
    publisher_ = create_publisher<std_msgs::String>("chatter", 10);

    create_wall_timer(100ms, [this] { timer_callback(); });
#endif
  }

 private:
  // Publish one text.
  void timer_callback() {
    std_msgs::String message{};
#ifdef SKELETON
    // TODO 3: set message.data to "hello world " and the number std::to_string(count_), log it with
    // get_logger().info(TEXT), and publish it with publisher_->publish(message).
#else
    message.data = "hello world " + std::to_string(count_);
    get_logger().info(message.data);
    publisher_->publish(message);
#endif
    ++count_;
  }

  int count_ = 0;
  lcmtools::Publisher<std_msgs::String>::SharedPtr publisher_;
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::spin(std::make_shared<Talker>());
}
