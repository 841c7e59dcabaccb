// Services and clients. Include node.hpp instead.
#pragma once

#include <future>
#include <map>
#include <set>

#include "lcmtools/subscription.hpp"

namespace lcmtools {

// Answers requests. Made by Node::create_service.
template <class Request, class Response>
class Service : public detail::Queue {
 public:
  using SharedPtr = std::shared_ptr<Service>;
  using Callback = std::function<void(const Request&, Response&)>;

  Service(std::shared_ptr<detail::Context> context, detail::Participant& node, detail::Errors& errors,
          std::string name, Callback callback, detail::Place place)
      : Queue(std::move(context), node, errors, place), name_(std::move(name)), callback_(std::move(callback)) {}

  void receive(const std::uint8_t* data, std::size_t size) override {
    wire::ServiceRequest request;
    if (request.decode(data, 0, static_cast<int>(size)) < 0) return;
    // ignore a repetition of a request that still waits or is being executed
    if (unanswered_.size() < 100 && unanswered_.insert({request.client, request.sequence}).second) {
      const auto messages = record.messages;
      Queue::receive(data, size);
      record.messages = messages, record.bytes = record.last_time = 0;  // calls are counted, as in Python
    }
  }

 protected:
  // Execute a request once, and repeat the reply to a repeated one.
  void call(const wire::Bytes& payload) override {
    wire::ServiceRequest request;
    request.decode(payload.data(), 0, static_cast<int>(payload.size()));
    const Key key{request.client, request.sequence};
    if (!replies_.count(key)) {
      replies_[key] = reply_to(request).packed();
      order_.push_back(key);
      if (order_.size() > 1000) replies_.erase(order_.front()), order_.pop_front();
    }
    const auto& reply = replies_[key];
    {
      const std::lock_guard lock(context_->mutex);
      unanswered_.erase(key);
    }
    if (!context_->is_closed()) context_->publish(record.topic + "/_reply", reply.data(), reply.size());
  }

 private:
  using Key = std::pair<std::string, std::int64_t>;

  wire::ServiceReply reply_to(const wire::ServiceRequest& request) {
    {
      const std::lock_guard lock(context_->mutex);
      ++record.messages;
    }
    wire::ServiceReply reply;
    reply.client = request.client, reply.sequence = request.sequence, reply.status = 1;
    Request arguments;
    if (arguments.decode(request.payload.data(), 0, static_cast<int>(request.payload.size())) < 0) {
      reply.error = "the request is not of the type " + detail::TypeName<Request>::get();
      return reply;
    }
    errors_.guard(name_, place_, [&] {
      try {
        Response response{};
        callback_(arguments, response);
        reply.payload = detail::encode(response);
        reply.status = 0;
      } catch (const Error& error) {  // the callback's refusal, not a fault
        reply.error = error.what();
      } catch (const std::exception& error) {
        reply.error = detail::demangled(typeid(error).name()) + ": " + error.what();
        throw;
      }
    });
    return reply;
  }

  std::string name_;  // in the list of errors
  Callback callback_;
  std::set<Key> unanswered_;
  std::map<Key, wire::Bytes> replies_;
  std::deque<Key> order_;
};

// Calls a service. Made by Node::create_client.
template <class Request, class Response>
class Client : public detail::End {
 public:
  using SharedPtr = std::shared_ptr<Client>;
  explicit Client(std::shared_ptr<detail::Context> context) : context_(std::move(context)) {}

  // Send a request, which is repeated until the response is there; wait for it by
  // spin_until_future_complete. The future throws Error if the server reports a failure.
  std::future<Response> call_async(const Request& request) { return start(request).second; }
  std::future<Response> async_send_request(const Request& request) { return call_async(request); }  // as in rclcpp

  // Send a request and wait for the response; throw Error if none comes in time, or the server
  // reports a failure. A callback may call this.
  Response call(const Request& request, std::chrono::duration<double> timeout = std::chrono::seconds(3)) {
    auto [sequence, future] = start(request);
    if (context_->wait_for(future, detail::time_after(timeout))) return future.get();
    const bool is_ending = detail::signals.is_stopping;
    std::unique_lock lock(context_->mutex);
    awaited_.erase(sequence);
    const auto idle = context_->idle_server_locked(record.topic);
    lock.unlock();
    const auto& name = record.topic;
    if (is_ending) throw Error(name + " had not answered when the program had to end");
    const auto what = name + format(" did not answer within %g s", timeout.count());
    if (idle.empty()) throw Error(what, "see whether its node runs: lcmtools node list");
    throw Error(what + ": its node " + idle + " is in this program, and no other thread spins it",
                "use call_async, and spin_until_future_complete");
  }

  void receive(const std::uint8_t* data, std::size_t size) override {
    wire::ServiceReply reply;
    if (reply.decode(data, 0, static_cast<int>(size)) < 0 || reply.client != id_) return;
    auto found = awaited_.extract(reply.sequence);
    if (found.empty()) return;
    try {
      found.mapped().response.set_value(response_in(reply));
    } catch (const Error&) {
      found.mapped().response.set_exception(std::current_exception());
    }
  }

  std::int64_t repeat(std::int64_t now, std::vector<std::pair<std::string, wire::Bytes>>& sent) override {
    auto next = detail::never;
    for (auto& [sequence, call] : awaited_) {
      if (call.due <= now) {
        sent.emplace_back(record.topic + "/_request", call.request);
        call.due = now + (call.period = std::min(2 * call.period, 16 * retry_period));
      }
      next = std::min(next, call.due);
    }
    return next;
  }

 private:
  static constexpr std::int64_t retry_period = 250 * detail::ms;
  struct Call {
    wire::Bytes request;
    std::int64_t due, period = retry_period;  // when it is sent again, and the time before
    std::promise<Response> response;
  };

  std::pair<std::int64_t, std::future<Response>> start(const Request& request) {
    wire::ServiceRequest envelope;
    envelope.client = id_, envelope.payload = detail::encode(request);
    context_->announce_changes();
    std::unique_lock lock(context_->mutex);
    envelope.sequence = ++record.messages;
    auto& call = awaited_[envelope.sequence];
    call.request = envelope.packed(), call.due = detail::steady_now() + retry_period;
    context_->repeat_soon_locked(call.due);
    auto future = call.response.get_future();
    const auto payload = call.request;
    lock.unlock();
    context_->publish(record.topic + "/_request", payload.data(), payload.size());
    return {envelope.sequence, std::move(future)};
  }

  Response response_in(const wire::ServiceReply& reply) const {
    const auto& name = record.topic;
    if (reply.status != 0) throw Error(name + ": " + (reply.error.empty() ? "it failed, and does not say why" : reply.error));
    Response response;
    if (response.decode(reply.payload.data(), 0, static_cast<int>(reply.payload.size())) < 0)
      throw Error(name + ": the response is not of the type " + detail::TypeName<Response>::get());
    return response;
  }

  std::shared_ptr<detail::Context> context_;
  std::string id_ = detail::unique_id();
  std::map<std::int64_t, Call> awaited_;
};

}  // namespace lcmtools
