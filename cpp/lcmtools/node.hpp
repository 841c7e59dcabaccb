// Nodes in C++ for LCM, in the taste of rclcpp: named, with a namespace and remaps, seen by lcmtools
// list, info, wtf, node, param and service as nodes in Python are. docs/cpp.md describes them.
//
//     #include <lcmtools/node.hpp>
//
//     int main(int argc, char** argv) {
//       lcmtools::init(argc, argv);
//       lcmtools::Node node("listener");
//       node.create_subscription<std_msgs::String>("chatter", 10, [&](const std_msgs::String& message) {
//         node.get_logger().info("I heard " + message.data);
//       });
//       lcmtools::spin(node);
//     }
//
// Types come from lcm-gen (lcmtools msg generate --lang cpp). C++17; liblcm is the only dependency.
#pragma once

#include "lcmtools/parameters.hpp"
#include "lcmtools/service.hpp"
#include "lcmtools/timer.hpp"

namespace lcmtools {

// A topic's name: resolved in the node's namespace, or an exact LCM channel.
struct Topic {
  std::string name;
  bool is_plain = false;
  Topic(const char* text) : name(text) {}
  Topic(std::string text) : name(std::move(text)) {}
  Topic(std::string text, bool plain) : name(std::move(text)), is_plain(plain) {}
};
inline Topic plain_channel(const std::string& name) { return {name, true}; }

// A named participant on the bus. Names are resolved by the ROS rules: "/a" is global, "a" is in the
// node's namespace, "~a" below the node itself; then the remaps of the command line apply.
class Node : public Parameters {
 public:
  using SharedPtr = std::shared_ptr<Node>;
  using Place = detail::Place;

  explicit Node(const std::string& name, const std::string& ns = "") {
    const auto& said = context_->arguments;
    const bool is_first = std::exchange(context_->is_first, false);
    name_ = is_first && !said.name.empty() ? said.name : name;
    names::check_base_name(name_);
    resolver_.ns = names::resolve_namespace(!said.ns.empty() ? said.ns : !ns.empty() ? ns : context_->ns);
    resolver_.node = node_->name = names::check_length(names::resolve(resolver_.ns + "/" + name_));
    resolver_.remaps = said.remaps;
    auto rosout = make_end<detail::Sender, wire::Log>(wire::PUBLISHER, resolve_name("/rosout"), 100, context_);
    logger_ = std::make_unique<Logger>(node_->name, std::move(rosout), [this] { return now(); });
    errors_ = std::make_unique<detail::Errors>(*context_, *node_, *logger_);
    node_->warn = [this](const std::string& text) { logger_->warn(text); };
    keep_time();
    serve_parameters();
    context_->add(node_);
    for (const auto& notice : std::exchange(context_->notices, {})) logger_->warn(notice);
  }
  virtual ~Node() { destroy_node(); }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  const std::string& get_name() const { return name_; }
  const std::string& get_namespace() const { return resolver_.ns; }
  const std::string& get_fully_qualified_name() const { return node_->name; }
  Logger& get_logger() { return *logger_; }

  // The time [ns since 1970], or that of /clock with _use_sim_time:=true.
  std::int64_t now() const { return is_simulated_ ? sim_time_.load() : detail::system_now(); }

  std::string resolve_name(const std::string& name) const {
    const auto full = resolver_.expand(name), resolved = resolver_.resolve(name);
    std::vector<std::string> remaps;
    for (const auto& [from, to] : resolver_.remaps)
      if (resolver_.expand(from) == full) remaps.push_back(from);
    const std::lock_guard lock(context_->mutex);
    context_->used.insert(full);
    context_->used_remaps.insert(remaps.begin(), remaps.end());
    return resolved;
  }

  template <class Message>
  std::shared_ptr<Publisher<Message>> create_publisher(const Topic& topic, int depth = 10) {
    auto end = make_end<Publisher<Message>, Message>(wire::PUBLISHER, channel(topic), depth, context_, *logger_);
    context_->announce_soon();
    return end;
  }

