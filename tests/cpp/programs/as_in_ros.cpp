// The right-hand sides of the tables in docs/coming-from-ros1.md and docs/coming-from-ros2.md.
#include <lcmtools/node.hpp>

#include <functional>

#include <geometry_msgs/Twist.hpp>
#include <sensor_msgs/JointState.hpp>
#include <sensor_msgs/LaserScan.hpp>
#include <std_srvs/Trigger_Request.hpp>
#include <std_srvs/Trigger_Response.hpp>

using namespace std::chrono_literals;

void hear(const std::shared_ptr<const geometry_msgs::Twist>&) {}
void answer(const std_srvs::Trigger_Request&, std_srvs::Trigger_Response& response) { response.success = true; }

// As with roscpp: a class beside the node.
class Brake {
 public:
  explicit Brake(lcmtools::Node& n) : node_(n) {
    scans_ = n.create_subscription<sensor_msgs::LaserScan>("scan", 1, std::bind(&Brake::brake, this, std::placeholders::_1));
    efforts_ = n.create_publisher<sensor_msgs::JointState>("efforts", 1);
  }

 private:
  void brake(const std::shared_ptr<const sensor_msgs::LaserScan>& scan) {
    last_ = scan;
    sensor_msgs::JointState m{};
    m.effort = {0, 0};
    m.effort_length = 2;
    efforts_->publish(m);
    node_.get_logger().info(lcmtools::format("%d", m.effort_length));
  }

  lcmtools::Node& node_;
  std::shared_ptr<const sensor_msgs::LaserScan> last_;
  lcmtools::SubscriptionBase::SharedPtr scans_;
  lcmtools::Publisher<sensor_msgs::JointState>::SharedPtr efforts_;
};

// As with rclcpp: a class that is the node.
class Turner : public lcmtools::Node {
 public:
  Turner() : Node("turner") {
    declare_parameter("gain", 1.0);
    this->create_service<std_srvs::Trigger_Request, std_srvs::Trigger_Response>("go", answer);
    timer_ = this->create_wall_timer(500ms, std::bind(&Turner::turn, this));
    turns_ = this->create_publisher<geometry_msgs::Twist>("turns", 10);
    heard_ = this->create_subscription<geometry_msgs::Twist>("turns", 10, [](std::shared_ptr<const geometry_msgs::Twist>) {});
  }

 private:
  void turn() {
    auto m = geometry_msgs::Twist();
    m.angular.z = get_parameter("gain").as_double();
    this->get_logger().info(lcmtools::format("%f", m.angular.z));
    turns_->publish(m);
  }

  lcmtools::Timer::SharedPtr timer_;
  lcmtools::Publisher<geometry_msgs::Twist>::SharedPtr turns_;
  lcmtools::Subscription<geometry_msgs::Twist>::SharedPtr heard_;
};

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::Node n("name");
  Brake brake(n);
  auto p = n.create_publisher<geometry_msgs::Twist>("t", 10);
  auto s = n.create_subscription<geometry_msgs::Twist>("t", 10, hear);
  double gain = n.declare_parameter("gain", 1.0);
  n.create_timer(500ms, [] {});
  lcmtools::Rate r(10);
  while (lcmtools::ok() && gain > 1.0) {
    p->publish(geometry_msgs::Twist{});
    lcmtools::spin_some(n);
    r.sleep();
  }
  lcmtools::spin(std::make_shared<Turner>());
  lcmtools::shutdown();
  return 0;
}
