/* Prints every velocity that comes on /cmd_vel, on plain LCM in C.
 *
 *     ./listener                   then, elsewhere:
 *     lcmtools pub /cmd_vel geometry_msgs/Twist "linear: [0.5, 0, 0]"
 */

#include <stdio.h>

#include <lcm/lcm.h>

#include "geometry_msgs_Twist.h"

static void take(const lcm_recv_buf_t *packet, const char *channel,
                 const geometry_msgs_Twist *twist, void *user)
{
    (void) packet;
    (void) user;
    printf("%s: %.2f m/s forward, %.2f rad/s\n", channel, twist->linear.x, twist->angular.z);
    fflush(stdout);
}

int main(void)
{
    lcm_t *bus = lcm_create(NULL); /* LCM_DEFAULT_URL says where */
    if (bus == NULL) {
        fprintf(stderr, "listener: there is no bus; see: lcmtools wtf\n");
        return 1;
    }
    geometry_msgs_Twist_subscribe(bus, "/cmd_vel", take, NULL);
    printf("listening\n");
    fflush(stdout);
    while (lcm_handle(bus) == 0) {
    }
    lcm_destroy(bus);
    return 0;
}
