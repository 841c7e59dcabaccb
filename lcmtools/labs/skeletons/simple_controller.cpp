// Make the Husky drive at a desired velocity, by the efforts of its wheels.
//
//     lcmtools msg generate --lang cpp types geometry_msgs nav_msgs sensor_msgs
//     g++ simple_controller.cpp -Itypes $(lcmtools pkg cpp-path --flags) -o simple_controller
//     ./simple_controller __ns:=/husky0 controlled_velocity:=velocity_cmd
//
// It needs the simulator and a desired velocity:
//     lcmtools run sim --world husky
//     lcmtools pub /husky0/desired_velocity geometry_msgs/Twist "linear: [0.1, 0, 0]"
//     lcmtools wtf
//
// The topics' names have no slash in front: with __ns:=/husky0 they are below /husky0.
#include <lcmtools/node.hpp>

#include <geometry_msgs/Twist.hpp>
#include <nav_msgs/Odometry.hpp>
#include <sensor_msgs/JointState.hpp>

// Controls the velocity of a robot with wheels at its two sides.
class SimpleController : public lcmtools::Node {
 public:
  SimpleController() : Node("simple_controller") {
    publisher_ = create_publisher<sensor_msgs::JointState>("controlled_velocity", 10);
    create_subscription<nav_msgs::Odometry>(
        "odometry", 1, [this](const nav_msgs::Odometry& odometry) { odometry_callback(odometry); });
    create_subscription<geometry_msgs::Twist>(
        "desired_velocity", 1, [this](const geometry_msgs::Twist& twist) { desired_velocity_callback(twist); });
  }

  // Command the wheels: each effort from -1 to 1.
  void publish_efforts(double left, double right) {
    sensor_msgs::JointState message{};
    message.name = {"left", "right"};
    message.name_length = 2;  // an array's length is a field of its own
    message.effort = {left, right};
    message.effort_length = 2;
    publisher_->publish(message);
  }

 private:
  // Take a new desired velocity.
  void desired_velocity_callback(const geometry_msgs::Twist& twist) {
#ifdef SKELETON
    // TODO 1: keep it for odometry_callback.
    (void)twist;  // remove this line
#else
    desired_ = twist;
#endif
  }

  // Compare how the robot moves with how it should, and command the wheels.
  void odometry_callback(const nav_msgs::Odometry& odometry) {
    double left = 0.0, right = 0.0;
#ifdef SKELETON
    // TODO 2: compute the errors: desired minus measured, for the forward speed
    // odometry.twist.twist.linear.x [m/s] and the turn rate odometry.twist.twist.angular.z [rad/s].
    (void)odometry;  // remove this line

    // TODO 3: from the errors, compute the efforts of the left and the right wheels, each from
    // -1 (full power backward) to 1. Both wheels together change the speed, their difference
    // the turn rate: to turn left, the right wheels have to be the faster ones. Begin with a
    // proportional controller (effort = gain * error). Does the robot get as fast as it
    // should? Add what is missing: the sum of the errors so far, times a small gain.
#else
    const double speed_error = desired_.linear.x - odometry.twist.twist.linear.x;
    const double turn_error = desired_.angular.z - odometry.twist.twist.angular.z;

    speed_effort_ += speed_gain * speed_error;  // sums of the errors: no error is left in the end
    turn_effort_ += turn_gain * turn_error;
    const double drive = speed_effort_ + 0.8 * speed_error;
    const double steer = turn_effort_ + 0.4 * turn_error;
    left = std::clamp(drive - steer, -1.0, 1.0);
    right = std::clamp(drive + steer, -1.0, 1.0);
#endif
    publish_efforts(left, right);
  }

#ifndef SKELETON
  static constexpr double speed_gain = 0.1, turn_gain = 0.05;  // effort per error, at each odometry message
  double speed_effort_ = 0.0, turn_effort_ = 0.0;
#endif
  geometry_msgs::Twist desired_{};  // the velocity desired; 0 at first
  lcmtools::Publisher<sensor_msgs::JointState>::SharedPtr publisher_;
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  const auto controller = std::make_shared<SimpleController>();
  lcmtools::spin(controller);
  controller->publish_efforts(0.0, 0.0);  // or the robot goes on with the last ones
}