  // Have a callback called with each message, as const Message& or std::shared_ptr<const Message>, on
  // the thread that spins. If it is too slow, the newest `depth` messages are kept.
  template <class Message, class Callback>
  std::shared_ptr<Subscription<Message>> create_subscription(const Topic& topic, int depth, Callback callback,
                                                             Place place = Place::here()) {
    typename Subscription<Message>::Callback function;
    if constexpr (std::is_invocable_v<Callback, std::shared_ptr<const Message>>)
      function = std::move(callback);
    else
      function = [callback = std::move(callback)](std::shared_ptr<const Message> message) mutable { callback(*message); };
    auto end = make_end<Subscription<Message>, Message>(wire::SUBSCRIBER, channel(topic), std::max(1, depth), context_,
                                                        *node_, *errors_, *logger_, std::move(function), place);
    receive(end->record.topic, end);
    return end;
  }

  void destroy_subscription(const std::shared_ptr<SubscriptionBase>& subscription) {
    std::unique_lock lock(context_->mutex);
    if (std::exchange(subscription->is_closed, true)) return;
    auto& ends = node_->ends;
    ends.erase(std::remove(ends.begin(), ends.end(), subscription), ends.end());
    lock.unlock();
    forget(*subscription);
    context_->announce_soon();
  }

  // Call a function at a fixed rate, by the computer's time.
  template <class Rep, class Period>
  Timer::SharedPtr create_wall_timer(std::chrono::duration<Rep, Period> period, std::function<void()> callback,
                                     Place place = Place::here()) {
    if (detail::is_in_lockstep()) return create_timer(period, std::move(callback), place);
    return add_timer(period, std::move(callback), detail::steady_now, place, true);
  }
  // Call a function at a fixed rate, by the node's time, which may be simulated.
  template <class Rep, class Period>
  Timer::SharedPtr create_timer(std::chrono::duration<Rep, Period> period, std::function<void()> callback,
                                Place place = Place::here()) {
    const auto clock = [this] { return is_simulated_ ? sim_time_.load() : detail::steady_now(); };
    return add_timer(period, std::move(callback), clock, place, !is_simulated_);
  }

  // Answer requests: callback(request, response) fills in the response; an Error is a refusal.
  template <class Request, class Response>
  std::shared_ptr<Service<Request, Response>> create_service(
      const std::string& name, typename Service<Request, Response>::Callback callback, Place place = Place::here()) {
    return serve<Request, Response>(resolve_name(name), "service " + resolve_name(name), std::move(callback), place);
  }

  template <class Request, class Response>
  std::shared_ptr<Client<Request, Response>> create_client(const std::string& name) {
    const auto service = resolve_name(name), replies = names::check_length(service + "/_reply");
    auto end = make_end<Client<Request, Response>, Request>(wire::CLIENT, service, 0, context_);
    receive(replies, end);
    return end;
  }

  // Say goodbye and stop receiving. A second call does nothing.
  void destroy_node() {
    context_->remove(node_);
    std::vector<std::shared_ptr<detail::End>> ends;
    {
      const std::lock_guard lock(context_->mutex);
      ends.swap(node_->ends);
      timers_.clear();
      node_->warn = [](const std::string&) {};
    }
    for (const auto& end : ends) forget(*end);
  }

  // Run every callback that is ready; return whether there was one.
  bool run_ready() {
    std::unique_lock lock(context_->mutex);
    bool has_run = false;
    // timers run before what arrives meanwhile
    for (auto left = node_->ready.size(); left > 0 && !node_->ready.empty() && ok(); --left) {
      const auto end = std::move(node_->ready.front());
      node_->ready.pop_front();
      lock.unlock();
      end->run();
      has_run = true;
      lock.lock();
    }
    const auto timers = timers_;
    lock.unlock();
    for (const auto& timer : timers) {
      if (!ok() || !timer->take_turn()) continue;
      const detail::Timing timing(*context_, node_->timed);
      errors_->guard(timer->name(), timer->place, timer->callback);
      has_run = true;
    }
    return has_run;
  }
  // Return the time at which run_ready has work if no message comes, by the steady clock [ns]; called
  // with the context's mutex held.
  std::int64_t next_work() const {
    if (!node_->ready.empty()) return 0;
    std::int64_t next = detail::never;
    for (const auto& timer : timers_) {
      if (timer->is_wall) next = std::min(next, timer->next());
      else if (timer->next() <= sim_time_) next = 0;
    }
    return next;
  }
  // Return the simulated time at which the next timer is due [ns].
  std::int64_t next_timer() const {
    const std::lock_guard lock(context_->mutex);
    std::int64_t next = detail::never;
    for (const auto& timer : timers_)
      if (!timer->is_wall) next = std::min(next, timer->next());
    return next;
  }
  void set_spinner(std::thread::id thread) {
    const std::lock_guard lock(context_->mutex);
    node_->spinner = thread;
  }
  const std::shared_ptr<detail::Context>& context() const { return context_; }

