/* Prints the payload of a message with enums, in hexadecimal, by lcm-gen's C code. */
#include "rover_ranger_t.h"
#include <stdio.h>

int main(void)
{
    rover_ranger_t ranger = {7};
    unsigned char data[256];
    ranger.state.mode = ROVER_MODE_T_OFF;
    ranger.mode = ROVER_MODE_T_FAST;
    ranger.light = ROVER_LIGHT_T_GREEN;
    ranger.level = 99;
    int size = rover_ranger_t_encode(data, 0, sizeof data, &ranger);
    for (int n = 0; n < size; n++)
        printf("%02x", data[n]);
    return size < 0;
}
