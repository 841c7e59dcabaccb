// Names of nodes, topics and services, and a node's command line, by the rules of lcmtools/names.py
// and lcmtools/arguments.py. Text only: nothing here knows the bus. Include node.hpp instead.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lcmtools {

// An operation failed: what, and the remedy, in one line.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& what, const std::string& hint = "")
      : std::runtime_error(hint.empty() ? what : what + "; " + hint) {}
};

// Return a text as printf makes it.
[[gnu::format(printf, 1, 2)]] inline std::string format(const char* pattern, ...) {
  va_list values, again;
  va_start(values, pattern);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, pattern, values))), ' ');
  std::vsnprintf(text.data(), text.size() + 1, pattern, again);
  va_end(again);
  va_end(values);
  return text;
}

namespace detail {

// Escape what could change a terminal.
inline std::string printable(const std::string& text, const char* kept = "\n\t") {
  std::string result;
  for (char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if ((code >= 0x20 && code != 0x7f) || (c && std::strchr(kept, c))) result += c;
    else result += format("\\x%02x", code);
  }
  return result;
}

}  // namespace detail

namespace names {

constexpr std::size_t max_channel_bytes = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_word(char c) { return is_letter(c) || is_digit(c) || c == '_'; }
inline bool is_in(char c, const char* others) { return c && std::string(others).find(c) < std::string::npos; }

// Return true if the first character is a letter or in `first`, and the others are those of names
// or in `more`.
inline bool has_form(const std::string& text, const char* first, const char* more) {
  if (text.empty() || !(is_letter(text[0]) || is_in(text[0], first))) return false;
  return std::all_of(text.begin() + 1, text.end(),
                     [more](char c) { return is_word(c) || is_in(c, more); });
}

inline void check_legal(const std::string& name) {
  if (!name.empty() && !has_form(name, "~/", "/"))
    throw Error("'" + name + "' is not a legal name",
                "names are made of letters, digits, '_' and '/', and start with a letter, '/' or '~'");
}

inline void check_base_name(const std::string& name) {
  if (!has_form(name, "_", ""))
    throw Error("'" + name + "' is not a legal node name",
                "a node's name is letters, digits and '_', and does not start with a digit; "
                "its namespace is given by __ns:=");
}

inline std::string check_length(const std::string& channel) {
  if (channel.empty() || channel.find('\0') != std::string::npos)
    throw Error("a channel name must not be empty or contain a zero byte");
  if (channel.size() > max_channel_bytes)
    throw Error("'" + channel + "' has " + std::to_string(channel.size()) +
                    " bytes and LCM channels have at most 63",
                "use a shorter name or namespace");
  return channel;
}

// Collapse "//" and drop a trailing "/".
inline std::string clean(const std::string& name) {
  std::string result;
  for (char c : name)
    if (c != '/' || result.empty() || result.back() != '/') result += c;
  while (!result.empty() && result.back() == '/') result.pop_back();
  return result.empty() ? "/" : result;
}

// Return the full form of a name: "/a" unchanged, "a" in the namespace, "~a" below the node.
inline std::string resolve(const std::string& name, const std::string& ns = "/",
                           const std::string& node = "") {
  check_legal(name);
  if (name[0] == '~') {
    if (node.empty()) throw Error("'" + name + "' is private, and there is no node here");
    return clean(node + "/" + name.substr(1));
  }
  return clean(name[0] == '/' ? name : ns + "/" + name);
}

inline std::string resolve_namespace(const std::string& ns) { return ns.empty() ? "/" : resolve(ns); }

using Remaps = std::vector<std::pair<std::string, std::string>>;  // (from, to) as written

// Resolves the names in a node's code.
struct Resolver {
  std::string ns = "/";
  std::string node;  // its full name
  Remaps remaps;

  std::string expand(const std::string& name) const { return names::resolve(name, ns, node); }

  // Return the full name of a topic or service, remapped; the last of several equal rules wins.
  std::string resolve(const std::string& name) const {
    const std::string resolved = expand(name);
    for (auto rule = remaps.rbegin(); rule != remaps.rend(); ++rule)
      if (expand(rule->first) == resolved) return check_length(expand(rule->second));
    return check_length(resolved);
  }
};

}  // namespace names

// The names, parameters and bus in a node's command line; empty for those not given.
struct Arguments {
  std::string ns, name, lcm_url, domain;
  names::Remaps remaps;
  std::map<std::string, std::string> parameters;  // private, name to YAML text
  std::vector<std::string> rest;                  // the program's own arguments
};

namespace detail {

// Split "key:=value" as in ROS; return false for other words.
inline bool split_assignment(const std::string& word, std::string& key, std::string& value) {
  const auto sign = word.find(":=");
  if (sign == std::string::npos) return false;
  key = word.substr(0, sign);
  value = word.substr(sign + 2);
  const bool is_parameter = key.size() > 1 && key[0] == '_' && names::has_form(key.substr(1), "", "/.");
  return is_parameter || names::has_form(key, "~/_", "/");
}

inline void add_assignment(Arguments& said, const std::string& key, const std::string& value) {
  if (value.empty() || key == "__log" || key == "__ip" || key == "__hostname" || key == "__master")
    return;  // as in ROS; the last four mean nothing with LCM
  if (key == "__ns")
    said.ns = value;
  else if (key == "__name" || key == "__node")
    said.name = value;
  else if (key.compare(0, 2, "__") == 0)
    throw Error(key + ":=" + value + ": there is no such special name", "the special names: __ns, __name");
  else if (key[0] == '_')
    said.parameters[key.substr(1)] = value;
  else
    said.remaps.emplace_back(key, value);
}

inline void add_flag(Arguments& said, const std::string& flag, const std::string& value) {
  static const std::map<std::string, std::string Arguments::*> fields = {
      {"--ns", &Arguments::ns}, {"--name", &Arguments::name},
      {"--lcm-url", &Arguments::lcm_url}, {"--domain", &Arguments::domain}};
  if (const auto field = fields.find(flag); field != fields.end()) {
    said.*(field->second) = value;
    return;
  }
  const auto start = std::min(value.find_first_not_of("~/_"), value.size());
  const bool is_parameter = flag == "--param" && start < value.size() && names::is_letter(value[start]);
  std::string key, text;
  if (!split_assignment(is_parameter ? "_" + value.substr(start) : value, key, text))
    throw Error(flag + " " + value + ": expected two names with := between");
  add_assignment(said, key, text);
}

}  // namespace detail

// Split an argument list, without the program's name, into names, parameters, and the rest.
inline Arguments split_arguments(const std::vector<std::string>& words) {
  static const std::vector<std::string> flags = {"--ns",        "--name", "--lcm-url", "--domain",
                                                 "--param", "--remap", "-r"};
  Arguments said;
  std::string key, value;
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (*word == "--") {  // the words after it are the program's own
      said.rest.insert(said.rest.end(), word, words.end());
      break;
    }
    const auto equals = word->find('=');
    const std::string flag = word->substr(0, equals);
    if (std::find(flags.begin(), flags.end(), flag) != flags.end()) {
      if (equals == std::string::npos && ++word == words.end()) throw Error(flag + " needs a value");
      detail::add_flag(said, flag, equals == std::string::npos ? *word : word->substr(equals + 1));
    } else if (detail::split_assignment(*word, key, value)) {
      detail::add_assignment(said, key, value);
    } else {
      said.rest.push_back(*word);
    }
  }
  return said;
}

}  // namespace lcmtools
