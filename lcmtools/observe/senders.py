"""What the senders that are no nodes are called: by process where that shows, else by address.

Looking a process up goes through the whole system's processes, so it is done once for a sender.
"""

import time
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import PurePath

from lcmtools.bus.processes import Process, is_local, owners, senders_from, udp_sockets
from lcmtools.wire.packet import Sender

UNKNOWN = "unknown sender"
"""Where the bus does not tell who sends: tcpq, memq and logs."""

_RETRY = 5.0  # [s] before one that was not found is looked up again
_TAKE_A_PATH = ("-cp", "-classpath", "--class-path", "-p", "--module-path")
_INTERPRETERS = ("python", "pypy", "java", "ruby", "perl", "lua", "node", "bash", "sh")


class SenderNames:
    """What senders are called.

    Args:
        look_up: Finds the processes behind local ports.
        now: A monotonic clock [s].
    """

    def __init__(
        self,
        look_up: Callable[[set[int]], dict[int, Process]] | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._look_up = look_up or _processes
        self._now = now
        self._names: dict[Sender, str] = {}
        self._next_look: dict[Sender, float] = {}

    def learn(self, senders: Iterable[Sender | None]) -> None:
        """Look up those that are not known yet, all at once."""
        now = self._now()
        new = {
            sender
            for sender in senders
            if sender is not None
            and sender not in self._names
            and self._next_look.get(sender, now) <= now
        }
        local = {sender for sender in new if is_local(sender.address)}
        found = self._look_up({sender.port for sender in local}) if local else {}
        for sender in new:
            process = found.get(sender.port) if sender in local else None
            if process is not None:
                self._names[sender] = f"{program_name(process.command)} (pid {process.pid})"
            self._next_look[sender] = now + _RETRY

    def name(self, sender: Sender | None) -> str:
        """What a sender is called; its address where nothing better is known."""
        return UNKNOWN if sender is None else self._names.get(sender, str(sender))


def program_name(command: str) -> str:
    """The short name of a program, of an interpreter's the script's: "driver.py"."""
    words = command.split() or ["?"]
    name = PurePath(words[0]).name
    if not name.startswith(_INTERPRETERS):
        return name
    for option, word in pairwise(words):
        if option == "-c":
            return name
        if option in _TAKE_A_PATH:  # "java -cp FOLDERS Main"
            continue
        if option == "-m" or not word.startswith("-"):
            return PurePath(word).name
    return name


def _processes(ports: set[int]) -> dict[int, Process]:
    """The process behind each local UDP port, where it can be only one."""
    rows = [row for row in udp_sockets() if row.port in ports]
    holders = owners(row.inode for row in rows)
    found = {port: senders_from(port, rows, holders).only for port in ports}
    return {port: process for port, process in found.items() if process is not None}
