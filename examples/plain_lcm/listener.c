/* Subscribes to /cmd_vel and prints each velocity, with plain LCM in C.
 * Three lines tell lcmtools its name and what it listens to.
 *
 *     ./listener                   and in another terminal:
 *     lcmtools pub /cmd_vel geometry_msgs/Twist "linear: [0.5, 0, 0]"
 */

#include <stdio.h>

#include <lcm/lcm.h>
#include <lcmtools.h>

#include "geometry_msgs_Twist.h"

static void print_velocity(const lcm_recv_buf_t *packet, const char *channel,
                           const geometry_msgs_Twist *twist, void *user)
{
    (void) packet;
    (void) user;
    printf("%s: %.2f m/s forward, %.2f rad/s\n", channel, twist->linear.x, twist->angular.z);
    fflush(stdout);
}

int main(void)
{
    lcm_t *bus = lcm_create(NULL); /* at LCM_DEFAULT_URL */
    if (bus == NULL) {
        fprintf(stderr, "listener: cannot open the bus; see: lcmtools wtf\n");
        return 1;
    }
    geometry_msgs_Twist_subscribe(bus, "/cmd_vel", print_velocity, NULL);
    lcmtools_announcer *announcer = lcmtools_announcer_create(bus, "listener", NULL);
    lcmtools_subscribes(announcer, "/cmd_vel", LCMTOOLS_TYPE(geometry_msgs, Twist));
    printf("listening\n");
    fflush(stdout);
    while (lcm_handle(bus) == 0) {
    }
    lcmtools_announcer_destroy(announcer);
    lcm_destroy(bus);
    return 0;
}
