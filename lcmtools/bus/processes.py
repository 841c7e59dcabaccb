"""The processes of this computer, by proc(5).

On other systems, and for other users' processes, the answer is "not known", never a guess; only
whether a process runs is always known.
"""

import contextlib
import mmap
import os
import socket
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from lcmtools.bus.kernel import computer_id
from lcmtools.forks import cached_property

PROC = Path("/proc")
_LCM_MARK = b"LCM_SELF_TEST"  # is in programs that are statically linked with liblcm
_SESSION_DIGITS = 16  # digits of a Zenoh session's id; its first half is its computer's number


class Usage(NamedTuple):
    """A process's use of the computer's resources."""

    uid: int
    start_time: int  # nanoseconds since 1970, to a hundredth of a second
    memory_bytes: int  # physical memory
    processor_time: float  # CPU time of all threads so far [s]


class _Identity(NamedTuple):
    pid: int
    command: str = ""  # its command line
    start_ticks: int = 0  # its start [clock ticks since boot]; with the pid, its identity


class Process(_Identity):
    """A process of this computer. What cannot change is read once, when it is first asked for."""

    def text(self, file: str) -> str:
        """Return a file of it in /proc; "" if it has ended, or is another user's."""
        with contextlib.suppress(OSError), open(f"{PROC}/{self.pid}/{file}", "rb") as opened:  # noqa: PTH123
            return opened.read().decode("utf-8", "replace")
        return ""

    @cached_property
    def words(self) -> list[str]:
        """Its command line."""
        return self.text("cmdline").split("\0")

    @cached_property
    def environment(self) -> Mapping[str, str]:
        """Its variables at its start."""
        words = self.text("environ").split("\0")
        return dict(word.split("=", 1) for word in words if "=" in word)

    def was_told(self, text: str) -> bool:
        """Return whether a text is in its variables or its command line."""
        return any(text in self.text(file) for file in ("environ", "cmdline"))

    @cached_property
    def network(self) -> int:
        """The number of its network namespace; 0 if unknown."""
        with contextlib.suppress(OSError):
            return (PROC / str(self.pid) / "ns/net").stat().st_ino
        return 0

    @cached_property
    def uid(self) -> int | None:
        """Its user."""
        with contextlib.suppress(OSError):
            return (PROC / str(self.pid)).stat().st_uid
        return None

    @cached_property
    def uses_lcm(self) -> bool:
        """True if it has liblcm or its Python binding loaded, or linked in."""
        maps = self.text("maps")
        known = "liblcm" in maps or "/_lcm" in maps
        return known or (bool(maps) and _contains(PROC / str(self.pid) / "exe", _LCM_MARK))

    @property
    def state(self) -> str:
        """Its state now, as ps shows it ("T" is stopped); "" if it has ended or is not shown."""
        with contextlib.suppress(OSError):
            return _status(self.pid)[0]
        return ""

    @property
    def is_stopped(self) -> bool:
        """True if it is stopped until it is continued, as after Ctrl-Z."""
        return self.state in ("T", "t")

    @property
    def processor_times(self) -> tuple[int, int]:
        """The times that its threads have computed and waited for a processor [ns]."""
        rows = [row.split() for row in self.of_threads("schedstat")]
        known = [row for row in rows if len(row) > 1]
        return sum(int(row[0]) for row in known), sum(int(row[1]) for row in known)

    def of_threads(self, file: str) -> list[str]:
        """Return a file of each of its threads in /proc."""
        tasks = (PROC / str(self.pid) / "task").glob("*")
        return [self.text(f"task/{task.name}/{file}") for task in tasks]

    def usage(self) -> Usage | None:
        """Return its use of resources; None if unknown."""
        try:
            fields = _status(self.pid)
            uptime = float((PROC / "uptime").read_text().split()[0])
        except (OSError, ValueError):
            return None
        if self.uid is None:
            return None
        ticks = os.sysconf("SC_CLK_TCK")
        age = uptime - int(fields[19]) / ticks
        return Usage(
            uid=self.uid,
            start_time=time.time_ns() - round(age * 1e9),
            memory_bytes=int(fields[21]) * os.sysconf("SC_PAGE_SIZE"),
            processor_time=(int(fields[11]) + int(fields[12])) / ticks,
        )

    @cached_property
    def innermost_pid(self) -> tuple[int, int]:
        """Its pid namespace and its pid there, as in a container; zeros if unknown."""
        lines = self.text("status").splitlines()
        with contextlib.suppress(OSError, StopIteration, ValueError):
            pids = next(line for line in lines if line.startswith("NSpid:"))
            return (PROC / str(self.pid) / "ns/pid").stat().st_ino, int(pids.split()[-1])
        return 0, 0


