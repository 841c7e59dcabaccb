// A plain LCM program that publishes twice the number that it gets.
#include <lcm/lcm.h>

#include "std_msgs_Float64.h"

static void on_number(const lcm_recv_buf_t* buffer, const char* channel, const std_msgs_Float64* number, void* lcm) {
  (void)buffer, (void)channel;
  const std_msgs_Float64 twice = {number->data * 2};
  std_msgs_Float64_publish(lcm, "OUT", &twice);
}

int main(void) {
  lcm_t* lcm = lcm_create(NULL);
  if (!lcm) return 1;
  std_msgs_Float64_subscribe(lcm, "IN", on_number, lcm);
  while (lcm_handle(lcm) == 0) {
  }
  return 0;
}
