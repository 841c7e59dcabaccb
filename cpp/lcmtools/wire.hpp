// The messages of the protocol of nodes (docs/protocol.md), each described once by `fields`, from
// which it is written and read. They have the functions of lcm-gen's C++ types. Include node.hpp
// instead.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace lcmtools::wire {

using Bytes = std::vector<std::uint8_t>;

// Writes LCM's encoding: big-endian numbers, strings with their length and a zero byte.
struct Writer {
  Bytes bytes;

  // Write fields, after the lengths of the arrays among them.
  template <class... Fields>
  void operator()(const Fields&... fields) {
    (length(fields), ...);
    (write(fields), ...);
  }

 private:
  template <class T>
  void length(const T&) {}
  template <class T>
  void length(const std::vector<T>& elements) {
    write(static_cast<std::int32_t>(elements.size()));
  }
  template <class T>
  void write(const std::vector<T>& elements) {
    for (const auto& element : elements) write(element);
  }
  template <class T>
  void write(const T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      write(static_cast<std::int32_t>(value.size() + 1));
      bytes.insert(bytes.end(), value.c_str(), value.c_str() + value.size() + 1);
    } else if constexpr (std::is_same_v<T, double>) {
      std::int64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      write(bits);
    } else if constexpr (std::is_arithmetic_v<T>) {
      for (int shift = 8 * (sizeof(T) - 1); shift >= 0; shift -= 8)
        bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> shift));
    } else {
      std::apply(*this, const_cast<T&>(value).fields());  // which are only read
    }
  }
};

// Reads LCM's encoding; `is_good` is false once bytes were missing.
struct Reader {
  const std::uint8_t* next;
  const std::uint8_t* end;
  bool is_good = true;

  template <class... Fields>
  void operator()(Fields&... fields) {
    (length(fields), ...);
    (read(fields), ...);
  }

 private:
  bool has(std::int64_t size) { return is_good = is_good && size >= 0 && size <= end - next; }

  template <class T>
  void length(T&) {}
  template <class T>
  void length(std::vector<T>& elements) {
    std::int32_t number = 0;
    read(number);
    elements.assign(has(number) ? static_cast<std::size_t>(number) : 0, {});  // each has at least one byte
  }
  template <class T>
  void read(std::vector<T>& elements) {
    for (auto& element : elements) read(element);
  }
  template <class T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      std::int32_t size = 0;
      read(size);
      if (!has(size) || size < 1) return void(is_good = false);
      value.assign(reinterpret_cast<const char*>(next), static_cast<std::size_t>(size - 1));
      next += size;
    } else if constexpr (std::is_same_v<T, double>) {
      std::int64_t bits = 0;
      read(bits);
      std::memcpy(&value, &bits, sizeof bits);
    } else if constexpr (std::is_arithmetic_v<T>) {
      if (!has(sizeof(T))) return;
      std::uint64_t bits = 0;
      for (std::size_t i = 0; i < sizeof(T); ++i) bits = bits << 8 | *next++;
      value = static_cast<T>(bits);
    } else {
      std::apply(*this, value.fields());
    }
  }
};

template <class T>
Bytes encoded(const T& message) {  // without a fingerprint, as in Appendable
  Writer writer;
  writer(message);
  return std::move(writer.bytes);
}

// The functions of a type of lcm-gen, for a struct with `fields`.
template <class Struct, std::uint64_t Fingerprint>
struct Message {
  static std::int64_t getHash() { return static_cast<std::int64_t>(Fingerprint); }

  Bytes packed() const {
    Writer writer;
    writer(getHash());
    writer(static_cast<const Struct&>(*this));
    return std::move(writer.bytes);
  }
  int getEncodedSize() const { return static_cast<int>(packed().size()); }
  int encode(void* buffer, int offset, int room) const {
    const Bytes bytes = packed();
    if (static_cast<int>(bytes.size()) > room) return -1;
    std::memcpy(static_cast<char*>(buffer) + offset, bytes.data(), bytes.size());
    return static_cast<int>(bytes.size());
  }
  int decode(const void* buffer, int offset, int size) {
    const auto* start = static_cast<const std::uint8_t*>(buffer) + offset;
    Reader reader{start, start + size};
    std::int64_t hash = 0;
    reader(hash);
    if (!reader.is_good || hash != getHash()) return -1;
    reader(static_cast<Struct&>(*this));
    return reader.is_good ? static_cast<int>(reader.next - start) : -1;
  }
};

struct Appendable {
  Bytes data;
  auto fields() { return std::tie(data); }
};

