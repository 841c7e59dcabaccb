// Timers, and rates for loops of one's own. Include node.hpp instead.
#pragma once

#include "lcmtools/publisher.hpp"

namespace lcmtools {

// Calls a function at a fixed rate; missed periods are skipped. Made by Node::create_timer.
class Timer {
 public:
  using SharedPtr = std::shared_ptr<Timer>;
  Timer(std::int64_t period, std::function<void()> callback, std::function<std::int64_t()> clock,
        detail::Place place, bool is_wall)
      : callback(std::move(callback)), place(place), is_wall(is_wall),
        period_(period), clock_(std::move(clock)), next_(clock_() + period) {}

  void cancel() { is_cancelled_ = true; }
  void reset() {
    next_ = clock_() + period_;
    is_cancelled_ = false;
  }
  bool is_canceled() const { return is_cancelled_; }

  // Return whether it is time to call; then the next call is scheduled.
  bool take_turn() {
    const auto now = clock_();
    if (now < next_ - period_) next_ = now + period_;  // simulated time was set back
    if (is_cancelled_ || now < next_) return false;
    next_ = next_ + ((now - next_) / period_ + 1) * period_;
    return true;
  }
  std::int64_t next() const { return is_cancelled_ ? detail::never : next_.load(); }
  std::string name() const { return format("timer %g s", static_cast<double>(period_) / 1e9); }

  const std::function<void()> callback;
  const detail::Place place;
  const bool is_wall;  // also with simulated time

 private:
  const std::int64_t period_;
  const std::function<std::int64_t()> clock_;
  std::atomic<std::int64_t> next_;
  std::atomic<bool> is_cancelled_{false};
};

// Keeps a loop at a fixed rate, by the computer's time.
//
//     for (lcmtools::Rate rate(10); lcmtools::ok(); rate.sleep()) lcmtools::spin_some(node);
class Rate {
 public:
  explicit Rate(double hz) {
    if (!(hz > 1e-9 && hz <= 1e9)) throw Error(format("a rate must be positive and finite, got %g Hz", hz));
    period_ = std::llround(1e9 / hz);
  }

  // Sleep until the next turn, or the program's end; return false if the loop was too slow for it.
  bool sleep() {
    if (!ok()) return false;
    const auto now = detail::steady_now();
    next_ = std::max(next_ + period_, now - period_);
    const auto context = detail::current_context();
    std::unique_lock lock(context->mutex);
    while (ok() && detail::steady_now() < next_) context->wait(lock, next_);
    return next_ >= now;
  }

 private:
  std::int64_t period_ = 0, next_ = detail::steady_now();  // [ns]
};

}  // namespace lcmtools
