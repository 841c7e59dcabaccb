"""A node that drives a robot as keys say, and surely stops it; the loop that runs it.

What keys mean (Steering) and what is sent (``send``) is each node's own. Here is what they have in
common: a command at once for each key, ten a second while the robot moves, and standing at the end.
"""

import contextlib
import shutil
import sys
import time
from abc import ABC, abstractmethod

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


class Driver(Node, ABC):
    """A node that commands a velocity.

    Args:
        name: The node's own name.
    """

    key_help = ""
    """The meaning of its keys, for a person at a terminal."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._stops_to_send = 0
        self._status = ""
        self.create_timer(PERIOD, self._repeat)

    @abstractmethod
    def velocity(self) -> tuple[float, float]:
        """The present command: forward speed [m/s] and turn rate [rad/s]."""

    @abstractmethod
    def take_key(self, key: str) -> None:
        """Change what is commanded, as a key says."""

    @abstractmethod
    def stand(self) -> None:
        """Command 0 from now on."""

    @abstractmethod
    def send(self, forward: float, turn_rate: float) -> None:
        """Publish a command: forward speed [m/s], turn rate [rad/s]."""

    @abstractmethod
    def status(self) -> str:
        """One line about what is commanded."""

    def press(self, key: str) -> None:
        """Do what a key says, and command it."""
        self.take_key(key)
        self.command()

    def command(self) -> None:
        """Publish what is commanded now, and show it."""
        velocity = self.velocity()
        self._stops_to_send = STOPS - 1
        self.send(*velocity)
        self.show_status()

    def halt(self) -> None:
        """Let the robot stand, whatever was commanded."""
        self.stand()
        for _ in range(STOPS):
            self.send(*self.velocity())
            time.sleep(_STOP_GAP)
        self._stops_to_send = 0

    def show_status(self) -> None:
        """Write the status line: on a terminal in place of the one before it."""
        status = self.status()
        with contextlib.suppress(OSError, ValueError):  # the terminal is closed
            if is_terminal(sys.stderr):
                width = shutil.get_terminal_size().columns - 1
                sys.stderr.write(f"\r{status[:width]}\x1b[K")
            elif status != self._status:
                sys.stderr.write(f"{status}\n")
            sys.stderr.flush()
        self._status = status

    def _repeat(self) -> None:
        """Command again what moves the robot; a stop some times, and then no more."""
        if any(self.velocity()):
            self.send(*self.velocity())
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
