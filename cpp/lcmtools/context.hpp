// A program's connection to the bus, the announcements of its nodes, and its signals. One thread
// receives all messages into queues and announces; liblcm's lcm_handle and lcm_unsubscribe are called
// by it alone. Users' callbacks run elsewhere (node.hpp). Include node.hpp instead.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <exception>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>

#include "lcmtools/bus.hpp"
#include "lcmtools/endpoint.hpp"
#include "lcmtools/record.hpp"

namespace lcmtools {

constexpr const char* version = "0.1.0";  // of lcmtools

namespace detail {

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

class Context {
 public:
  using Take = std::function<void(const std::uint8_t*, std::size_t)>;

  std::mutex mutex;                 // of all that follows, of ends and of participants
  std::condition_variable changed;  // something may be ready, or the program should end
  Arguments arguments;
  std::string command;
  std::vector<std::string> notices;       // warnings about the command line, for the next node's log
  std::vector<std::string> declared;      // names of parameters
  bool is_first = true;                   // __name:= names the first node
  const std::string ns = default_namespace();

  Context(Arguments said, std::string command_line)
      : arguments(std::move(said)), command(std::move(command_line)) {
    char name[256] = "";
    ::gethostname(name, sizeof name - 1);
    host_ = name;
    if (::pipe(wakeup_) != 0) throw Error("there are too many open files");
    for (int end : wakeup_) ::fcntl(end, F_SETFL, O_NONBLOCK), ::fcntl(end, F_SETFD, FD_CLOEXEC);
    // the signals are for the program's own threads, not for liblcm's and ours
    sigset_t ending, usual;
    sigemptyset(&ending);
    for (int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&ending, number);
    pthread_sigmask(SIG_BLOCK, &ending, &usual);
    try {
      const auto url = choose_url(arguments);
      lcm_ = open_bus(url);
      records_ = record_folder(url);
      subscribe("/_lcmtools/probe", [this](auto data, auto size) { take_probe(data, size); });
      subscribe("/_lcmtools/shutdown", [this](auto data, auto size) { take_shutdown(data, size); });
      if (is_in_lockstep()) subscribe("/_lcmtools/step", [this](auto data, auto size) { take_step(data, size); });
      if (lcm_get_fileno(lcm_) < 0) throw Error("nothing can be received from this bus");
      thread_ = std::thread([this] { run(); });
    } catch (...) {
      pthread_sigmask(SIG_SETMASK, &usual, nullptr);
      release();
      throw;
    }
    pthread_sigmask(SIG_SETMASK, &usual, nullptr);
  }
  ~Context() {
    close();
    release();
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  int wakeup() const { return wakeup_[1]; }
  bool is_closed() const { return is_closed_; }

  void stop() {
    signals.is_stopping = true;
    wake();
  }

  // Say goodbye for all nodes, and receive no more.
  void close() {
    if (is_closed_.exchange(true)) return;
    stop();
    say_all_goodbyes();
    if (thread_.joinable()) thread_.join();
  }

  bool publish(const std::string& channel, const void* data, std::size_t size) {
    return lcm_publish(lcm_, channel.c_str(), data, static_cast<unsigned>(size)) >= 0;
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
    auto* subscription = lcm_subscribe(lcm_, pattern.c_str(), on_message, kept.get());
    if (!subscription) throw Error("the bus does not accept a subscription to " + channel);
    lcm_subscription_set_queue_capacity(subscription, 0);  // the queues that drop are ours
    const std::lock_guard lock(mutex);
    takes_.push_back(std::move(kept));
    return subscription;
  }
  // Have an end receive a channel's messages until it is closed.
  lcm_subscription_t* subscribe(const std::string& channel, const std::shared_ptr<End>& end) {
    return subscribe(channel, [this, end](const std::uint8_t* data, std::size_t size) {
      {
        const std::lock_guard lock(mutex);
        if (!end->is_closed) end->receive(data, size);
      }
      changed.notify_all();  // without the mutex, which the woken thread takes
    });
  }
  void unsubscribe(lcm_subscription_t* subscription) {
    const std::lock_guard lock(mutex);
    removals_.push_back(subscription);
    wake();
  }

  void add(const std::shared_ptr<Participant>& participant) {
    const std::lock_guard lock(mutex);
    participants_.push_back(participant);
    announce_soon_locked();
  }
  // Say goodbye for a node, if it was not said yet; close its ends.
  void remove(const std::shared_ptr<Participant>& participant) {
    const std::lock_guard sending(sending_);
    std::unique_lock lock(mutex);
    for (auto& end : participant->ends) end->is_closed = true;
    participant->ready.clear();
    const auto place = std::find(participants_.begin(), participants_.end(), participant);
    if (place == participants_.end()) return;
    participants_.erase(place);
    auto goodbye = described(*participant);
    lock.unlock();
    goodbye.state = wire::Announcement::LEAVING;
    publish(node_channel, goodbye);
    remove_record(records_, participant->id);
  }

  // Answer the step of a recording that is played to this program in lock-step (bag rerun): nothing is
  // left to do for its nodes, and the next timer is due at `next` [ns], simulated time.
  void finish_step(std::int64_t next) {
    std::unique_lock lock(mutex);
    const auto is_busy = [](const auto& one) { return !one->ready.empty(); };
    if (step_ < 0 || std::any_of(participants_.begin(), participants_.end(), is_busy)) return;
    const auto answer = wire::encoded(wire::Step{std::exchange(step_, -1), next});
    lock.unlock();
    publish("/_lcmtools/done", answer.data(), answer.size());
  }

  void announce_soon() {
    const std::lock_guard lock(mutex);
    announce_soon_locked();
  }
  void announce_soon_locked() {
    is_behind_ = true;
    const auto due = steady_now() + change_delay;
    if (due < due_) due_ = due, wake();
  }
  // Announce all nodes now if one has changed, ahead of any message that is sent next.
  void announce_changes() {
    std::unique_lock lock(mutex);
    const bool is_behind = is_behind_;
    lock.unlock();
    if (is_behind) announce();
  }

 private:
  static void on_message(const lcm_recv_buf_t* buffer, const char*, void* take) {
    try {  // no exception may pass liblcm
      (*static_cast<Take*>(take))(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    } catch (const std::exception& error) {
      std::cerr << "lcmtools: a message was lost: " << error.what() << std::endl;
    }
  }

  void wake() {
    if (::write(wakeup_[1], "w", 1) < 0) return;  // it is full: the thread will wake anyway
  }

  void run() {
    while (true) {
      pollfd waits[] = {{lcm_get_fileno(lcm_), POLLIN, 0}, {wakeup_[0], POLLIN, 0}};
      ::poll(waits, 2, milliseconds_left());
      if (waits[1].revents) take_wakeups();
      if (is_closed_) return;
      if (waits[0].revents && lcm_handle(lcm_) < 0)  // a lost server, to which liblcm connects again
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      unsubscribe_all();
      announce_if_due();
      answer_aimed();
    }
  }

  int milliseconds_left() {
    const std::lock_guard lock(mutex);
    const auto due = std::min({due_, answer_due_, aimed_.empty() ? never : aimed_from_});
    const auto left = (due - steady_now() + ms - 1) / ms;
    return static_cast<int>(std::clamp<std::int64_t>(left, 0, 1000));
  }

  void take_wakeups() {
    char bytes[64];
    ssize_t size;
    bool is_signal = false;
    while ((size = ::read(wakeup_[0], bytes, sizeof bytes)) > 0)
      is_signal = is_signal || std::find(bytes, bytes + size, 's') != bytes + size;
    if (is_signal) take_signal();
    const std::lock_guard lock(mutex);
    changed.notify_all();
  }

  // After the second signal the program ends at once, with its goodbyes. timeout(1) sends each one
  // twice, and an ending shell sends SIGHUP twice.
  void take_signal() {
    const auto now = steady_now();
    if (first_signal_ && now > first_signal_ + 50 * ms && signals.number != SIGHUP) {
      say_all_goodbyes();
      ::signal(signals.number, SIG_DFL);
      ::kill(::getpid(), signals.number);
    }
    if (!first_signal_) first_signal_ = now;
  }

  void unsubscribe_all() {
    std::vector<lcm_subscription_t*> removals;
    {
      const std::lock_guard lock(mutex);
      removals.swap(removals_);
    }
    for (auto* one : removals) lcm_unsubscribe(lcm_, one);
  }

  void announce_if_due() {
    std::unique_lock lock(mutex);
    const auto now = steady_now();
    if (now < std::min(due_, answer_due_)) return;
    due_ = now + period;
    answer_due_ = owes_another_ ? now + answer_spread : never;
    owes_another_ = false;
    const auto nonce = std::exchange(nonce_, 0);
    lock.unlock();
    announce(nonce);
  }

  // Answer probes of single nodes, with the last nonce of each: a stranger may send them without end.
  void answer_aimed() {
    if (aimed_.empty() || steady_now() < aimed_from_) return;
    for (const auto& [name, nonce] : std::exchange(aimed_, {})) announce(nonce, name);
    aimed_from_ = steady_now() + answer_spread;
  }

  void announce(std::int64_t nonce = 0, const std::string& target = "") {
    const std::lock_guard sending(sending_);  // no node is announced after its goodbye
    std::vector<wire::Announcement> announcements;
    {
      const std::lock_guard lock(mutex);
      if (target.empty()) is_behind_ = false;
      for (const auto& one : participants_) {
        if (!target.empty() && target != one->name) continue;
        announcements.push_back(described(*one));
        record(*one, announcements.back());
      }
      if (const auto now = steady_now(); now >= next_count_) {
        next_count_ = now + period * 9 / 10;
        for (const auto& one : participants_)
          for (const auto& end : one->ends) end->keep_count(system_now());
      }
    }
    for (auto& one : announcements) {
      one.answers = nonce;
      publish(node_channel, one);
    }
  }

  wire::Announcement described(const Participant& node) const {
    wire::Announcement message;
    message.name = node.name, message.host = host_, message.id = node.id, message.pid = ::getpid();
    message.command = command, message.software = std::string("lcmtools C++ ") + version;
    message.start_time = node.start_time, message.sent = system_now();
    wire::NodeDetails details, constant;  // the second without counters
    details.pid_namespace = own_namespace("pid");
    details.busy = node.timed.busy + node.timed.current();
    for (const auto& end : node.ends) {
      if (end->is_closed) continue;
      auto record = end->announced();
      details.busy += record.busy;
      details.endpoints.push_back({wire::encoded(record)});
      record.messages = record.bytes = record.drops = record.last_time = 0;
      record.calls = record.busy = record.longest = 0, record.rate = 0;
      constant.endpoints.push_back({wire::encoded(record)});
    }
    for (auto error : node.errors) {
      details.errors.push_back({wire::encoded(error)});
      error.count = error.last_time = 0, error.message = "";
      constant.errors.push_back({wire::encoded(error)});
    }
    message.details = wire::encoded(details);
    const auto bytes = wire::encoded(constant);
    message.revision = static_cast<std::int64_t>(std::hash<std::string>()({bytes.begin(), bytes.end()}));
    return message;
  }

  void record(Participant& node, const wire::Announcement& described) {
    if (std::exchange(node.recorded, described.revision) == described.revision) return;
    std::vector<wire::Endpoint> ends;
    for (const auto& end : node.ends) ends.push_back(end->record);
    write_record(records_, described, ends);
  }

  void take_probe(const std::uint8_t* data, std::size_t size) {
    wire::Probe probe;
    if (probe.decode(data, 0, static_cast<int>(size)) < 0) return;
    const std::lock_guard lock(mutex);
    if (!probe.target.empty()) {
      const auto has_name = [&](const auto& one) { return one->name == probe.target; };
      if (std::any_of(participants_.begin(), participants_.end(), has_name)) aimed_[probe.target] = probe.nonce;
      return;
    }
    nonce_ = probe.nonce ? probe.nonce : nonce_;
    // a second probe is sent in case an answer is lost: it gets an answer of its own
    owes_another_ = answer_due_ != never;
    answer_due_ = std::min(answer_due_, steady_now() + static_cast<std::int64_t>(random_() % answer_spread));
  }

  void take_step(const std::uint8_t* data, std::size_t size) {
    wire::Reader reader{data, data + size};
    const std::lock_guard lock(mutex);
    reader(step_);
    changed.notify_all();
  }

  // End the program as by SIGTERM; first answer, so that a program that hangs is recognized.
  void take_shutdown(const std::uint8_t* data, std::size_t size) {
    wire::Shutdown request;
    if (request.decode(data, 0, static_cast<int>(size)) < 0) return;
    std::unique_lock lock(mutex);
    const auto is_target = [&](const auto& one) { return one->id == request.target; };
    const auto found = std::find_if(participants_.begin(), participants_.end(), is_target);
    if (found == participants_.end()) return;
    const auto node = *found;
    lock.unlock();
    announce(request.nonce, node->name);
    if (std::exchange(is_shutdown_requested_, true)) return;  // it is repeated until the goodbye
    node->warn("shutdown requested " + (request.requester.empty() ? "over the bus" : "by " + request.requester));
    struct sigaction action = {};
    ::sigaction(SIGTERM, nullptr, &action);
    if (action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN) ::kill(::getpid(), SIGTERM);
    else stop();
  }

  void say_all_goodbyes() {
    std::vector<std::shared_ptr<Participant>> nodes;
    {
      const std::lock_guard lock(mutex);
      nodes = participants_;
    }
    for (const auto& one : nodes) remove(one);
  }

  void release() {
    if (lcm_) lcm_destroy(lcm_);
    for (int end : wakeup_) ::close(end);
  }

  lcm_t* lcm_ = nullptr;
  int wakeup_[2] = {-1, -1};
  std::string host_, records_;
  std::thread thread_;
  std::mutex sending_;  // before `mutex`
  std::vector<std::shared_ptr<Participant>> participants_;
  std::vector<lcm_subscription_t*> removals_;
  std::deque<std::unique_ptr<Take>> takes_;  // kept until the end: liblcm may still call one
  std::int64_t due_ = steady_now() + period, answer_due_ = never, nonce_ = 0, next_count_ = 0, first_signal_ = 0, step_ = -1;
  std::map<std::string, std::int64_t> aimed_;  // nonces of probes of single nodes; of the own thread alone
  std::int64_t aimed_from_ = 0;
  bool owes_another_ = false, is_behind_ = true, is_shutdown_requested_ = false;
  std::atomic<bool> is_closed_{false};
  std::minstd_rand random_{std::random_device{}()};
};

// The program's context and its signal handlers: init and spin are functions, as in rclcpp.
struct Process {
  std::shared_ptr<Context> context;
  std::vector<std::pair<int, struct sigaction>> handlers;  // as before init
  std::terminate_handler on_terminate = nullptr;
};
inline Process& process() {
  static Process one;
  return one;
}

inline std::shared_ptr<Context> current_context() {
  if (!process().context) throw Error("there is no bus yet", "call lcmtools::init(argc, argv) first");
  return process().context;
}

// Print an Error that nobody caught as one line, and end the program with its goodbyes.
inline void on_terminate() {
  try {
    if (const auto current = std::current_exception()) std::rethrow_exception(current);
  } catch (const Error& error) {
    std::cerr << "error: " << error.what() << std::endl;
    std::exit(1);
  } catch (...) {
  }
  if (process().on_terminate) process().on_terminate();
  std::abort();
}

}  // namespace detail

// Return whether the program should go on: false after Ctrl-C, SIGTERM and shutdown.
inline bool ok() { return detail::process().context && !detail::signals.is_stopping; }

// Say goodbye for all nodes and leave the bus. A second call does nothing.
inline void shutdown() {
  const auto context = std::exchange(detail::process().context, nullptr);
  if (!context) return;
  context->close();
  detail::signals.wakeup = -1;
  for (const auto& [number, action] : detail::process().handlers) ::sigaction(number, &action, nullptr);
  detail::process().handlers.clear();
}

// Connect this program to the bus: the first thing a node's program does. Names (__ns:=, a:=b),
// parameters (_gain:=2.0) and the bus (--lcm-url, --domain) are taken from the command line; the
// remaining arguments are returned. Unless `handle_signals` is false, SIGINT, SIGTERM, SIGHUP and
// SIGPIPE (as in `./node | head`) make spin return and ok() false.
inline std::vector<std::string> init(int argc, const char* const* argv, bool handle_signals = true) {
  auto& process = detail::process();
  if (!process.on_terminate) process.on_terminate = std::set_terminate(detail::on_terminate);
  if (process.context) throw Error("lcmtools::init() was called twice", "call lcmtools::shutdown() between");
  std::string command;
  for (int i = 0; i < argc; ++i) command += (i ? " " : "") + std::string(argv[i]);
  Arguments said = split_arguments({argv + std::min(argc, 1), argv + argc});
  const auto rest = said.rest;
  detail::signals.is_stopping = false;
  process.context = std::make_shared<detail::Context>(std::move(said), command.substr(0, 1000));
  for (const auto& word : rest) {
    if (word == "--") break;
    if (word.find(":=") != std::string::npos)
      process.context->notices.push_back("'" + word + "' names nothing; write from:=to without spaces");
  }
  detail::signals.wakeup = process.context->wakeup();
  for (int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction action = {}, before = {};
    action.sa_handler = detail::lcmtools_on_signal;
    ::sigaction(number, nullptr, &before);
    const bool may_be_ignored = number == SIGHUP || number == SIGPIPE;
    if (!handle_signals || (may_be_ignored && before.sa_handler == SIG_IGN)) continue;
    ::sigaction(number, &action, nullptr);
    process.handlers.emplace_back(number, before);
  }
  static const bool is_registered = std::atexit(shutdown) == 0;
  return (void)is_registered, rest;
}

}  // namespace lcmtools
