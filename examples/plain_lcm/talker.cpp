// Says "hello world N" on /chatter ten times a second, on plain LCM.
//
//     ./talker                     then, elsewhere:  lcmtools echo /chatter
//
// It knows nothing of lcmtools: a topic is an LCM channel, and its type is a struct of lcm-gen.

#include <chrono>
#include <iostream>
#include <string>
#include <thread>

#include <lcm/lcm-cpp.hpp>
#include <std_msgs/String.hpp>

int main()
{
    lcm::LCM bus;  // LCM_DEFAULT_URL says where
    if (!bus.good()) {
        std::cerr << "talker: there is no bus; see: lcmtools wtf" << std::endl;
        return 1;
    }
    for (int count = 0;; ++count) {
        std_msgs::String message;
        message.data = "hello world " + std::to_string(count);
        bus.publish("/chatter", &message);
        std::cout << message.data << std::endl;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
}
