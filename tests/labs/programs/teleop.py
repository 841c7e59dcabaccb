# lab check pioneer --teleop
# expects: key-jl | speeds of i and j | 'j' does what 'l' should do (right on the spot): the keys are mixed up
# expects: turn-sign | speeds of i and j | wrong sign of turn: left is angular.z above 0
# expects: capitals | o  forward to the right | 'O' does it, and 'o' does not: the keys are lower-case letters
# expects: unknown | u  forward to the left | 'u' changes nothing: is it in the program's table of keys, in lower case?
# expects: died | k  stop | the program died: it ended with code 1: KeyError: 'k'
# expects: endless | ends on Ctrl-C | let the loop end at Ctrl-C
# expects: raw | ends on Ctrl-C | in a raw terminal Ctrl-C is the key
# expects: no-c | u  after c, turning 10 % less | 'c' should change the speeds by 10 %
# expects: no-stop | stops at the end | publish a final Twist of 0

import sys, tty
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

FAULT = sys.argv[1]
lcmtools.init()
node = Node("teleop")
publisher = node.create_publisher(Twist, "/RosAria/cmd_vel")
tty.setraw(0) if FAULT == "raw" else tty.setcbreak(0)
ways = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), "o": (1, -1),
        "m": (-1, -1), ".": (-1, 1)}
if FAULT == "capitals":
    ways["O"] = ways.pop("o")
if FAULT == "unknown":
    del ways["u"]
if FAULT == "key-jl":
    ways["j"], ways["l"] = ways["l"], ways["j"]
factors = {"q": (1.1, 1.1), "w": (1.1, 1), "e": (1, 1.1), "z": (0.9, 0.9), "x": (0.9, 1),
           "c": (1, 0.9)}
if FAULT == "no-c":
    del factors["c"]
speed = turn = 1.0
try:
    while True:
        key = sys.stdin.read(1)
        if FAULT in ("capitals", "unknown") and key not in ways | factors | {"k": 0}:
            publisher.publish(twist)
            continue
        faster, more_turn = factors.get(key, (1, 1))
        speed, turn = speed * faster, turn * more_turn
        along, around = ways[key] if FAULT == "died" else ways.get(key, (0, 0))
        around = -around if FAULT == "turn-sign" else around
        twist = Twist()
        twist.linear.x, twist.angular.z = along * speed, around * turn
        publisher.publish(twist)
except KeyboardInterrupt:
    FAULT == "no-stop" or publisher.publish(Twist())
while FAULT == "endless":
    pass
lcmtools.shutdown()
