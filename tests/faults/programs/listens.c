/* Listens to a channel. listens CHANNEL [SECONDS]: so long its handler sleeps with each message. */
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static double seconds;

static void take(const lcm_recv_buf_t *buffer, const char *channel, void *user)
{
    (void) buffer, (void) channel, (void) user;
    if (seconds > 0)
        usleep((useconds_t) (seconds * 1e6));
}

int main(int count, char **words)
{
    lcm_t *lcm = lcm_create(NULL);
    if (lcm == NULL || count < 2)
        return 1;
    seconds = count > 2 ? atof(words[2]) : 0;
    lcm_subscribe(lcm, words[1], take, NULL);
    puts("ready");
    fflush(stdout);
    while (lcm_handle(lcm) == 0)
        ;
    return 1;
}
