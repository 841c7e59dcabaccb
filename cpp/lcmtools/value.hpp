// Values of parameters, and their YAML in one line, as lcmtools/messages/setting.py reads and writes
// them. Include node.hpp instead.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "lcmtools/names.hpp"

namespace lcmtools {

using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<bool>,
                           std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>>;

namespace detail {

constexpr const char* kinds[] = {"bool", "int", "float", "string", "bool[]", "int[]", "float[]", "string[]"};
constexpr const char* readers[] = {"as_bool()", "as_int()", "as_double()", "as_string()", "as<std::vector<bool>>()",
                                   "as<std::vector<std::int64_t>>()", "as<std::vector<double>>()",
                                   "as<std::vector<std::string>>()"};

inline std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

inline std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\n"), last = text.find_last_not_of(" \t\n");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// Replace the escapes of YAML's double quotes, of which \u is kept.
inline std::string unescaped(const std::string& text) {
  static const std::string codes = "ntr0abefv", meanings = std::string("\n\t\r\0\a\b\x1b\f\v", 9);
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      result += text[i];
    } else if (const auto code = codes.find(text[++i]); code != std::string::npos) {
      result += meanings[code];
    } else if (text[i] == 'x' && i + 2 < text.size()) {
      result += static_cast<char>(std::strtol(text.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

// Return the content of a quoted text, and any other unchanged.
inline std::string unquoted(const std::string& text) {
  if (text.size() < 2 || text.front() != text.back() || !names::is_in(text[0], "'\"")) return text;
  std::string inner = text.substr(1, text.size() - 2);
  if (text[0] == '"') return unescaped(inner);
  for (auto at = inner.find("''"); at != std::string::npos; at = inner.find("''", at + 1)) inner.erase(at, 1);
  return inner;
}

inline Error misfit(const std::string& path, const std::string& expected, const std::string& text) {
  return Error(path + ": expected " + expected + ", got '" + text + "'");
}

inline void read(bool& value, const std::string& text, const std::string& path) {
  static const std::set<std::string> yes = {"true", "yes", "on", "1"}, no = {"false", "no", "off", "0"};
  value = yes.count(lower(text)) > 0;
  if (!value && !no.count(lower(text))) throw misfit(path, "true or false", text);
}

// Read digits with a sign, 0x, 0o or 0b; false for other text.
inline bool read_whole(const std::string& text, std::int64_t& value) {
  std::string digits = lower(text);
  const bool is_signed = !digits.empty() && names::is_in(digits[0], "+-"), is_negative = digits[0] == '-';
  if (is_signed) digits.erase(0, 1);
  const auto base = digits.substr(0, 2) == "0x" ? 16 : digits.substr(0, 2) == "0o" ? 8
                  : digits.substr(0, 2) == "0b" ? 2 : 10;
  digits = (is_negative ? "-" : "") + digits.substr(base == 10 ? 0 : 2);
  const char* end = digits.data() + digits.size();
  if (digits.size() < (is_negative ? 2u : 1u) || digits.substr(is_negative, 1) == "-") return false;
  const auto result = std::from_chars(digits.data(), end, value, base);
  return result.ec == std::errc() && result.ptr == end;
}

inline void read(double& value, const std::string& text, const std::string& path) {
  std::string word = lower(text);
  const std::string sign = !word.empty() && names::is_in(word[0], "+-") ? word.substr(0, 1) : "";
  word.erase(0, sign.size());
  std::int64_t whole;
  if (word == ".inf" || word == "inf" || word == "infinity") {
    value = sign == "-" ? -INFINITY : INFINITY;
  } else if (word == ".nan" || word == "nan") {
    value = NAN;
  } else if (!word.empty() && word.find_first_not_of("0123456789.e+-") == std::string::npos &&
             (names::is_digit(word[0]) || (word[0] == '.' && names::is_digit(word.c_str()[1])))) {
    // not strtod, which reads a number as the locale has it
    const char* end = word.data() + word.size();
    const auto result = std::from_chars(word.data(), end, value);
    if (result.ec == std::errc::result_out_of_range && std::strtod(word.c_str(), nullptr) < 1) value = 0;
    else if (result.ec != std::errc() || result.ptr != end) throw misfit(path, "a number", text);
    if (sign == "-") value = -value;
  } else if (read_whole(text, whole)) {
    value = static_cast<double>(whole);
  } else {
    throw misfit(path, "a number", text);
  }
}

inline void read(std::int64_t& value, const std::string& text, const std::string& path) {
  if (read_whole(text, value)) return;
  double number = NAN;  // as 5.0 or 1e3
  if (text.find_first_of("xXoObBnN") == std::string::npos) {
    try {
      read(number, text, path);
    } catch (const Error&) {
    }
  }
  if (!(std::fabs(number) < 9e18) || number != std::floor(number)) throw misfit(path, "an integer", text);
  value = static_cast<std::int64_t>(number);
}

inline void read(std::string& value, const std::string& text, const std::string&) { value = text; }

// Read a list as [1, 2]; an element may be quoted.
template <class T>
void read(std::vector<T>& values, const std::string& text, const std::string& path) {
  values.clear();
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') throw misfit(path, "a list", text);
  const std::string inner = trimmed(text.substr(1, text.size() - 2));
  std::size_t start = 0;
  char quote = 0;
  for (std::size_t i = 0; i <= inner.size() && !inner.empty(); ++i) {
    const char c = i < inner.size() ? inner[i] : ',';
    if (quote && c == '\\' && quote == '"') ++i;
    else if (quote && i < inner.size()) quote = c == quote ? char(0) : quote;
    else if (names::is_in(c, "'\"") && trimmed(inner.substr(start, i - start)).empty()) quote = c;
    else if (c == ',') {
      const std::string part = trimmed(inner.substr(start, i - start));
      if (part.empty() && i == inner.size()) break;  // a comma at the end
      T element{};
      read(element, unquoted(part), path + "[" + std::to_string(values.size()) + "]");
      values.push_back(element);
      start = i + 1;
    }
  }
}

// Read a text as a value of the same kind as `like`.
inline Value read_value(const std::string& text, const Value& like, const std::string& path) {
  Value value = like;
  std::visit([&](auto& inside) {
    using T = std::decay_t<decltype(inside)>;
    read(inside, unquoted(std::is_same_v<T, std::string> ? text : trimmed(text)), path);
  }, value);
  return value;
}

inline std::string write(bool value) { return value ? "true" : "false"; }
inline std::string write(std::int64_t value) { return std::to_string(value); }
inline std::string write(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? ".nan" : value < 0 ? "-.inf" : ".inf";
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  std::string result(text, end);
  return result.find_first_of(".e") == std::string::npos ? result + ".0" : result;
}
inline std::string write(const std::string& value) {
  static const std::set<std::string> reserved = {"y", "n", "yes", "no", "on", "off", "true", "false",
                                                 "null", "inf", "nan", "infinity"};
  if (value.empty()) return "''";
  if (names::has_form(value, "/_", "/.-") && !reserved.count(lower(value))) return value;
  std::string result = "\"";
  for (unsigned char c : value) {
    char code[5];
    std::snprintf(code, sizeof code, "\\x%02x", c);
    if (c == '"' || c == '\\') result += '\\';
    if (c < 0x20 || c == 0x7f) result += code;
    else result += static_cast<char>(c);
  }
  return result + '"';
}
template <class T>
std::string write(const std::vector<T>& values) {
  std::string result;
  for (const auto& value : values) result += (result.empty() ? "" : ", ") + write(value);
  return "[" + result + "]";
}
inline std::string write_value(const Value& value) {
  return std::visit([](const auto& inside) { return write(inside); }, value);
}

template <class T>
auto as_value(const T& value) {  // 1 is an int64_t, "text" a string
  if constexpr (std::is_same_v<T, bool>) return value;
  else if constexpr (std::is_integral_v<T>) return static_cast<std::int64_t>(value);
  else if constexpr (std::is_floating_point_v<T>) return static_cast<double>(value);
  else if constexpr (std::is_convertible_v<T, std::string>) return std::string(value);
  else return value;
}

}  // namespace detail

}  // namespace lcmtools
