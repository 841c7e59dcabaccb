// Publishers, subscriptions, services and clients as they are announced. Include node.hpp instead.
#pragma once

#include <lcm/lcm.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "lcmtools/type_name.hpp"
#include "lcmtools/wire.hpp"

namespace lcmtools::detail {

constexpr std::int64_t ms = 1'000'000, period = 1000 * ms;  // [ns]; between two announcements
constexpr std::int64_t change_delay = 5 * ms;  // a node that is being set up changes many times at once
constexpr std::int64_t answer_spread = 10 * ms, never = INT64_MAX;
constexpr const char* node_channel = "/_lcmtools/node";

inline std::int64_t steady_now() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}
inline std::int64_t system_now() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Return the time by the steady clock after some seconds, which may be infinite.
inline std::int64_t time_after(std::chrono::duration<double> seconds) {
  return steady_now() + static_cast<std::int64_t>(std::clamp(seconds.count(), 0.0, 1e9) * 1e9);
}

inline std::string unique_id() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 32; ++i) id += "0123456789abcdef"[random() % 16];
  return id;
}

// Counts calls and their time; a nested call is counted, but its time is not counted twice.
struct Stopwatch {
  std::int64_t calls = 0, busy = 0, longest = 0, began = 0;
  int running = 0;
  void start() {
    ++calls;
    if (running++ == 0) began = steady_now();
  }
  void stop() {
    if (--running > 0) return;
    busy += steady_now() - began;
    longest = std::max(longest, steady_now() - began);
  }
  std::int64_t current() const { return running ? steady_now() - began : 0; }
};

// A publisher, subscription, service or client of a node, as it is announced. As all that several
// threads use, it is read and changed with the context's mutex held.
struct End {
  wire::Endpoint record;
  Stopwatch stopwatch;
  bool is_closed = false;
  lcm_subscription_t* of_lcm = nullptr;

  virtual ~End() = default;
  virtual void receive(const std::uint8_t*, std::size_t) {}  // with the mutex held
  virtual void run() {}  // the callback of what has waited longest, without the mutex
  // Give what is to be sent again, with its channel; return the next time for it. With the mutex held.
  virtual std::int64_t repeat(std::int64_t, std::vector<std::pair<std::string, wire::Bytes>>&) { return never; }

  void count(std::size_t size) {
    ++record.messages, record.bytes += static_cast<std::int64_t>(size), record.last_time = system_now();
  }
  wire::Endpoint announced() const {
    wire::Endpoint now = record;
    now.calls = stopwatch.calls;
    now.busy = stopwatch.busy + stopwatch.current();
    now.longest = std::max(stopwatch.longest, stopwatch.current());
    now.rate = rate_since(before_.time ? before_ : latest_);
    return now;
  }
  void keep_count(std::int64_t now) {
    before_ = latest_;
    latest_ = {now, record.messages, record.last_time};
  }

 private:
  struct Count {
    std::int64_t time = 0, messages = 0, last_time = 0;
  };

  // Return the rate of the messages since a count [Hz]; 0 without any, or after a pause, which
  // is longer than two of the intervals that followed.
  double rate_since(const Count& was) const {
    const auto messages = static_cast<double>(record.messages - was.messages);
    const auto span = static_cast<double>(record.last_time - was.last_time);
    if (messages <= 0 || span <= 0 || !was.last_time) return 0;
    const auto since = static_cast<double>(record.last_time - was.time);
    const double usual = messages > 1 ? since / (messages - 1) : period / 2.0;
    return static_cast<double>(was.time - was.last_time) <= 2 * usual ? messages * 1e9 / span : 0;
  }

  Count before_, latest_;  // one or two periods ago
};

// A node, as its context knows it.
struct Participant {
  std::string name, id = unique_id();
  std::int64_t start_time = system_now();
  std::vector<std::shared_ptr<End>> ends;
  std::deque<std::shared_ptr<End>> ready;  // one element for each call of `run`, in order of arrival
  Stopwatch timed;                         // callbacks of timers
  std::thread::id spinner;                 // the thread in lcmtools::spin
  std::vector<wire::CallbackError> errors;  // different ones, the newest last
  std::optional<std::int64_t> recorded;     // the revision in its record
  std::function<void(const std::string&)> warn = [](const std::string&) {};
};

}  // namespace lcmtools::detail
