"""The pipe by which liblcm's thread tells a program that messages wait for it.

That thread empties the socket also while a callback of the program hangs. It keeps one byte in the
pipe for as long as messages wait, and each call of ``handle`` reads it (lcm-proj/lcm,
lcm/lcm_udpm.c). Belongs here: reading /proc for that. Must not judge.
"""

import contextlib
import fcntl
import os
import struct
import termios
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from lcmtools.bus.processes import open_files, uses_lcm
from lcmtools.doctor.host import text_of

_PROC = Path("/proc")


@dataclass(frozen=True, slots=True)
class Waiting:
    """The pipes of a process that have a byte, and how often the process has read anything."""

    reads: str = ""  # the number of its calls of read(), as /proc has it; "" if unknown
    pipes: frozenset[str] = frozenset()  # of which it has both ends ("pipe:[4711]")

    @classmethod
    def of(cls, pid: int) -> "Waiting":
        """Return this of a process now."""
        reads = text_of(_PROC / str(pid) / "io").partition("syscr: ")[2].split("\n")[0]
        files = _pipes(pid)
        ends = Counter(files.values())
        full = (name for file, name in files.items() if ends[name] > 1 and _has_one_byte(file))
        return cls(reads, frozenset(full)) if reads else cls()


def hanging(earlier: Mapping[int, Waiting]) -> frozenset[int]:
    """Return the processes for which messages waited, and which have read nothing since then."""
    unread: dict[int, frozenset[str]] = {}
    for pid, was in earlier.items():
        if was.pipes and uses_lcm(pid) and (now := Waiting.of(pid)).reads == was.reads:
            unread[pid] = was.pipes & now.pipes
    shared = _shared(chain.from_iterable(unread.values()))
    return frozenset(pid for pid, pipes in unread.items() if pipes - shared)


def _shared(pipes: Iterable[str]) -> frozenset[str]:
    """Return those pipes that several processes have: liblcm's belongs to one."""
    wanted = set(pipes)
    holders = {(pid, name) for pid, name in open_files() if name in wanted} if wanted else ()
    counts = Counter(name for _, name in holders)
    return frozenset(name for name, count in counts.items() if count > 1)


def _pipes(pid: int) -> dict[Path, str]:
    found = {}
    with contextlib.suppress(OSError):  # of another user, or it has ended
        for file in (_PROC / str(pid) / "fd").iterdir():
            with contextlib.suppress(OSError):
                found[file] = str(file.readlink())
    return {file: name for file, name in found.items() if name.startswith("pipe:")}


def _has_one_byte(file: Path) -> bool:
    with contextlib.suppress(OSError):
        opened = os.open(file, os.O_RDONLY | os.O_NONBLOCK)
        try:
            (size,) = struct.unpack("i", fcntl.ioctl(opened, termios.FIONREAD, bytes(4)))
        finally:
            os.close(opened)
        return bool(size == 1)
    return False
