# lab check pioneer --teleop
# expects: right | nothing
# expects: raw | nothing

import select, sys, termios, tty
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

FAULT = sys.argv[1]
WAYS = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), "o": (1, -1),
        "m": (-1, -1), ".": (-1, 1)}
FACTORS = {"q": (1.1, 1.1), "w": (1.1, 1), "e": (1, 1.1), "z": (0.9, 0.9), "x": (0.9, 1),
           "c": (1, 0.9)}
lcmtools.init()
node = Node("teleop_twist_keyboard")
publisher = node.create_publisher(Twist, "/RosAria/cmd_vel", 1)
along = around = 0
speed, turn = 0.5, 1.0


def publish():
    twist = Twist()
    twist.linear.x, twist.angular.z = along * speed, around * turn
    publisher.publish(twist)


before = termios.tcgetattr(sys.stdin)
while lcmtools.ok():
    tty.setraw(0) if FAULT == "raw" else tty.setcbreak(0, termios.TCSANOW)
    ready, _, _ = select.select([sys.stdin], [], [], 0.1)
    key = sys.stdin.read(1) if ready else ""  # what is typed at the same moment waits for the next
    # as ROS's teleop_twist_keyboard: what is typed while it publishes is thrown away
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN if FAULT == "raw" else termios.TCSANOW, before)
    if FAULT == "raw" and key == "\x03":
        break
    if key in FACTORS:
        faster, more_turn = FACTORS[key]
        speed, turn = speed * faster, turn * more_turn
    elif key:
        along, around = WAYS.get(key, (0, 0))
        FAULT == "raw" or publish()
    if FAULT == "raw":
        publish()
along = around = 0
publish()
lcmtools.shutdown()
