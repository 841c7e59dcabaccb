// Drive the Pioneer by keys.
//
//     lcmtools msg generate --lang cpp types geometry_msgs
//     g++ pioneer_manual_controller.cpp -Itypes $(lcmtools pkg cpp-path --flags) -o pioneer_manual_controller
//     ./pioneer_manual_controller
//
// It needs the simulator: lcmtools run sim --world pioneer
//
//     u i o    forward left, forward, forward right     q / z   both speeds 10 % more / less
//     j k l    turn left, stop, turn right              w / x   forward speed 10 % more / less
//     m , .    backward: clockwise, straight,           e / c   turn rate 10 % more / less
//              counter-clockwise
#include <poll.h>
#include <termios.h>

#include <lcmtools/node.hpp>

#include <geometry_msgs/Twist.hpp>

// Reads single keys from the terminal, without Enter. This is complete.
class Keyboard {
 public:
  Keyboard() {
    if (tcgetattr(STDIN_FILENO, &before_) != 0) return;  // the keys come from a pipe
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C ends the program as usual
    is_set_ = tcsetattr(STDIN_FILENO, TCSANOW, &now) == 0;
  }
  ~Keyboard() {
    if (is_set_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }

  // Wait 50 ms for the next key; return 0 if none comes.
  char next() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char key = 0;
    if (poll(&input, 1, 50) == 1 && read(STDIN_FILENO, &key, 1) != 1) is_over = true;
    return key;
  }

  bool is_over = false;  // no more keys will come

 private:
  termios before_{};
  bool is_set_ = false;
};

// Publishes the velocity that the keys set.
class PioneerManualController : public lcmtools::Node {
 public:
  PioneerManualController() : Node("pioneer_manual_controller") {
    publisher_ = create_publisher<geometry_msgs::Twist>("/RosAria/cmd_vel", 10);
  }

  // Apply a key, and publish the velocity.
  void take_key(char keyboard_input) {
#ifdef SKELETON
    // TODO 1: find out what keyboard_input is for each key.
    get_logger().info(lcmtools::format("key '%c', ASCII code %d", keyboard_input, keyboard_input));  // remove this line

    // TODO 2: for the keys i , j l u o m . and k, set cmdvel_.linear.x [m/s] (negative is backward)
    // and cmdvel_.angular.z [rad/s] (positive is to the left). The other fields stay 0: the Pioneer
    // cannot drive sideways, or fly. Which way does its nose turn when it drives backward with 'm'?

    // TODO 3: for the keys q z w x e c, change speed_ and turn_ by 10 %. The robot should go on as
    // it was, at the new speed.
#else
    switch (keyboard_input) {
      case 'i': set_way(1, 0); break;
      case ',': set_way(-1, 0); break;
      case 'j': set_way(0, 1); break;
      case 'l': set_way(0, -1); break;
      case 'u': set_way(1, 1); break;
      case 'o': set_way(1, -1); break;
      case 'm': set_way(-1, -1); break;
      case '.': set_way(-1, 1); break;
      case 'q': change_speeds(1.1, 1.1); break;
      case 'z': change_speeds(0.9, 0.9); break;
      case 'w': change_speeds(1.1, 1.0); break;
      case 'x': change_speeds(0.9, 1.0); break;
      case 'e': change_speeds(1.0, 1.1); break;
      case 'c': change_speeds(1.0, 0.9); break;
      default: set_way(0, 0);
    }
    cmdvel_.linear.x = forward_ * speed_;
    cmdvel_.angular.z = left_ * turn_;
#endif

    publisher_->publish(cmdvel_);
  }

  // Stop the robot: it would go on with the last command.
  void stop() { publisher_->publish(geometry_msgs::Twist{}); }

 private:
#ifndef SKELETON
  // Set the direction of motion: forward (1) or backward (-1), and left (1) or right (-1).
  void set_way(int forward, int left) { forward_ = forward, left_ = left; }
  void change_speeds(double speed_factor, double turn_factor) {
    speed_ *= speed_factor;
    turn_ *= turn_factor;
  }

  int forward_ = 0, left_ = 0;
#endif
  lcmtools::Publisher<geometry_msgs::Twist>::SharedPtr publisher_;
  double speed_ = 0.5;             // [m/s], what the keys drive at
  double turn_ = 1.0;              // [rad/s], what the keys turn at
  geometry_msgs::Twist cmdvel_{};  // what is published; all its fields are 0 at first
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  PioneerManualController controller;
  Keyboard keyboard;
  while (lcmtools::ok() && !keyboard.is_over) {
    if (const char key = keyboard.next()) controller.take_key(key);
    lcmtools::spin_some(controller);
  }
  controller.stop();
}
