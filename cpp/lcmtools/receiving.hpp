// Receiving from the bus: by a thread that waits for messages, else by the context's own. Messages of a
// thread that receives for itself need not be passed on to it. Include node.hpp instead.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <exception>
#include <future>
#include <iostream>
#include <mutex>
#include <thread>

#include "lcmtools/bus.hpp"
#include "lcmtools/endpoint.hpp"

namespace lcmtools::detail {

// The signals that end the program. The handler may only use what is lock-free, and write.
struct Signals {
  std::atomic<int> wakeup{-1};  // the end of a pipe to write to
  std::atomic<bool> is_stopping{false};
  std::atomic<int> number{0};
};
inline Signals signals;

extern "C" inline void lcmtools_on_signal(int number) {
  const int error = errno;
  signals.number = number;
  signals.is_stopping = true;
  if (const int wakeup = signals.wakeup; wakeup >= 0 && ::write(wakeup, "s", 1) < 0) errno = 0;
  errno = error;
}

template <class Future>
bool is_ready(const Future& future) {
  return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

// A pipe: a byte wakes the thread that polls it.
struct Wakeup {
  int ends[2] = {-1, -1};
  Wakeup() {
    if (::pipe(ends) != 0) throw Error("there are too many open files");
    for (int end : ends) ::fcntl(end, F_SETFL, O_NONBLOCK), ::fcntl(end, F_SETFD, FD_CLOEXEC);
  }
  ~Wakeup() {
    for (int end : ends) ::close(end);
  }
  void set() {
    if (::write(ends[1], "w", 1) < 0) return;  // it is full: the thread will wake anyway
  }
  // Forget all bytes; return whether one was a signal's.
  bool clear() {
    char bytes[64];
    bool is_signal = false;
    for (ssize_t size; (size = ::read(ends[0], bytes, sizeof bytes)) > 0;)
      is_signal = is_signal || std::find(bytes, bytes + size, 's') != bytes + size;
    return is_signal;
  }
};

class Receiver {
 public:
  using Take = std::function<void(const std::uint8_t*, std::size_t)>;

  const std::string url;
  std::mutex mutex;  // of the context, its ends and its participants

  // Wait until something may have changed, or until a time; `lock` is of the mutex. If no other thread
  // does, the calling one receives meanwhile: no message has to be passed on to it.
  void wait(std::unique_lock<std::mutex>& lock, std::int64_t until) {
    if (!is_lendable_ || is_led_.exchange(true)) {
      changed_.wait_for(lock, std::chrono::nanoseconds(std::clamp<std::int64_t>(until - steady_now(), 0, longest_wait)));
      return;
    }
    lock.unlock();
    if (!receiving_.try_lock()) {
      wakeup_.set();
      receiving_.lock();
    }
    receive(leader_wakeup_, until);
    ++turns_;
    receiving_.unlock();
    is_led_ = false;
    if (is_resting_.exchange(false)) wakeup_.set();
    lock.lock();
    changed_.notify_all();  // another thread that waits is the next to receive
  }
  // Wait for a future until a time, or the program's end; return true if it is ready.
  template <class Future>
  bool wait_for(const Future& future, std::int64_t until) {
    std::unique_lock lock(mutex);
    while (!is_ready(future) && !signals.is_stopping && steady_now() < until) wait(lock, until);
    return is_ready(future);
  }
  // Wake the threads that wait.
  void notify() {
    const std::lock_guard lock(mutex);
    changed_.notify_all();
    if (is_led_) leader_wakeup_.set();
  }

  bool publish(const std::string& channel, const void* data, std::size_t size) {
    const std::lock_guard lock(writing_);
    return lcm_publish(lcm_.get(), channel.c_str(), data, static_cast<unsigned>(size)) >= 0;
  }
  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    const wire::Bytes payload = message.packed();
    publish(channel, payload.data(), payload.size());
  }

  lcm_subscription_t* subscribe(const std::string& channel, Take take) {
    std::string pattern;  // liblcm takes a regular expression
    for (char c : channel) pattern += (names::is_in(c, ".[]{}()*+?^$|\\") ? "\\" : "") + std::string(1, c);
    auto kept = std::make_unique<Take>(std::move(take));
    std::unique_lock writing(writing_);
    auto* subscription = lcm_subscribe(lcm_.get(), pattern.c_str(), on_message, kept.get());
    writing.unlock();
    if (!subscription) throw Error("the bus does not accept a subscription to " + channel);
    lcm_subscription_set_queue_capacity(subscription, 0);  // the queues that drop are ours
    const std::lock_guard lock(mutex);
    takes_.push_back(std::move(kept));
    return subscription;
  }
  // Have an end receive a channel's messages until it is closed.
  lcm_subscription_t* subscribe(const std::string& channel, const std::shared_ptr<End>& end) {
    return subscribe(channel, [this, end](const std::uint8_t* data, std::size_t size) {
      const std::lock_guard lock(mutex);
      if (!end->is_closed) end->receive(data, size);
    });
  }
  void unsubscribe(lcm_subscription_t* subscription) {
    const std::lock_guard lock(mutex);
    removals_.push_back(subscription);
  }

 protected:
  explicit Receiver(const std::string& bus) : url(bus), lcm_(open_bus(bus), lcm_destroy) {
    if (lcm_get_fileno(lcm_.get()) < 0) throw Error("nothing can be received from " + url);
  }

  // Receive on the context's own thread, or wait while another one does or has just done so: until a
  // time, or until `wakeup_` is set.
  void take_turn(std::int64_t until) {
    const auto turns = turns_.load();
    if (std::exchange(seen_turns_, turns) != turns) {  // that thread is trusted to come back
      follow(std::min(until, steady_now() + patience));
    } else if ((is_resting_ = is_led_.load())) {
      follow(is_led_ ? until : 0);
      is_resting_ = false;
    } else if (const std::unique_lock lock(receiving_, std::try_to_lock); lock) {
      receive(wakeup_, until);
      notify();
    }
  }

  Wakeup wakeup_;  // of the own thread

 private:
  static void on_message(const lcm_recv_buf_t* buffer, const char*, void* take) {
    try {  // no exception may pass liblcm
      (*static_cast<Take*>(take))(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    } catch (const std::exception& error) {
      std::cerr << "lcmtools: a message was lost: " << error.what() << std::endl;
    }
  }

  static void wait_for(pollfd* waits, nfds_t number, std::int64_t until) {
    const auto left = std::clamp<std::int64_t>(until - steady_now(), 0, longest_wait);
#ifdef __APPLE__
    ::poll(waits, number, static_cast<int>((left + ms - 1) / ms));
#else
    const timespec span = {static_cast<time_t>(left / 1'000'000'000), static_cast<long>(left % 1'000'000'000)};
    ::ppoll(waits, number, &span, nullptr);
#endif
  }

  // Receive all messages that are there, or wait for one until a time; with the right to receive.
  void receive(Wakeup& wakeup, std::int64_t until) {
    pollfd waits[] = {{lcm_get_fileno(lcm_.get()), POLLIN, 0}, {wakeup.ends[0], POLLIN, 0}};
    const auto began = steady_now();
    wait_for(waits, 2, until);
    if (waits[1].revents && &wakeup == &leader_wakeup_) wakeup.clear();
    // a message that was waited for is the only one, which saves a call of the system; callbacks and
    // announcements wait for the end of a flood, but not for ever
    for (int left = steady_now() - began > ms / 50 ? 1 : 1000; left > 0 && waits[0].revents; --left) {
      if (lcm_handle(lcm_.get()) < 0)  // a lost server, to which liblcm connects again
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      waits[0].revents = 0;
      if (left > 1) ::poll(waits, 1, 0);
    }
    unsubscribe_all();
  }

  void follow(std::int64_t until) {
    pollfd wait = {wakeup_.ends[0], POLLIN, 0};
    wait_for(&wait, 1, until);
  }

  void unsubscribe_all() {
    std::vector<lcm_subscription_t*> removals;
    {
      const std::lock_guard lock(mutex);
      removals.swap(removals_);
    }
    const std::lock_guard writing(writing_);
    for (auto* one : removals) lcm_unsubscribe(lcm_.get(), one);
  }

  static constexpr std::int64_t longest_wait = 3600 * period;
  static constexpr std::int64_t patience = 10 * ms;  // that a thread that has received may be away

  std::unique_ptr<lcm_t, void (*)(lcm_t*)> lcm_;
  std::vector<lcm_subscription_t*> removals_;
  std::deque<std::unique_ptr<Take>> takes_;  // kept until the end: liblcm may still call one
  std::condition_variable changed_;  // for threads that wait and do not receive
  Wakeup leader_wakeup_;             // of the thread that waits and receives
  std::mutex writing_;               // held to send: liblcm writes to a tcpq server in several pieces
  std::mutex receiving_;             // held by the thread that calls lcm_handle and lcm_unsubscribe
  std::atomic<bool> is_led_{false}, is_resting_{false};  // another thread receives; the own one sleeps until it leaves
  std::atomic<unsigned> turns_{0};  // of other threads that received
  unsigned seen_turns_ = 0;
  const bool is_lendable_ = url.compare(0, 4, "tcpq") != 0;  // its lcm_handle waits for the rest of a message
};

}  // namespace lcmtools::detail
