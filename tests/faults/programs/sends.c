/* Sends bytes. sends CHANNEL HEX BYTES HERTZ: HEX begins the message, zeros fill it up. */
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int main(int count, char **words)
{
    lcm_t *lcm = lcm_create(NULL);
    if (lcm == NULL || count < 5)
        return 1;
    size_t size = strtoul(words[3], NULL, 10);
    unsigned char *data = calloc(size + 1, 1);
    for (size_t i = 0; i < strlen(words[2]) / 2 && i < size; i++)
        sscanf(words[2] + 2 * i, "%2hhx", data + i);
    for (int sent = 0;; sent++) {
        lcm_publish(lcm, words[1], data, (unsigned) size);
        if (sent == 2) {
            puts("ready");
            fflush(stdout);
        }
        usleep((useconds_t) (1e6 / atof(words[4])));
    }
}
