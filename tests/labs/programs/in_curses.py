# lab check pioneer --teleop
# expects: right | nothing

import curses
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

WAYS = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), "o": (1, -1),
        "m": (-1, -1), ".": (-1, 1)}
FACTORS = {"q": (1.1, 1.1), "w": (1.1, 1), "e": (1, 1.1), "z": (0.9, 0.9), "x": (0.9, 1),
           "c": (1, 0.9)}


def drive(screen):
    lcmtools.init()
    publisher = Node("teleop").create_publisher(Twist, "/RosAria/cmd_vel", 1)
    speed, turn, way = 0.5, 1.0, (0, 0)
    screen.timeout(50)
    while lcmtools.ok():
        number = screen.getch()
        if number < 0:
            continue
        key, twist = chr(number), Twist()
        faster, more_turn = FACTORS.get(key, (1, 1))
        speed, turn = speed * faster, turn * more_turn
        way = way if key in FACTORS else WAYS.get(key, (0, 0))
        twist.linear.x, twist.angular.z = way[0] * speed, way[1] * turn
        publisher.publish(twist)
        screen.addstr(0, 0, f"{twist.linear.x:.2f} m/s, {twist.angular.z:.2f} rad/s")
    publisher.publish(Twist())
    lcmtools.shutdown()


curses.wrapper(drive)
