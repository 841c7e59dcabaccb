// A plain C program: sends a drive as geometry_msgs/Twist, or writes it into a log with liblcm's own
// functions; or prints what is in a log, or what comes over the bus.
#include <lcm/eventlog.h>
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "geometry_msgs_Twist.h"

static int count;

static void take(const lcm_recv_buf_t *, const char *channel, const geometry_msgs_Twist *twist,
                 void *) {
    printf("%s %g\n", channel, twist->linear.x);
    fflush(stdout);
    count++;
}

int main(int argc, char **argv) {
    const char *way = argv[1], *where = argv[2];
    int messages = atoi(argv[3]);
    geometry_msgs_Twist twist;
    memset(&twist, 0, sizeof twist);
    if (!strcmp(way, "send")) {
        lcm_t *bus = lcm_create(where);
        for (int i = 0; i < messages; i++) {
            twist.linear.x = i / 2.0;
            geometry_msgs_Twist_publish(bus, "C_DRIVE", &twist);
        }
        puts("sent");
        fflush(stdout);
        pause();  // the recorder learns its name while it runs
    } else if (!strcmp(way, "listen")) {
        lcm_t *bus = lcm_create(where);
        geometry_msgs_Twist_subscribe(bus, ".*DRIVE", take, NULL);
        puts("listens");
        fflush(stdout);
        while (count < messages) lcm_handle(bus);
        lcm_destroy(bus);
    } else if (!strcmp(way, "write")) {
        lcm_eventlog_t *log = lcm_eventlog_create(where, "w");
        for (int i = 0; i < messages; i++) {
            twist.linear.x = i / 2.0;
            char data[256];
            int size = geometry_msgs_Twist_encode(data, 0, sizeof data, &twist);
            lcm_eventlog_event_t event = {0, 1700000000000000 + 100000 * i, 7, size, "C_DRIVE", data};
            lcm_eventlog_write_event(log, &event);
        }
        lcm_eventlog_destroy(log);
    } else {
        lcm_eventlog_t *log = lcm_eventlog_create(where, "r");
        for (lcm_eventlog_event_t *event; (event = lcm_eventlog_read_next_event(log));) {
            if (geometry_msgs_Twist_decode(event->data, 0, event->datalen, &twist) < 0) return 1;
            printf("%d %s %d %g\n", (int) event->eventnum, event->channel, event->datalen,
                   twist.linear.x);
            lcm_eventlog_free_event(event);
        }
        lcm_eventlog_destroy(log);
    }
    return 0;
}