enum Role : std::int8_t { PUBLISHER, SUBSCRIBER, SERVICE, CLIENT };

struct Endpoint {
  std::string topic, group;
  std::int8_t role = PUBLISHER;
  std::vector<std::string> types;
  std::vector<std::int64_t> fingerprints;
  std::int32_t depth = 0;
  bool latched = false;
  std::int64_t messages = 0, bytes = 0, drops = 0, last_time = 0, calls = 0, busy = 0, longest = 0;
  std::int64_t incomplete = 0;
  double rate = 0;
  auto fields() {
    return std::tie(topic, role, types, fingerprints, group, depth, latched, messages, bytes, drops, last_time,
                    calls, busy, longest, rate, incomplete);
  }
};

struct CallbackError {
  std::string callback, exception, message, place;
  std::int64_t count = 0, last_time = 0;
  auto fields() { return std::tie(callback, exception, message, place, count, last_time); }
};

struct NodeDetails {
  std::vector<std::int32_t> ports;
  std::vector<Appendable> endpoints, errors;
  std::int64_t busy = 0, pid_namespace = 0, overflows = 0;  // 0 also if unknown
  Appendable observed;  // by relays only
  auto fields() { return std::tie(ports, endpoints, busy, errors, pid_namespace, overflows, observed); }
};

struct Announcement : Message<Announcement, 0x04FC851A704B5456> {
  static constexpr std::int8_t LEAVING = 1;
  std::int32_t version = 2, pid = 0;
  std::string name, host, id, command, software;
  std::int64_t start_time = 0, revision = 0, answers = 0, sent = 0;
  std::int8_t state = 0;
  bool tool = false;
  Bytes details;
  auto fields() {
    return std::tie(version, name, host, pid, start_time, id, state, revision, tool, command, software, answers,
                    sent, details);
  }
};

struct Probe : Message<Probe, 0x36A8CC66FEBE4DC8> {
  std::string target;
  std::int64_t nonce = 0;
  auto fields() { return std::tie(target, nonce); }
};

struct Shutdown : Message<Shutdown, 0x2E46E88DD1CD3B5F> {
  std::string target, requester;
  std::int64_t nonce = 0;
  auto fields() { return std::tie(target, nonce, requester); }
};

struct ServiceRequest : Message<ServiceRequest, 0x208E80B7F6920AEE> {
  std::string client;
  std::int64_t sequence = 0;
  Bytes payload;
  auto fields() { return std::tie(client, sequence, payload); }
};

struct ServiceReply : Message<ServiceReply, 0xD7C6C2990B932630> {
  std::string client, error;
  std::int64_t sequence = 0;
  std::int8_t status = 0;  // 0 OK
  Bytes payload;
  auto fields() { return std::tie(client, sequence, status, error, payload); }
};

struct Parameter {
  std::string name, type, value, description, minimum, maximum;
  bool read_only = false;
  auto fields() { return std::tie(name, type, value, description, minimum, maximum, read_only); }
};

struct Parameters_Request : Message<Parameters_Request, 0x777BDB458F3E0541> {
  static constexpr const char* lcm_type = "lcmtools_msgs/Parameters_Request";
  std::vector<Parameter> changes;
  auto fields() { return std::tie(changes); }
};

struct Parameters_Response : Message<Parameters_Response, 0x65C38BA64D96A12F> {
  static constexpr const char* lcm_type = "lcmtools_msgs/Parameters_Response";
  std::vector<Parameter> parameters;
  std::vector<std::string> errors;
  auto fields() { return std::tie(parameters, errors); }
};

struct Log : Message<Log, 0x86319CDCAD46013C> {
  enum Level : std::int8_t { DEBUG = 1, INFO = 2, WARN = 4, ERROR = 8, FATAL = 16 };
  static constexpr const char* lcm_type = "rosgraph_msgs/Log";
  std::int32_t seq = 0, sec = 0, nsec = 0, line = 0;
  std::int8_t level = INFO;
  std::string frame_id, name, msg, file, function;
  std::vector<std::string> topics;
  auto fields() { return std::tie(seq, sec, nsec, frame_id, level, name, msg, file, function, line, topics); }
};

struct Step {  // the answer to a step, without a fingerprint
  std::int64_t number = 0, next_timer = 0;
  auto fields() { return std::tie(number, next_timer); }
};

struct Clock : Message<Clock, 0x687F596782C2807A> {
  static constexpr const char* lcm_type = "rosgraph_msgs/Clock";
  std::int32_t sec = 0, nsec = 0;
  auto fields() { return std::tie(sec, nsec); }
};

}  // namespace lcmtools::wire
