// Services and clients. Include node.hpp instead.
#pragma once

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

  // Send a request and wait for the response; throw Error if none comes in time, or the server
  // reports a failure. A callback may call this.
  Response call(const Request& request, std::chrono::duration<double> timeout = std::chrono::seconds(3)) {
    context_->announce_changes();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(timeout);
    wire::ServiceRequest envelope;
    envelope.client = id_, envelope.payload = detail::encode(request);
    std::unique_lock lock(context_->mutex);
    envelope.sequence = ++record.messages;
    awaited_.emplace(envelope.sequence, std::nullopt);
    const auto is_over = [&] { return awaited_[envelope.sequence].has_value() || detail::signals.is_stopping; };
    while (!is_over() && std::chrono::steady_clock::now() < deadline) {
      lock.unlock();
      context_->publish(record.topic + "/_request", envelope);
      lock.lock();
      const auto again = std::chrono::steady_clock::now() + std::chrono::milliseconds(250);
      context_->changed.wait_until(lock, std::min(again, deadline), is_over);
    }
    const auto reply = awaited_.extract(envelope.sequence).mapped();
    lock.unlock();
    return response_in(reply, timeout.count());
  }

  void receive(const std::uint8_t* data, std::size_t size) override {
    wire::ServiceReply reply;
    if (reply.decode(data, 0, static_cast<int>(size)) < 0 || reply.client != id_) return;
    const auto place = awaited_.find(reply.sequence);
    if (place != awaited_.end() && !place->second) place->second = std::move(reply);
  }

 private:
  Response response_in(const std::optional<wire::ServiceReply>& reply, double timeout) const {
    const auto& name = record.topic;
    if (!reply && detail::signals.is_stopping) throw Error(name + " had not answered when the program had to end");
    if (!reply) throw Error(name + format(" did not answer within %g s", timeout), "see whether its node runs: lcmtools node list");
    if (reply->status != 0) throw Error(name + ": " + (reply->error.empty() ? "it failed, and does not say why" : reply->error));
    Response response;
    if (response.decode(reply->payload.data(), 0, static_cast<int>(reply->payload.size())) < 0)
      throw Error(name + ": the response is not of the type " + detail::TypeName<Response>::get());
    return response;
  }

  std::shared_ptr<detail::Context> context_;
  std::string id_ = detail::unique_id();
  std::map<std::int64_t, std::optional<wire::ServiceReply>> awaited_;
};

}  // namespace lcmtools
