// Drive the Dolly in a circle (skeleton).
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
    // TODO 1: make a publisher of geometry_msgs::Twist on the topic /dolly/cmd_vel, with a queue of
    // 10, and keep it: publisher_ = create_publisher<TYPE>(TOPIC, QUEUE);

    // TODO 2: have timer_callback called every 500 ms: create_wall_timer(500ms, FUNCTION);
    // with [this] { timer_callback(); } as the function.
  }

 private:
  // Publish one command.
  void timer_callback() {
    geometry_msgs::Twist message{};
    // TODO 3: set the forward speed message.linear.x to 0.5 m/s and the turn rate
    // message.angular.z to 0.3 rad/s; what you do not set is 0.

    // TODO 4: log what you publish, with get_logger().info(TEXT), and publish the message with
    // publisher_->publish(message). lcmtools::format("%f", number) makes a text of a number.
    (void)message;  // remove this line
  }

  lcmtools::Publisher<geometry_msgs::Twist>::SharedPtr publisher_;
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::spin(std::make_shared<MovingRobot>());
}
