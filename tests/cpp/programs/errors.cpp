// Makes one Error of the headers in one place: errors CASE early|main|constructor|thread|timer
#include <lcmtools/node.hpp>

#include <std_msgs/Float64MultiArray.hpp>
#include <std_msgs/String.hpp>
#include <std_srvs/SetBool_Request.hpp>
#include <std_srvs/SetBool_Response.hpp>

using namespace std::chrono_literals;
using lcmtools::Node;
using std_msgs::Float64MultiArray;
using std_msgs::String;
using std_srvs::SetBool_Request;
using std_srvs::SetBool_Response;

static const std::string too_long(70, 'x');
static const std::map<std::string, void (*)(Node&)> cases = {
    {"unknown", [](Node& n) { n.get_parameter("gian"); }},
    {"twice", [](Node& n) { n.declare_parameter("gain", 1.0); }},
    {"kind", [](Node& n) { n.get_parameter("gain").as_int(); }},
    {"list", [](Node& n) { n.declare_parameter("names", std::vector<std::string>{}), n.get_parameter("names").as_double(); }},
    {"range", [](Node& n) { n.declare_parameter("speed", 5.0, {"[m/s]", 0.0, 1.0}); }},
    {"lines", [](Node& n) { n.get_parameter("a\nb\033[2J"); }},
    {"topic", [](Node& n) { n.create_publisher<String>("a b"); }},
    {"empty", [](Node& n) { n.create_publisher<String>(""); }},
    {"long", [](Node& n) { n.create_subscription<String>(too_long, 1, [](const String&) {}); }},
    {"plain", [](Node& n) { n.create_publisher<String>(lcmtools::plain_channel(too_long)); }},
    {"service", [](Node& n) { n.create_service<SetBool_Request, SetBool_Response>(too_long, [](auto&, auto&) {}); }},
    {"client", [](Node& n) { n.create_client<SetBool_Request, SetBool_Response>(too_long.substr(0, 60)); }},
    {"period", [](Node& n) { n.create_wall_timer(0s, [] {}); }},
    {"rate", [](Node&) { lcmtools::Rate rate(0); }},
    {"node", [](Node&) { Node other("a b"); }},
    {"init", [](Node&) { lcmtools::init(0, nullptr); }},
    {"nobody", [](Node& n) { n.create_client<SetBool_Request, SetBool_Response>("nobody")->call({}, 100ms); }},
    {"length", [](Node& n) {
       Float64MultiArray array{};
       array.data = {1.0, 1.0};
       n.create_publisher<Float64MultiArray>("array")->publish(array);
     }},
    {"nested", [](Node& n) {
       Float64MultiArray array{};
       array.layout.dim_length = 3;
       n.create_publisher<Float64MultiArray>("array")->publish(array);
     }},
    {"idle", [](Node& n) {
       n.create_service<SetBool_Request, SetBool_Response>("own", [](auto&, auto&) {});
       n.create_client<SetBool_Request, SetBool_Response>("own")->call({}, 100ms);
     }},
};

class Faulty : public Node {
 public:
  explicit Faulty(const std::string& where) : Node("faulty"), where_(where) {
    declare_parameter("gain", 1.0);
    if (where == "constructor") fault();
    if (where == "timer") create_wall_timer(50ms, [this] { fault(); });
  }
  void fault() { cases.at(name)(*this); }
  static inline std::string name;

 private:
  std::string where_;
};

int main(int argc, char** argv) {
  Faulty::name = argv[1];
  const std::string where = argv[2];
  if (where == "early") Faulty{where};
  lcmtools::init(argc, argv);
  const auto node = std::make_shared<Faulty>(where);
  std::thread thread;
  if (where == "main") node->fault();
  if (where == "thread") thread = std::thread([&] { node->fault(); });
  lcmtools::spin(node);
}