  // Log what in the command line no node of this program has used: likely misspelt.
  void warn_of_unused_arguments() {
    const auto& declared = context_->declared;
    for (const auto& [name, text] : context_->arguments.parameters)
      if (!declared.count(name)) logger_->warn("there is no parameter '" + name + "'");
    for (const auto& [from, to] : context_->arguments.remaps)
      if (!context_->used_remaps.count(from))
        logger_->warn(from + ":=" + to + " has no effect: no topic or service here is named '" + from + "'");
    for (const auto& word : context_->arguments.rest) {  // most are the program's own
      if (word == "--") break;
      const auto sign = word.find('=');
      const auto name = word.substr(0, sign), bare = name.substr(std::min(name.find_first_not_of('_'), name.size()));
      if (sign == std::string::npos || word.find(":=") != std::string::npos || !names::has_form(name, "~/_", "/.")) continue;
      const bool is_parameter = declared.count(bare) > 0;
      if (is_parameter || names::is_in(word[0], "_~/") || (names::has_form(name, "", "/") && context_->used.count(resolver_.expand(name))))
        logger_->warn("'" + word + "' names nothing; did you mean " + (is_parameter ? "_" + bare : name) + ":" + word.substr(sign) + "?");
    }
  }

 private:
  std::string channel(const Topic& topic) const {
    if (topic.name.empty()) throw Error("the topic is empty");
    return topic.is_plain ? names::check_length(topic.name) : resolve_name(topic.name);
  }

  // Make an endpoint of this node, with a type for its announcement.
  template <class Kind, class Message, class... Arguments>
  std::shared_ptr<Kind> make_end(wire::Role role, const std::string& topic, int depth, Arguments&&... arguments) {
    auto end = std::make_shared<Kind>(std::forward<Arguments>(arguments)...);
    std::string type = detail::TypeName<Message>::get();
    if (role >= wire::SERVICE) type = type.substr(0, type.rfind("_Request"));
    end->record.topic = topic, end->record.role = role, end->record.depth = depth;
    end->record.types = {type}, end->record.fingerprints = {Message::getHash()};
    const std::lock_guard lock(context_->mutex);
    node_->ends.push_back(end);
    return end;
  }

  void receive(const std::string& channel, const std::shared_ptr<detail::End>& end) {
    end->of_lcm = context_->subscribe(channel, end);
    context_->announce_soon();
  }
  void forget(detail::End& end) {
    if (end.of_lcm) context_->unsubscribe(std::exchange(end.of_lcm, nullptr));
  }

  template <class Request, class Response>
  std::shared_ptr<Service<Request, Response>> serve(const std::string& name, const std::string& callback_name,
                                                    typename Service<Request, Response>::Callback callback, Place place) {
    const auto requests = names::check_length(name + "/_request");
    auto end = make_end<Service<Request, Response>, Request>(wire::SERVICE, name, 100, context_, *node_, *errors_,
                                                             callback_name, std::move(callback), place);
    receive(requests, end);
    return end;
  }

  Timer::SharedPtr add_timer(std::chrono::duration<double> period, std::function<void()> callback,
                             std::function<std::int64_t()> clock, Place place, bool is_wall) {
    const double seconds = period.count();
    if (!(seconds > 0 && seconds < 1e9)) throw Error(format("a timer's period must be positive and finite, got %g s", seconds));
    const auto length = std::max<std::int64_t>(1, std::llround(seconds * 1e9));
    auto timer = std::make_shared<Timer>(length, std::move(callback), std::move(clock), place, is_wall);
    {
      const std::lock_guard lock(context_->mutex);
      timers_.push_back(timer);
    }
    context_->notify();  // a thread that spins already
    return timer;
  }

  // An end that keeps the time of /clock, without a callback.
  struct ClockEnd : detail::End {
    explicit ClockEnd(std::atomic<std::int64_t>& time) : time_(time) {}
    void receive(const std::uint8_t* data, std::size_t size) override {
      wire::Clock clock;
      if (clock.decode(data, 0, static_cast<int>(size)) < 0) return;
      count(size);
      time_ = clock.sec * INT64_C(1'000'000'000) + clock.nsec;
    }

   private:
    std::atomic<std::int64_t>& time_;
  };