def process_of(pid: int) -> Process | None:
    """Return the process with this pid; None if there is none (a zombie has ended).

    Where proc(5) does not show it, its command and start are unknown.
    """
    try:
        fields = _status(pid)
        words = (PROC / str(pid) / "cmdline").read_bytes().decode("utf-8", "replace").split("\0")
    except OSError:  # it has ended, or /proc hides it (hidepid, another namespace)
        return Process(pid) if _takes_signals(pid) else None
    if fields[0] in ("Z", "X"):
        return None
    return Process(pid, command_text(words), int(fields[19]))


def command_text(words: Iterable[str]) -> str:
    """Return a command line as a text.

    A path with blanks would look like several words: only the name of its file is left.
    """
    return " ".join(map(_shown, words)).strip()


def _shown(word: str) -> str:
    is_path = " " in word and word.startswith(("/", "./", "../"))
    return word.rpartition("/")[2] if is_path else word


def running() -> Iterator[Process]:
    """Yield the processes of this computer, as far as it shows them, without their commands."""
    if shows_own_pids():
        yield from (Process(int(name)) for name in os.listdir(PROC) if name.isdigit())  # noqa: PTH208


def open_files() -> dict[int, dict[int, str]]:
    """Return the targets of each process's descriptors, except other users' processes."""
    found: dict[int, dict[int, str]] = {}
    # strings are used because thousands of Paths would take most of the time
    for process in running():
        folder = f"{PROC}/{process.pid}/fd"
        files = found[process.pid] = {}
        with contextlib.suppress(OSError):  # another user's, or ended meanwhile
            for name in os.listdir(folder):  # noqa: PTH208
                with contextlib.suppress(OSError):  # closed meanwhile
                    files[int(name)] = os.readlink(f"{folder}/{name}")  # noqa: PTH115
    return found


def network_counter(file: str, group: str, name: str) -> int:
    """Return a counter of this network namespace; 0 if it is unknown.

    The file has a line of names before each line of numbers.
    """
    with contextlib.suppress(OSError, ValueError, IndexError):
        lines = (PROC / "net" / file).read_text().splitlines()
        rows = [line.split() for line in lines if line.startswith(group)]
        return int(rows[1][rows[0].index(name)])
    return 0


def buffer_overflows() -> int:
    """Return the number of UDP datagrams that full receive buffers dropped, since the start."""
    return network_counter("snmp", "Udp:", "RcvbufErrors")


def shows_own_pids() -> bool:
    """Return whether /proc has the pids of this process's namespace, and not of another one."""
    with contextlib.suppress(OSError, ValueError):
        return int((PROC / "self").readlink().name) == os.getpid()
    return False


def is_local(address: str) -> bool:
    """Return whether an IPv4 address, or a Zenoh session, belongs to this computer."""
    if len(address) == _SESSION_DIGITS and "." not in address:
        return address.startswith(f"{computer_id():08x}")
    if address == "0.0.0.0" or address.startswith("127."):  # noqa: S104 - a comparison
        return True
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
    return True


def _takes_signals(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except PermissionError:  # another user's process
        return True
    except (OSError, OverflowError):
        return False
    return pid > 0  # others are groups


def _status(pid: int) -> list[str]:
    """Return the fields of /proc/PID/stat after the name.

    Raises:
        OSError: There is no such process, or /proc has the pids of another namespace.
    """
    if not shows_own_pids():
        raise OSError
    status = (PROC / str(pid) / "stat").read_bytes()
    # the name before it may contain anything, also half a character
    return status.rpartition(b")")[2].decode().split()


def _contains(file: Path, text: bytes) -> bool:
    """Return whether a file contains these bytes, without reading it all into memory."""
    with (
        contextlib.suppress(OSError, ValueError),
        file.open("rb") as opened,
        mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content,
    ):
        return content.find(text) >= 0
    return False
