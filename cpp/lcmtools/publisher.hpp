// Publishers, and the logger, which publishes on /rosout. Include node.hpp instead.
#pragma once

#include "lcmtools/context.hpp"

namespace lcmtools {

namespace detail {

// A place in the code: where a line is logged, or where a callback was given.
struct Place {
  const char* file;
  int line;
  const char* function;
  static Place here(const char* file = __builtin_FILE(), int line = __builtin_LINE(),
                    const char* function = __builtin_FUNCTION()) {
    return {file, line, function};
  }
  std::string base() const {
    const std::string path = file;
    return path.substr(path.rfind('/') + 1);
  }
  std::string text() const { return base() + ":" + std::to_string(line); }
};

// Allows something at most once in a period.
class Throttle {
 public:
  bool allows(std::int64_t period) {
    const auto now = steady_now();
    if (now < next_) return false;
    next_ = period == never ? never : now + period;
    return true;
  }

 private:
  std::atomic<std::int64_t> next_{0};
};

// Refuses a message of which a length is not that of its array; the code of `lcmtools msg generate`
// names both. lcm-gen's encoder would leave elements out, or read beyond the last.
struct LengthCheck {
  template <class T, class... Inner>
  void operator()(const char* field, const std::vector<T>& elements, std::int64_t length, Inner... inner) const {
    if (static_cast<std::int64_t>(elements.size()) != length)
      throw Error(format("%s has %zu elements, but its length is %lld", field, elements.size(), static_cast<long long>(length)),
                  format("set the length that belongs to it, as in message.%s_length = message.%s.size()", field, field));
    if constexpr (!std::is_arithmetic_v<T>)
      for (const auto& element : elements) (*this)(field, element, inner...);
  }
  template <class T, std::size_t Size>
  void operator()(const char* field, const T (&elements)[Size]) const {
    for (const auto& element : elements) (*this)(field, element);
  }
  template <class T>
  void operator()(const char*, const T& value) const {
    check(value, 0);
  }

 private:
  template <class T>
  auto check(const T& message, int) const -> decltype(message._checkLengths(*this)) {
    message._checkLengths(*this);
  }
  template <class T>
  void check(const T&, long) const {}
};

template <class Message>
wire::Bytes encode(const Message& message) {
  LengthCheck()("", message);
  wire::Bytes payload(static_cast<std::size_t>(message.getEncodedSize()));
  if (message.encode(payload.data(), 0, static_cast<int>(payload.size())) < 0)
    throw Error("the message cannot be encoded");
  return payload;
}

// Sends on one topic, and counts.
class Sender : public End {
 public:
  explicit Sender(std::shared_ptr<Context> context) : context_(std::move(context)) {}

  const std::string& get_topic_name() const { return record.topic; }

  // Return false if the network did not take the message. Nothing is sent after shutdown.
  bool send(const wire::Bytes& payload) {
    if (context_->is_closed()) return true;
    if (!context_->publish(record.topic, payload.data(), payload.size())) return false;
    const std::lock_guard lock(context_->mutex);
    count(payload.size());
    return true;
  }

 private:
  std::shared_ptr<Context> context_;
};

}  // namespace detail

// How often a line may be logged from one place in the code.
struct Every {
  std::int64_t period = 0;  // [ns]
};
constexpr Every once{detail::never};
inline Every throttle(std::chrono::duration<double> period) { return {std::llround(period.count() * 1e9)}; }

// Writes a node's log to standard error, and publishes it on /rosout.
//
//     get_logger().warn("no scan", lcmtools::throttle(1s));
class Logger {
 public:
  using Place = detail::Place;
  wire::Log::Level threshold = wire::Log::INFO;  // lines below it are only published

  Logger(std::string node, std::shared_ptr<detail::Sender> rosout, std::function<std::int64_t()> now)
      : node_(std::move(node)), rosout_(std::move(rosout)), now_(std::move(now)) {}

  void debug(const std::string& text, Every every = {}, Place place = Place::here()) { log(wire::Log::DEBUG, text, every, place); }
  void info(const std::string& text, Every every = {}, Place place = Place::here()) { log(wire::Log::INFO, text, every, place); }
  void warn(const std::string& text, Every every = {}, Place place = Place::here()) { log(wire::Log::WARN, text, every, place); }
  void error(const std::string& text, Every every = {}, Place place = Place::here()) { log(wire::Log::ERROR, text, every, place); }
  void fatal(const std::string& text, Every every = {}, Place place = Place::here()) { log(wire::Log::FATAL, text, every, place); }

 private:
  void log(wire::Log::Level level, const std::string& text, Every every, const Place& place) {
    static const std::map<int, const char*> labels = {
        {1, "DEBUG"}, {2, "INFO"}, {4, "WARN"}, {8, "ERROR"}, {16, "FATAL"}};
    if (every.period && !throttle_of(place).allows(every.period)) return;
    const auto now = now_();
    wire::Log entry;
    entry.sec = static_cast<std::int32_t>(now / 1'000'000'000);
    entry.nsec = static_cast<std::int32_t>(now % 1'000'000'000);
    entry.level = level, entry.name = node_, entry.msg = text;
    entry.file = place.base(), entry.line = place.line, entry.function = place.function;
    if (level >= threshold)  // in one piece, so that lines of several threads do not mix
      std::cerr << format("[%s] [%d.%09d] [%s]: %s\n", labels.at(level), entry.sec, entry.nsec, node_.c_str(),
                          detail::printable(text).c_str()) << std::flush;
    rosout_->send(entry.packed());
  }

  detail::Throttle& throttle_of(const Place& place) {
    const std::lock_guard lock(mutex_);
    return throttles_[{place.file, place.line}];
  }

  std::string node_;
  std::shared_ptr<detail::Sender> rosout_;
  std::function<std::int64_t()> now_;
  std::mutex mutex_;
  std::map<std::pair<std::string, int>, detail::Throttle> throttles_;
};

// Publishes messages of one type on one topic. Made by Node::create_publisher.
template <class Message>
class Publisher : public detail::Sender {
 public:
  using SharedPtr = std::shared_ptr<Publisher>;
  Publisher(std::shared_ptr<detail::Context> context, Logger& logger) : Sender(std::move(context)), logger_(logger) {}

  // Send one message. The lengths of its arrays are fields to be set; Error for one that is wrong.
  void publish(const Message& message) {
    if (!send(detail::encode(message)) && warnings_.allows(5000 * detail::ms))
      logger_.error(get_topic_name() + ": the network did not take a message");
  }

 private:
  Logger& logger_;
  detail::Throttle warnings_;
};

}  // namespace lcmtools