  void keep_time() {
    std::int64_t start = 0;
    const bool usual = detail::is_in_lockstep(&start);
    is_simulated_ = declare_parameter("use_sim_time", usual, {"the time is that of /clock, not the computer's", {}, {}, true});
    if (!is_simulated_) return;
    sim_time_ = start;
    auto end = make_end<ClockEnd, wire::Clock>(wire::SUBSCRIBER, resolve_name("/clock"), 1, sim_time_);
    receive(end->record.topic, end);
  }

  void serve_parameters() {
    const std::string name = node_->name + "/_parameters";
    if (name.size() + 9 > names::max_channel_bytes) return;  // too long for the service's channels
    serve<wire::Parameters_Request, wire::Parameters_Response>(
        name, "parameters", [this](const auto& request, auto& response) { answer_parameters(request, response); }, Place::here());
  }

  std::string name_;
  names::Resolver resolver_;
  std::atomic<std::int64_t> sim_time_{0};
  bool is_simulated_ = false;
  std::unique_ptr<Logger> logger_;
  std::unique_ptr<detail::Errors> errors_;
  std::vector<Timer::SharedPtr> timers_;
};

namespace detail {

inline Node& node_of(Node& node) { return node; }
template <class T>
Node& node_of(const std::shared_ptr<T>& node) {
  return *node;
}

inline void finish_step(const std::vector<Node*>& nodes) {
  auto& context = *nodes.front()->context();
  std::unique_lock lock(context.mutex);
  if (!context.has_step_locked()) return;
  for (const Node* node : nodes)
    if (node->next_work() == 0) return;  // it has come with the step
  lock.unlock();
  auto next = never;
  for (const Node* node : nodes) next = std::min(next, node->next_timer());
  context.finish_step(next);
}

// Wait for something to do until a time by the steady clock, or until `is_over`, at most; do all of it.
template <class IsOver>
void run_once(const std::vector<Node*>& nodes, std::int64_t deadline, IsOver is_over) {
  while (ok() && !is_over()) {
    bool has_run = false;
    for (Node* node : nodes) has_run = node->run_ready() || has_run;
    if (has_run) return;
    finish_step(nodes);
    if (steady_now() >= deadline) return;
    auto& context = *nodes.front()->context();
    std::unique_lock lock(context.mutex);
    auto next = deadline;
    for (const Node* node : nodes) next = std::min(next, node->next_work());
    const bool is_idle = next > steady_now() && !context.has_step_locked();
    if (is_idle && ok() && !is_over()) context.wait(lock, next);
  }
}

}  // namespace detail

// Run the nodes' callbacks until Ctrl-C, SIGTERM or shutdown. A node may be given as a std::shared_ptr.
template <class... Nodes>
void spin(Nodes&&... nodes) {
  const std::vector<Node*> all = {&detail::node_of(nodes)...};
  all.front()->warn_of_unused_arguments();
  for (Node* node : all) node->set_spinner(std::this_thread::get_id());
  while (ok()) detail::run_once(all, detail::never, [] { return false; });
  for (Node* node : all) node->set_spinner({});
}

// Run the callbacks that are ready, and return.
template <class NodeType>
void spin_some(NodeType&& node) {
  if (ok() && !detail::node_of(node).run_ready()) detail::finish_step({&detail::node_of(node)});
}

// Wait for something to do, at most for the time given; do all of it.
template <class NodeType>
void spin_once(NodeType&& node, std::chrono::duration<double> timeout = std::chrono::seconds(0)) {
  detail::run_once({&detail::node_of(node)}, detail::time_after(timeout), [] { return false; });
}

enum class FutureReturnCode { SUCCESS, INTERRUPTED, TIMEOUT };

// Run callbacks until a future is ready, the time is over (if one is given) or the program should end.
template <class NodeType, class Future>
FutureReturnCode spin_until_future_complete(NodeType&& node, const Future& future,
                                            std::chrono::duration<double> timeout = std::chrono::seconds(-1)) {
  const auto deadline = timeout.count() < 0 ? detail::never : detail::time_after(timeout);
  while (true) {
    if (detail::is_ready(future)) return FutureReturnCode::SUCCESS;
    if (!ok()) return FutureReturnCode::INTERRUPTED;
    if (detail::steady_now() >= deadline) return FutureReturnCode::TIMEOUT;
    detail::run_once({&detail::node_of(node)}, deadline, [&] { return detail::is_ready(future); });
  }
}

}  // namespace lcmtools
