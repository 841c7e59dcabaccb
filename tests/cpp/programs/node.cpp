// A node with one of everything.
#include <lcmtools/node.hpp>

#include <geometry_msgs/Twist.hpp>
#include <std_msgs/String.hpp>
#include <std_srvs/SetBool_Request.hpp>
#include <std_srvs/SetBool_Response.hpp>

using namespace std::chrono_literals;
using std_msgs::String;

class Everything : public lcmtools::Node {
 public:
  Everything() : Node("everything") {
    gain_ = declare_parameter("gain", 1.0, {"[1/s] of the controller", 0.0, 10.0});
    declare_parameter("names", std::vector<std::string>{"a", "b c"});
    declare_parameter("count", 3);
    declare_parameter("frame", "base_link");
    add_on_set_parameters_callback([](const std::vector<lcmtools::Parameter>& changes) {
      return changes[0].get_name() == "count" && changes[0].as_int() == 13 ? "13 is unlucky" : "";
    });
    publisher_ = create_publisher<String>("echo", 10);
    twist_ = create_publisher<geometry_msgs::Twist>(lcmtools::plain_channel("PLAIN"), 1);
    create_subscription<String>("words", 2, [this](const String& message) { take(message); });
    create_subscription<String>(lcmtools::plain_channel("WORDS.*"), 2, [this](std::shared_ptr<const String> message) { take(*message); });
    create_timer(100ms, [this] { twist_->publish({}); });
    create_service<std_srvs::SetBool_Request, std_srvs::SetBool_Response>("refuse", [this](const auto& request, auto& response) {
      if (!request.data) throw lcmtools::Error("it must be true");
      response.success = true;
      response.message = lcmtools::format("gain %g", get_parameter("gain").as_double());
    });
    client_ = create_client<std_srvs::SetBool_Request, std_srvs::SetBool_Response>("other");
    create_subscription<String>("ask", 1, [this](const String& message) {
      std_srvs::SetBool_Request request{};
      request.data = message.data == "true";
      reply(client_->call(request, 5s).message);
    });
    get_logger().info(lcmtools::format("gain %g", gain_));
  }

 private:
  void take(const String& message) {
    if (message.data == "hang") {
      reply("hangs");
      std::this_thread::sleep_for(60s);
    }
    if (message.data == "log") {
      for (int i = 0; i < 3; ++i) {
        get_logger().warn("seldom", lcmtools::throttle(1h));
        get_logger().error("single", lcmtools::once);
        get_logger().info("always");
      }
    }
    if (message.data == "rate") {
      const auto start = std::chrono::steady_clock::now();
      lcmtools::Rate rate(20);
      rate.sleep(), rate.sleep();
      reply(std::chrono::steady_clock::now() - start >= 100ms ? "two turns" : "too early");
    }
    if (message.data == "throw") throw std::out_of_range("no such word");
    reply(lcmtools::format("%s at %.1f", message.data.c_str(), static_cast<double>(now()) / 1e9));
  }
  void reply(const std::string& text) {
    String message;
    message.data = text;
    publisher_->publish(message);
  }

  double gain_;
  lcmtools::Publisher<String>::SharedPtr publisher_;
  lcmtools::Publisher<geometry_msgs::Twist>::SharedPtr twist_;
  lcmtools::Client<std_srvs::SetBool_Request, std_srvs::SetBool_Response>::SharedPtr client_;
};

// Call the node's own service, which can only be answered meanwhile.
static void call_itself(Everything& node) {
  std_srvs::SetBool_Request request{};
  auto own = node.create_client<std_srvs::SetBool_Request, std_srvs::SetBool_Response>("refuse");
  auto refused = own->call_async(request);
  request.data = true;
  auto answered = own->async_send_request(request);
  if (lcmtools::spin_until_future_complete(node, answered) != lcmtools::FutureReturnCode::SUCCESS) return;
  std::puts(answered.get().message.c_str());
  try {
    refused.get();
  } catch (const lcmtools::Error& error) {
    std::puts(error.what());
  }
  auto nobody = node.create_client<std_srvs::SetBool_Request, std_srvs::SetBool_Response>("nobody")->call_async(request);
  if (lcmtools::spin_until_future_complete(node, nobody, 100ms) == lcmtools::FutureReturnCode::TIMEOUT) std::puts("timeout"), std::fflush(stdout);
  if (lcmtools::spin_until_future_complete(node, nobody) == lcmtools::FutureReturnCode::INTERRUPTED) std::puts("interrupted");
  else std::puts(nobody.get().message.c_str()), std::fflush(stdout);
}

int main(int argc, char** argv) {
  const auto words = lcmtools::init(argc, argv);
  const auto node = std::make_shared<Everything>();
  if (!words.empty() && words[0] == "call") call_itself(*node);
  lcmtools::spin(node);
  std::puts("spun");
}
