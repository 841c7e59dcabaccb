"""A node that drives a robot by keys and stops it at the end; the loop that runs it.

It commands at once for each key, ten times a second while the robot moves, and 0 at the end.
"""

import contextlib
import shutil
import sys
import time
from abc import ABC, abstractmethod
from typing import Protocol

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes.driving.keyboard import Keyboard, open_keyboard
from lcmtools.labs.nodes.terminal import ended_by_signals, is_terminal

PERIOD = 0.1
"""Seconds between two commands while the robot moves."""
STOPS = 3
"""Number of zero commands that stop a robot: any one of them may be lost."""
_STOP_GAP = 0.01
_KEY_TIME = 0.02
"""Longest wait for a key [s], after which timers have their turn."""


class Motion(Protocol):
    """The state of driving; its text is the status line."""

    @property
    def forward(self) -> float:
        """Commanded forward speed [m/s]."""
        ...

    @property
    def turn_rate(self) -> float:
        """Commanded turn rate [rad/s], positive to the left."""
        ...

    def after(self, key: str) -> "Motion":
        """The state once a key is pressed."""
        ...

    def stopped(self) -> "Motion":
        """The same at rest."""
        ...


class Driver(Node, ABC):
    """A node that commands a velocity.

    Args:
        name: The node's own name.

    Attributes:
        key_help: The meaning of its keys, for a person at a terminal.
        motion: The state of driving; set by the subclass.
    """

    key_help = ""
    motion: Motion

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._stops_to_send = 0
        self._status = ""
        self.create_timer(PERIOD, self._repeat)

    @abstractmethod
    def send(self, forward: float, turn_rate: float) -> None:
        """Publish a command: forward speed [m/s], turn rate [rad/s]."""

    def press(self, key: str) -> None:
        """Change the motion as a key says, and command it."""
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
        with contextlib.suppress(OSError, ValueError):  # the terminal is closed
            if is_terminal(sys.stderr):
                width = shutil.get_terminal_size().columns - 1
                sys.stderr.write(f"\r{status[:width]}\x1b[K")
            elif status != self._status:
                sys.stderr.write(f"{status}\n")
            sys.stderr.flush()
        self._status = status

    def _repeat(self) -> None:
        """Repeat a command that moves the robot; a stop some times, and then no more."""
        if self.motion.forward or self.motion.turn_rate:
            self.send(self.motion.forward, self.motion.turn_rate)
        elif self._stops_to_send > 0:
            self._stops_to_send -= 1
            self.send(0.0, 0.0)


def drive(driver: Driver) -> None:
    """Drive by keys until they end or the program does, and let the robot stand then.

    Ctrl-C, SIGTERM, a closed terminal, the end of the input and any error end it.
    """
    try:
        with ended_by_signals(driver.context):
            try:
                with open_keyboard(driver.halt) as keyboard:
                    _greet(driver)
                    _follow(keyboard, driver)
            finally:
                driver.halt()
    finally:
        _end_line()


def _follow(keyboard: Keyboard, driver: Driver) -> None:
    driver.warn_of_unknown_parameters()
    while lcmtools.ok() and not keyboard.is_over:
        for key in keyboard.read(_KEY_TIME):
            driver.press(key)
        lcmtools.spin_once(driver)


def _greet(driver: Driver) -> None:
    """Show what the keys mean to a person at the keyboard."""
    if is_terminal(sys.stdin):
        with contextlib.suppress(OSError):
            sys.stderr.write(f"{driver.key_help}\n\n")
        driver.show_status()


def _end_line() -> None:
    """Leave the status line, so that a shell's prompt does not stand behind it."""
    with contextlib.suppress(OSError, ValueError):
        if is_terminal(sys.stderr):
            sys.stderr.write("\n")
            sys.stderr.flush()
