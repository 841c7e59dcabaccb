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
    publisher_ = create_publisher<geometry_msgs::Twist>("/dolly/cmd_vel", 10);

    create_wall_timer(500ms, [this] { timer_callback(); });
  }

 private:
  // Publish one command.
  void timer_callback() {
    geometry_msgs::Twist message{};
    message.linear.x = 0.5;
    message.angular.z = 0.3;

    get_logger().info(lcmtools::format("Publishing: %.2f m/s, %.2f rad/s", message.linear.x, message.angular.z));
    publisher_->publish(message);
  }

  lcmtools::Publisher<geometry_msgs::Twist>::SharedPtr publisher_;
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::spin(std::make_shared<MovingRobot>());
}
