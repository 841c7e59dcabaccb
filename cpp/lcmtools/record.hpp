// The record of a running node (docs/protocol.md, Files), by which a killed one is noticed: a small
// file that is removed when the node ends. Include node.hpp instead.
#pragma once

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "lcmtools/wire.hpp"

namespace lcmtools::detail {

// Return the folder of the records of one bus: "udpm-239.255.76.67-7667" in the runtime folder.
inline std::string record_folder(const std::string& url) {
  const auto sign = url.find("://"), start = sign + 3;
  const std::string provider = url.substr(0, sign), network = url.substr(start, url.find('?') - start);
  const bool is_server = provider == "tcpq", is_group = provider == "udpm" || provider == "mpudpm";
  const auto colon = network.find(':');
  std::string host = network.substr(0, colon), port = colon == std::string::npos ? "" : network.substr(colon + 1);
  if (host.empty()) host = is_server ? "127.0.0.1" : "239.255.76.67";
  if (port.empty()) port = is_server ? "7700" : "7667";
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  struct stat status = {};
  const bool has_runtime = runtime && ::stat(runtime, &status) == 0 && S_ISDIR(status.st_mode);
  const std::string base = has_runtime ? std::string(runtime) + "/lcmtools" : "/tmp/lcmtools-" + std::to_string(::getuid());
  return base + "/records/" + provider + "-" + (is_server || is_group ? host + "-" + port : "-0");
}

// Make a folder below a base that no other user can write into; return false if that cannot be.
inline bool make_private(const std::string& folder) {
  const std::string records = folder.substr(0, folder.rfind('/')), base = records.substr(0, records.rfind('/'));
  for (const auto& one : {base, records, folder}) ::mkdir(one.c_str(), 0700);
  struct stat inner = {}, outer = {};
  return ::lstat(folder.c_str(), &inner) == 0 && ::lstat(base.c_str(), &outer) == 0 && S_ISDIR(inner.st_mode) &&
         inner.st_uid == ::getuid() && outer.st_uid == ::getuid() && !(outer.st_mode & (S_IWGRP | S_IWOTH));
}

inline std::string json(const std::string& text) {
  std::string result = "\"";
  for (unsigned char c : text) {
    char code[8];
    std::snprintf(code, sizeof code, "\\u%04x", c);
    if (c == '"' || c == '\\') result += '\\';
    if (c < 0x20) result += code;
    else result += static_cast<char>(c);
  }
  return result + '"';
}

// Return the process's start [clock ticks since boot]: with the pid, its identity.
inline std::string start_ticks() {
  std::ifstream file("/proc/self/stat");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  auto at = text.rfind(')');
  for (int field = 2; field < 22 && at != std::string::npos; ++field) at = text.find(' ', at + 1);
  return at == std::string::npos ? "0" : text.substr(at + 1, text.find(' ', at + 1) - at - 1);
}

// Return the number of one of the process's namespaces, "net" or "pid"; 0 if the system has none.
inline std::int64_t own_namespace(const std::string& kind) {
  struct stat status = {};
  return ::stat(("/proc/self/ns/" + kind).c_str(), &status) == 0 ? static_cast<std::int64_t>(status.st_ino) : 0;
}

// Return a number of the process's network namespace, which no later one gets; 0 if unknown.
inline std::uint64_t network_cookie() {
  constexpr int so_netns_cookie = 71;  // asm-generic/socket.h, since Linux 5.14
  std::uint64_t cookie = 0;
  socklen_t size = sizeof cookie;
  const int one = ::socket(AF_INET, SOCK_DGRAM, 0);
  if (one < 0 || ::getsockopt(one, SOL_SOCKET, so_netns_cookie, &cookie, &size) != 0) cookie = 0;
  if (one >= 0) ::close(one);
  return cookie;
}

inline std::string topics_of(const std::vector<wire::Endpoint>& ends, wire::Role role) {
  std::string list;
  for (const auto& end : ends)
    if (end.role == role) list += (list.empty() ? "" : ", ") + json(end.topic);
  return "[" + list + "]";
}

inline void write_record(const std::string& folder, const wire::Announcement& node, const std::vector<wire::Endpoint>& ends) {
  if (!make_private(folder)) return;
  const std::string temporary = folder + "/." + node.id;
  std::ofstream file(temporary);
  file << "{\"version\": " << node.version << ", \"name\": " << json(node.name) << ", \"id\": " << json(node.id)
       << ", \"host\": " << json(node.host) << ", \"pid\": " << node.pid << ", \"start_time\": " << node.start_time
       << ", \"command\": " << json(node.command) << ", \"start_ticks\": " << start_ticks()
       << ", \"network\": " << own_namespace("net") << ", \"network_cookie\": " << network_cookie()
       << ", \"pid_namespace\": " << own_namespace("pid") << ", \"publishes\": " << topics_of(ends, wire::PUBLISHER)
       << ", \"subscribes\": " << topics_of(ends, wire::SUBSCRIBER) << "}";
  file.close();
  if (!file || std::rename(temporary.c_str(), (folder + "/" + node.id + ".json").c_str()) != 0) std::remove(temporary.c_str());
}

inline void remove_record(const std::string& folder, const std::string& id) { std::remove((folder + "/" + id + ".json").c_str()); }

}  // namespace lcmtools::detail
