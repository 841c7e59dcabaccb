// Drive the Dolly in a circle.
//
//     lcmtools msg generate --lang cpp types geometry_msgs
//     g++ moving_robot.cpp -Itypes $(lcmtools pkg cpp-path --flags) -o moving_robot
//     ./moving_robot
//
// It needs the simulator: lcmtools run sim --world dolly
// Look at it with   lcmtools hz /dolly/cmd_vel   and   lcmtools echo /dolly/odom
#include <lcmtools/node.hpp>

#include <geometry_msgs/Twist.hpp>

using namespace std::chrono_literals;

// Commands the same velocity again and again.
class MovingRobot : public lcmtools::Node {
 public:
  MovingRobot() : Node("moving_robot") {
#ifdef SKELETON
    // TODO 1: make a publisher of geometry_msgs::Twist on the topic /dolly/cmd_vel, with a queue of
    // 10, and keep it: publisher_ = create_publisher<TYPE>(TOPIC, QUEUE);

    // TODO 2: have timer_callback called every 500 ms: create_wall_timer(500ms, FUNCTION);
    // with [this] { timer_callback(); } as the function.
#else
    publisher_ = create_publisher<geometry_msgs::Twist>("/dolly/cmd_vel", 10);

    create_wall_timer(500ms, [this] { timer_callback(); });
#endif
  }

 private:
  // Publish one command.
  void timer_callback() {
    geometry_msgs::Twist message{};
#ifdef SKELETON
    // TODO 3: set the forward speed message.linear.x to 0.5 m/s and the turn rate
    // message.angular.z to 0.3 rad/s; what you do not set is 0.

    // TODO 4: log what you publish, with get_logger().info(TEXT), and publish the message with
    // publisher_->publish(message). lcmtools::format("%f", number) makes a text of a number.
    (void)message;  // remove this line
#else
    message.linear.x = 0.5;
    message.angular.z = 0.3;

    get_logger().info(lcmtools::format("Publishing: %.2f m/s, %.2f rad/s", message.linear.x, message.angular.z));
    publisher_->publish(message);
#endif
  }

  lcmtools::Publisher<geometry_msgs::Twist>::SharedPtr publisher_;
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::spin(std::make_shared<MovingRobot>());
}
