// Subscriptions: queues whose callbacks run on the thread that spins. Include node.hpp instead.
#pragma once

#include "lcmtools/publisher.hpp"

namespace lcmtools {

namespace detail {

inline std::string text_of(const std::exception& error) {
  const std::string text = error.what();
  return text.substr(0, text.find('\n')).substr(0, 200);
}

// The exceptions of a node's callbacks: each different one is logged, then counted and announced.
class Errors {
 public:
  Errors(Context& context, Participant& node, Logger& logger) : context_(context), node_(node), logger_(logger) {}

  // Call a function of the user's.
  template <class Function>
  void guard(const std::string& callback, const Place& place, const Function& function) {
    try {
      function();
    } catch (const Error& error) {  // not a fault if a call failed because the program is ending
      if (!signals.is_stopping) add(callback, error, place);
    } catch (const std::exception& error) {
      add(callback, error, place);
    } catch (...) {
      add(callback, std::runtime_error("an exception that is not a std::exception"), place);
    }
  }

  void add(const std::string& callback, const std::exception& error, const Place& place) {
    const std::string kind = demangled(typeid(error).name());
    std::unique_lock lock(context_.mutex);
    auto seen = std::find_if(node_.errors.begin(), node_.errors.end(), [&](const auto& one) {
      return one.callback == callback && one.exception == kind && one.place == place.text();
    });
    const bool is_new = seen == node_.errors.end();
    wire::CallbackError entry;
    if (is_new) entry.callback = callback, entry.exception = kind, entry.place = place.text();
    else entry = *seen, node_.errors.erase(seen);
    entry.message = text_of(error), ++entry.count, entry.last_time = system_now();
    node_.errors.push_back(entry);
    if (node_.errors.size() > 5) node_.errors.erase(node_.errors.begin());
    if (is_new) context_.announce_soon_locked();
    lock.unlock();
    if (is_new) logger_.error((callback[0] == '/' ? "callback of " : "") + callback + " raised " + kind + ": " + error.what() + " (" +
                                  place.text() + ")", {}, place);
  }

 private:
  Context& context_;
  Participant& node_;
  Logger& logger_;
};

// Measures a callback.
class Timing {
 public:
  Timing(Context& context, Stopwatch& stopwatch) : context_(context), stopwatch_(stopwatch) {
    const std::lock_guard lock(context_.mutex);
    stopwatch_.start();
  }
  ~Timing() {
    const std::lock_guard lock(context_.mutex);
    stopwatch_.stop();
  }

 private:
  Context& context_;
  Stopwatch& stopwatch_;
};

// An end whose callback runs on the spinning thread, once for each payload that waits.
class Queue : public End, public std::enable_shared_from_this<Queue> {
 public:
  Queue(std::shared_ptr<Context> context, Participant& node, Errors& errors, Place place)
      : context_(std::move(context)), node_(node), errors_(errors), place_(place) {}

  // Keep the newest `depth` payloads, and count the others.
  void receive(const std::uint8_t* data, std::size_t size) override {
    count(size);
    if (waiting_.size() < static_cast<std::size_t>(record.depth)) {
      node_.ready.push_back(shared_from_this());
    } else {
      ++record.drops;
      waiting_.pop_front();
    }
    waiting_.emplace_back(data, data + size);
  }

  void run() override {
    std::unique_lock lock(context_->mutex);
    if (is_closed || waiting_.empty()) return;
    const wire::Bytes payload = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    const Timing timing(*context_, stopwatch);
    call(payload);
  }

 protected:
  virtual void call(const wire::Bytes& payload) = 0;

  std::shared_ptr<Context> context_;
  Participant& node_;  // it, and the errors, live until the end is closed
  Errors& errors_;
  Place place_;

 private:
  std::deque<wire::Bytes> waiting_;
};

}  // namespace detail

// Receives messages of one topic. Made by Node::create_subscription.
class SubscriptionBase : public detail::Queue {
 public:
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
  using Queue::Queue;
  const std::string& get_topic_name() const { return record.topic; }
  std::int64_t get_drops() const {
    const std::lock_guard lock(context_->mutex);
    return record.drops;
  }
};

template <class Message>
class Subscription : public SubscriptionBase {
 public:
  using SharedPtr = std::shared_ptr<Subscription>;
  using Callback = std::function<void(std::shared_ptr<const Message>)>;

  Subscription(std::shared_ptr<detail::Context> context, detail::Participant& node, detail::Errors& errors,
               Logger& logger, Callback callback, detail::Place place)
      : SubscriptionBase(std::move(context), node, errors, place), logger_(logger), callback_(std::move(callback)) {}

 protected:
  void call(const wire::Bytes& payload) override {
    auto message = std::make_shared<Message>();
    if (message->decode(payload.data(), 0, static_cast<int>(payload.size())) >= 0)
      return errors_.guard(record.topic, place_, [&] { callback_(std::move(message)); });
    if (warnings_.allows(5000 * detail::ms))
      logger_.warn(record.topic + ": message ignored: it is not of the type " + record.types.front());
  }

 private:
  Logger& logger_;
  Callback callback_;
  detail::Throttle warnings_;
};

}  // namespace lcmtools
