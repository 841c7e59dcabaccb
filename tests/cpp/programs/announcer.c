/* A plain LCM program with a name: announcer NAME publish|listen|exit [URL] */
#include <lcmtools.h>

uint64_t __sensors_scan_t_hash_recursive(const void *parents);
uint64_t __sensors_scan_t_hash_recursive(const void *parents)
{
    return parents == NULL ? 0x8123456789abcdef : 0;
}

static void on_signal(int number) { (void) number; }

int main(int argc, char **argv)
{
    const char *url = argc > 3 ? argv[3] : NULL;
    lcm_t *lcm = lcm_create(url);
    lcmtools_announcer *announcer = lcmtools_announcer_create(lcm, argv[1], url);
    lcmtools_publishes(announcer, "SCAN", LCMTOOLS_TYPE(sensors, scan_t));
    if (strcmp(argv[2], "listen") == 0) lcmtools_subscribes(announcer, "CMD.\"", "cmd_t", 5);
    signal(SIGUSR1, on_signal);
    puts("ready");
    fflush(stdout);
    while (strcmp(argv[2], "listen") == 0 && lcm_handle(lcm) == 0) continue;
    pause();
    if (strcmp(argv[2], "exit") == 0) exit(3); /* without the announcer's end */
    lcmtools_announcer_destroy(announcer);
    lcm_destroy(lcm);
    return 0;
}
