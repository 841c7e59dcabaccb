// The choice of the bus, as in lcmtools/settings. Include node.hpp instead.
#pragma once

#include <lcm/lcm.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "lcmtools/names.hpp"

namespace lcmtools::detail {

// Return "key: value" of the user's settings file, or "".
inline std::string user_setting(const std::string& key) {
  const char *config = std::getenv("XDG_CONFIG_HOME"), *home = std::getenv("HOME");
  const std::string folder = config && *config ? config : std::string(home ? home : "") + "/.config";
  std::ifstream file(folder + "/lcmtools/config.yaml");
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, key.size() + 1, key + ":") != 0) continue;
    line = line.substr(key.size() + 1, line.find(" #") - key.size() - 1);
    line.erase(std::remove_if(line.begin(), line.end(), [](char c) { return names::is_in(c, " \t\r'\""); }), line.end());
    return line;
  }
  return "";
}

inline std::string domain_url(const std::string& domain) {
  const bool is_number = !domain.empty() && domain.size() < 4 && std::all_of(domain.begin(), domain.end(), names::is_digit);
  if (!is_number || std::stoi(domain) > 232)
    throw Error("'" + domain + "' is not a domain", "a domain is a number from 0 to 232");
  return "udpm://239.255.76.67:" + std::to_string(7667 + std::stoi(domain)) + "?ttl=0";
}

// Return the bus: of the command line, else the environment, else the user's file, else the default.
inline std::string choose_url(const Arguments& arguments) {
  const auto variable = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  if (!arguments.lcm_url.empty()) return arguments.lcm_url;
  if (!arguments.domain.empty()) return domain_url(arguments.domain);
  if (const auto url = variable("LCM_DEFAULT_URL"); !url.empty()) return url;
  if (const auto domain = variable("LCMTOOLS_DOMAIN"); !domain.empty()) return domain_url(domain);
  if (const auto url = user_setting("lcm_url"); !url.empty()) return url;
  const auto domain = user_setting("domain");
  return domain_url(domain.empty() ? "0" : domain);
}

// Return whether a recording is played to this program in lock-step; `start` is the time then [ns].
inline bool is_in_lockstep(std::int64_t* start = nullptr) {
  const char* variable = std::getenv("LCMTOOLS_LOCKSTEP");
  if (variable && start) *start = std::atoll(variable);
  return variable && *variable;
}

inline std::string default_namespace() {
  const char* variable = std::getenv("LCMTOOLS_NAMESPACE");
  return variable && *variable ? variable : user_setting("namespace");
}

// Ask for as large a receive buffer as the system grants, unless the URL has one: an image's fragments
// come in one burst.
inline std::string with_buffer(const std::string& url) {
  long most = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> most;
  if (most <= 0 || url.find("udpm") > 2 || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=" + std::to_string(std::min(most, 8L << 20));
}

inline lcm_t* open_bus(const std::string& url) {
  static const std::vector<std::string> providers = {"udpm", "mpudpm", "tcpq", "memq", "file"};
  const auto provider = url.substr(0, url.find("://"));
  const std::string example = "write udpm://239.255.76.67:7667?ttl=0";
  if (provider == "zenoh") throw Error(url + ": liblcm has no Zenoh", "lcmtools relay connects it with another bus");
  if (std::find(providers.begin(), providers.end(), provider) == providers.end())
    throw Error("LCM URL '" + url + "': no LCM provider '" + provider + "'", example);
  const auto group = url.substr(std::min(url.size(), provider.size() + 3), url.find('?') - provider.size() - 3);
  if (provider.find("udpm") != std::string::npos && !group.empty()) {
    if (group.find(':') == std::string::npos) throw Error("LCM URL '" + url + "': the port is missing", example);
    const auto port = group.substr(group.find(':') + 1);  // liblcm takes another for 0, and hangs
    const bool is_number = !port.empty() && port.size() < 6 && std::all_of(port.begin(), port.end(), names::is_digit);
    if (!is_number || std::stoi(port) < 1 || std::stoi(port) > 65535)
      throw Error("LCM URL '" + url + "': '" + port + "' is not a port", example);
  }
  lcm_t* lcm = lcm_create(with_buffer(url).c_str());
  if (!lcm) throw Error("cannot connect to " + url, "see lcmtools wtf");
  return lcm;
}

}  // namespace lcmtools::detail
