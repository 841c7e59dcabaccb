// A program's context: the announcements of its nodes, and its signals. A thread of its own announces,
// and receives messages into queues while no thread that waits for them does so itself. Users'
// callbacks run elsewhere (node.hpp). Include node.hpp instead.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <map>
#include <set>

#include "lcmtools.h"
#include "lcmtools/receiving.hpp"

namespace lcmtools {

constexpr const char* version = "0.1.0";  // of lcmtools

namespace detail {

class Context : public Receiver {
 public:
  Arguments arguments;
  std::string command;
  std::vector<std::string> notices;       // warnings about the command line, for the next node's log
  std::set<std::string> declared;         // names of parameters
  std::set<std::string> used, used_remaps;  // full names of topics before remaps; remaps that applied
  bool is_first = true;                   // __name:= names the first node
  const std::string ns = default_namespace();

  Context(Arguments said, std::string command_line)
      : Receiver(choose_url(said)), arguments(std::move(said)), command(std::move(command_line)) {
    char name[256] = "";
    ::gethostname(name, sizeof name - 1);
    host_ = name;
    if (!lcmtools_make_folder(records_, sizeof records_, url.c_str())) *records_ = '\0';
    subscribe("/_lcmtools/probe", [this](auto data, auto size) { take_probe(data, size); });
    subscribe("/_lcmtools/shutdown", [this](auto data, auto size) { take_shutdown(data, size); });
    if (is_in_lockstep()) subscribe("/_lcmtools/step", [this](auto data, auto size) { take_step(data, size); });
    // the signals are for the program's own threads
    sigset_t ending, usual;
    sigemptyset(&ending);
    for (int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&ending, number);
    pthread_sigmask(SIG_BLOCK, &ending, &usual);
    thread_ = std::thread([this] { run(); });
    pthread_sigmask(SIG_SETMASK, &usual, nullptr);
  }
  ~Context() { close(); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  int wakeup() const { return wakeup_.ends[1]; }
  bool is_closed() const { return is_closed_; }

  void stop() {
    signals.is_stopping = true;
    wakeup_.set();
    notify();
  }

  void say_all_goodbyes() {
    std::vector<std::shared_ptr<Participant>> nodes;
    {
      const std::lock_guard lock(mutex);
      nodes = participants_;
    }
    for (const auto& one : nodes) remove(one);
  }
  // Say goodbye for all nodes, and receive no more.
  void close() {
    if (is_closed_.exchange(true)) return;
    stop();
    say_all_goodbyes();
    if (thread_.joinable()) thread_.join();
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
    lcmtools_remove_record(records_, participant->id.c_str());
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
  bool has_step_locked() const { return step_ >= 0; }

  // Return the node that has a service in this program, if no other thread spins it.
  std::string idle_server_locked(const std::string& service) const {
    for (const auto& node : participants_)
      for (const auto& end : node->ends)
        if (end->record.role == wire::SERVICE && end->record.topic == service &&
            (node->spinner == std::thread::id() || node->spinner == std::this_thread::get_id()))
          return node->name;
    return "";
  }

  void repeat_soon_locked(std::int64_t due) {
    if (due < repeat_due_) repeat_due_ = due, wakeup_.set();
  }

  void announce_soon() {
    const std::lock_guard lock(mutex);
    announce_soon_locked();
  }
  void announce_soon_locked() {
    is_behind_ = true;
    const auto due = steady_now() + change_delay;
    if (due < due_) due_ = due, wakeup_.set();
  }
  // Announce all nodes now if one has changed, ahead of any message that is sent next.
  void announce_changes() {
    std::unique_lock lock(mutex);
    const bool is_behind = is_behind_;
    lock.unlock();
    if (is_behind) announce();
  }

 private:
  void run() {
    while (!is_closed_) {
      take_turn(next_due());
      if (wakeup_.clear()) take_signal();
      announce_if_due();
      answer_aimed();
      repeat();
    }
  }

  std::int64_t next_due() {
    const std::lock_guard lock(mutex);
    return std::min({due_, answer_due_, repeat_due_, aimed_.empty() ? never : aimed_from_});
  }

  // Send requests again that were not answered.
  void repeat() {
    const auto now = steady_now();
    std::vector<std::pair<std::string, wire::Bytes>> sent;
    {
      const std::lock_guard lock(mutex);
      if (now < repeat_due_) return;
      repeat_due_ = never;
      for (const auto& node : participants_)
        for (const auto& end : node->ends) repeat_due_ = std::min(repeat_due_, end->repeat(now, sent));
    }
    for (const auto& [channel, payload] : sent) publish(channel, payload.data(), payload.size());
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
    notify();
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
    std::unique_lock lock(mutex);
    if (aimed_.empty() || steady_now() < aimed_from_) return;
    const auto aimed = std::exchange(aimed_, {});
    aimed_from_ = steady_now() + answer_spread;
    lock.unlock();
    for (const auto& [name, nonce] : aimed) announce(nonce, name);
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
    details.pid_namespace = lcmtools_namespace("/proc/self/ns/pid");
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
    if (!*records_ || std::exchange(node.recorded, described.revision) == described.revision) return;
    lcmtools_announcer file = {};  // only what is recorded
    const auto copy = [](char* field, std::size_t room, const std::string& text) { text.copy(field, room - 1); };
    copy(file.name, sizeof file.name, node.name), copy(file.id, sizeof file.id, node.id);
    copy(file.host, sizeof file.host, host_), copy(file.command, sizeof file.command, command);
    copy(file.folder, sizeof file.folder, records_);
    file.start_time = node.start_time;
    for (const auto& end : node.ends)
      if (end->record.role <= wire::SUBSCRIBER) lcmtools_add_topic(&file, end->record.topic.c_str(), end->record.role);
    lcmtools_write_record(&file);
    for (const auto& topics : file.topics) std::free(topics.data);
  }

  void take_probe(const std::uint8_t* data, std::size_t size) {
    wire::Probe probe;
    if (probe.decode(data, 0, static_cast<int>(size)) < 0) return;
    const std::lock_guard lock(mutex);
    wakeup_.set();  // another thread may receive
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

  std::string host_;
  char records_[512] = "";  // the folder of the records of running nodes
  std::thread thread_;
  std::mutex sending_;  // before `mutex`
  std::vector<std::shared_ptr<Participant>> participants_;
  std::int64_t due_ = steady_now() + period, repeat_due_ = never, answer_due_ = never, nonce_ = 0, next_count_ = 0, first_signal_ = 0, step_ = -1;
  std::map<std::string, std::int64_t> aimed_;  // nonces of probes of single nodes
  std::int64_t aimed_from_ = 0;
  bool owes_another_ = false, is_behind_ = true, is_shutdown_requested_ = false;
  std::atomic<bool> is_closed_{false};
  std::minstd_rand random_{std::random_device{}()};
};

// The program's context and its signal handlers: init and spin are functions, as in rclcpp.
struct Process {
  std::shared_ptr<Context> context;
  std::vector<std::pair<int, struct sigaction>> handlers;  // as before init
};
inline Process& process() {
  static Process one;
  return one;
}

inline std::shared_ptr<Context> current_context() {
  if (!process().context) throw Error("there is no bus yet", "call lcmtools::init(argc, argv) first");
  return process().context;
}

// Print an Error that nobody caught as one line, and end the program with its goodbyes. As always when
// an exception is not caught, no destructor runs: other threads go on meanwhile.
inline void on_terminate();
inline const std::terminate_handler earlier_on_terminate = std::set_terminate(on_terminate);
inline void on_terminate() {
  try {
    if (const auto current = std::current_exception()) std::rethrow_exception(current);
  } catch (const Error& error) {
    std::cerr << "error: " + printable(error.what(), "") + "\n" << std::flush;
    if (const auto context = process().context) context->say_all_goodbyes();
    std::cout.flush();
    std::fflush(nullptr);
    std::_Exit(1);
  } catch (...) {
  }
  earlier_on_terminate();
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
