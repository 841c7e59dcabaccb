"""Nodes that drive a robot by keys and stop it at the end, and the loop that runs them.

It commands at once for each key, ten times a second while the robot moves, and 0 at the end.
"""

import shutil
import sys
import textwrap
import time
from abc import ABC, abstractmethod

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes.driving.keyboard import Keyboard, open_keyboard
from lcmtools.labs.nodes.driving.motion import Motion, Sliders
from lcmtools.labs.nodes.ending import ended_by_signals
from lcmtools.terminal import is_terminal, write_screen
from lcmtools.types.geometry_msgs import Twist

PERIOD = 0.1  # seconds between two commands while the robot moves
STOPS = 3  # number of zero commands that stop a robot: any one of them may be lost
_STOP_GAP = 0.01
_KEY_TIME = 0.02  # longest wait for a key [s], after which timers have their turn

_PIPE_HELP = "Keys are also taken from a pipe: a number is a wait in seconds, # begins a comment."


class Driver(Node, ABC):
    """A node that commands a velocity by keys."""

    key_help = ""  # the meaning of its keys, for a person at a terminal
    # The velocity that keys set, whose text is the status line; set by the subclass.
    motion: Motion | Sliders

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._stops_to_send = 0
        self._status = ""
        self.create_timer(PERIOD, self._repeat)

    @abstractmethod
    def send(self, forward: float, turn_rate: float) -> None:
        """Publish a command: forward speed [m/s], turn rate [rad/s]."""

    def press(self, key: str) -> None:
        """Change the motion by a key, and command it."""
        self.motion = self.motion.after(key)
        self.command()

    def command(self) -> None:
        """Publish the present command, and show it."""
        self._stops_to_send = STOPS - 1
        self.send(self.motion.forward, self.motion.turn_rate)
        self.show_status()

    def halt(self) -> None:
        """Stop the robot."""
        self.motion = self.motion.stopped()
        for _ in range(STOPS):
            self.send(0.0, 0.0)
            time.sleep(_STOP_GAP)
        self._stops_to_send = 0

    def show_status(self) -> None:
        """Write the status line: on a terminal in place of the one before it."""
        status = str(self.motion)
        if is_terminal(sys.stderr):
            width = shutil.get_terminal_size().columns - 1
            write_screen(f"\r{status[:width]}\x1b[K", sys.stderr)
        elif status != self._status:
            write_screen(f"{status}\n", sys.stderr)
        self._status = status

    def _repeat(self) -> None:
        """Repeat a command that moves the robot, and a stop a few times."""
        if self.motion.forward or self.motion.turn_rate:
            self.send(self.motion.forward, self.motion.turn_rate)
        elif self._stops_to_send > 0:
            self._stops_to_send -= 1
            self.send(0.0, 0.0)


class TwistDriver(Driver):
    """A driver whose commands are Twists on a topic."""

    def __init__(self, name: str, topic: str) -> None:
        super().__init__(name)
        self._publisher = self.create_publisher(Twist, topic)

    def send(self, forward: float, turn_rate: float) -> None:
        """Publish a command; the other velocities are 0."""
        twist = Twist()
        twist.linear.x = forward
        twist.angular.z = turn_rate
        self._publisher.publish(twist)


def keys_help(help_text: str | None, keys: str) -> str:
    """Return a node's help with the meaning of its keys in it."""
    keys = textwrap.indent(f"{keys}\n\n{_PIPE_HELP}", "    ")
    return f"{(help_text or '').strip()}\n\nKeys:\n{keys}"


def drive(driver: Driver) -> None:
    """Drive by keys until the input or the program ends, and stop the robot.

    Ctrl-C, SIGTERM, a closed terminal, the end of the input and any error end it.
    """
    try:
        with ended_by_signals(driver):
            try:
                with open_keyboard(driver.halt) as keyboard:
                    _follow(keyboard, driver)
            finally:
                driver.halt()
    finally:
        if is_terminal(sys.stderr):
            write_screen("\n", sys.stderr)  # a shell's prompt comes below the status line


def _follow(keyboard: Keyboard, driver: Driver) -> None:
    if is_terminal(sys.stdin):
        write_screen(f"{driver.key_help}\n\n", sys.stderr)
    driver.warn_of_unused_arguments()
    lcmtools.spin_once(driver, 0.0)  # a node's first lines of log come before the status line
    if is_terminal(sys.stdin):
        driver.show_status()
    while lcmtools.ok() and not keyboard.is_over:
        for key in keyboard.read(_KEY_TIME):
            driver.press(key)
        lcmtools.spin_once(driver)
