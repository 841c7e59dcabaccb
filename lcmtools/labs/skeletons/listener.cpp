// Log the texts of the talker.
//
//     lcmtools msg generate --lang cpp types std_msgs
//     g++ listener.cpp -Itypes $(lcmtools pkg cpp-path --flags) -o listener
//     ./listener
//
// It needs a talker beside it: lcmtools run talker
// Without one, publish a text yourself: lcmtools pub -1 /chatter std_msgs/String hello
#include <lcmtools/node.hpp>

#include <std_msgs/String.hpp>

// Logs the texts that it receives.
class Listener : public lcmtools::Node {
 public:
  Listener() : Node("listener") {
#ifdef SKELETON
    // TODO 1: subscribe to std_msgs::String on the topic chatter, with a queue of 10, so that
    // chatter_callback is called with each message: create_subscription<TYPE>(TOPIC, QUEUE, FUNCTION);
    // with [this](const std_msgs::String& message) { chatter_callback(message); } as the function.
#else
    create_subscription<std_msgs::String>(
        "chatter", 10, [this](const std_msgs::String& message) { chatter_callback(message); });
#endif
  }

 private:
  // Log one text.
  void chatter_callback(const std_msgs::String& message) {
#ifdef SKELETON
    // TODO 2: log message.data with get_logger().info(TEXT).
    (void)message;  // remove this line
#else
    get_logger().info("I heard: [" + message.data + "]");
#endif
  }
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::spin(std::make_shared<Listener>());
}
