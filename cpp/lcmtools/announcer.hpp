// Gives a plain LCM program in C++ a name, and tells lcmtools what it publishes and listens to. C++11.
//
//     lcm::LCM lcm;
//     lcmtools::Announcer announcer(lcm, "lidar_driver");
//     announcer.publishes<scan_t>("SCAN");
//     announcer.subscribes<cmd_t>("CMD");
//
// lcmtools.h, for C, describes what the announcer does.
#pragma once

#include <lcm/lcm-cpp.hpp>

#include "lcmtools.h"
#include "lcmtools/type_name.hpp"

namespace lcmtools {

class Announcer {
 public:
  // The URL is the one given to `lcm`; without one, that of LCM_DEFAULT_URL.
  Announcer(lcm::LCM& lcm, const std::string& name, const std::string& url = "")
      : announcer_(lcmtools_announcer_create(lcm.getUnderlyingLCM(), name.c_str(), url.c_str()),
                   lcmtools_announcer_destroy) {}

  template <class Message>
  void publishes(const std::string& channel) {
    lcmtools_publishes(announcer_.get(), channel.c_str(), detail::TypeName<Message>::get().c_str(), fingerprint<Message>());
  }
  template <class Message>
  void subscribes(const std::string& channel) {
    lcmtools_subscribes(announcer_.get(), channel.c_str(), detail::TypeName<Message>::get().c_str(), fingerprint<Message>());
  }

 private:
  template <class Message>
  static std::uint64_t fingerprint() {
    return static_cast<std::uint64_t>(Message::getHash());
  }

  std::unique_ptr<lcmtools_announcer, void (*)(lcmtools_announcer*)> announcer_;
};

}  // namespace lcmtools
