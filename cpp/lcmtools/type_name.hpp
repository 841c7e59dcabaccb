// Names of message types, as in announcements; C++11. Include node.hpp or announcer.hpp instead.
#pragma once

#include <cxxabi.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <typeinfo>

namespace lcmtools {
namespace detail {

inline std::string demangled(const char* name) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(abi::__cxa_demangle(name, nullptr, nullptr, &status), std::free);
  return text ? text.get() : name;
}

template <class T, class = void>
struct TypeName {
  // "geometry_msgs/Twist" for the class geometry_msgs::Twist; lcm-gen's getTypeName lacks the package
  static std::string get() {
    std::string name = demangled(typeid(T).name());
    auto colons = name.rfind("::");
    if (colons != std::string::npos) name.replace(colons, 2, "/");
    while ((colons = name.rfind("::")) != std::string::npos) name.replace(colons, 2, ".");
    return name;
  }
};
template <class T>
struct TypeName<T, decltype(void(T::lcm_type))> {
  static std::string get() { return T::lcm_type; }
};

}  // namespace detail
}  // namespace lcmtools
