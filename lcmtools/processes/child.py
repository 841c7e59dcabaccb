"""A child process: its start, its output, its keyboard, and the signals that end it.

Belongs here: one process and its group. The caller decides what to do when. No code of this process
runs between fork and exec, where it could deadlock if there are threads.
"""

import contextlib
import errno
import os
import pty
import resource
import shutil
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import IO, TYPE_CHECKING

from lcmtools.processes.process_guard import ProcessGuard, Stream
from lcmtools.processes.reaper import is_gone, send

if TYPE_CHECKING:
    from typing_extensions import Self

LONGEST = 65_536  # bytes; a longer line comes in pieces, so that an endless one takes no memory
_WITH_TERMINAL = ("sh", "-c", 'exec "$@" <>"$0"')
"""Opening a terminal makes it the session's controlling terminal; then the command runs."""
_PIECE = 65_536
_MOST_PIECES = 100  # more than a pipe can contain
_NEVER = float("inf")
_KILL_WAIT = 10.0
_COPY_WAIT = 1.0  # [s] to copy everything that an ended process has printed on its terminal


@dataclass(frozen=True, slots=True)
class StopTimeouts:
    """Seconds from SIGINT to SIGTERM, and from SIGTERM to SIGKILL."""

    interrupt: float = 15.0
    terminate: float = 2.0


@dataclass(frozen=True, slots=True)
class Start:
    """The settings for starting a process."""

    command: Sequence[str]  # its words
    environment: Mapping[str, str]  # all its environment variables
    directory: str = ""  # its working directory; "" for this process's
    takes_input: bool = False  # standard input is this process's; else it is empty
    has_keyboard: bool = False  # it has its own terminal, see ``press``; needs ``output``
    takes_terminal: bool = False  # standard output and error are this process's
    output: Path | None = None  # a file for everything it prints; None to read its lines
    most_bytes: int = 0  # size limit of each file that it writes; 0 for none
    holds_interrupts: bool = False  # it begins with SIGINT blocked, and unblocks it itself


class ChildProcess:
    """A process in its own session and group; OSError if the system does not start it."""

    def __init__(self, start: Start, guard: ProcessGuard, timeouts: StopTimeouts) -> None:
        self._guard = guard
        self._keyboard: int | None = None
        self._copier: Thread | None = None
        self._output = start.output
        self._popen = self._started(start)
        self.pid = self._popen.pid  # also its group's number
        self._lines: dict[int, tuple[IO[bytes], Lines, bool]] = {}
        for stream, is_error in ((self._popen.stdout, False), (self._popen.stderr, True)):
            if stream is not None:
                os.set_blocking(stream.fileno(), False)
                self._lines[stream.fileno()] = (stream, Lines(), is_error)
        self._ladder = [
            (signal.SIGINT, timeouts.interrupt),
            (signal.SIGTERM, timeouts.terminate),
            (signal.SIGKILL, _NEVER),
        ]
        self.next_step = _NEVER  # when the next signal is due, see ``tick``

    def __enter__(self) -> "Self":
        """Return the running process."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self.end()

    @property
    def code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self._popen.poll()

    @property
    def streams(self) -> list[int]:
        """The descriptors from which its lines are read."""
        return list(self._lines)

    def read(self, stream: int) -> Iterator[tuple[bool, str]]:
        """Return the lines that have come, each with True if it is from the error stream."""
        _, lines, is_error = self._lines[stream]
        try:
            piece = os.read(stream, _PIECE)
        except BlockingIOError:
            return
        for line in lines.feed(piece) if piece else lines.end():
            yield is_error, line
        if not piece:
            self._close(stream)

    def rest(self) -> Iterator[tuple[bool, str]]:
        """Return the remaining lines; surviving children may keep the streams open."""
        for stream in self.streams:
            _, lines, is_error = self._lines[stream]
            with contextlib.suppress(BlockingIOError):
                for _ in range(_MOST_PIECES):
                    yield from ((is_error, line) for line in lines.feed(os.read(stream, _PIECE)))
            yield from ((is_error, line) for line in lines.end())
            self._close(stream)

    def output(self, most: int) -> str:
        """Return the last ``most`` bytes that it has printed into its file."""
        assert self._output is not None
        if self._copier and self.code is not None:
            self._copier.join(_COPY_WAIT)
        with self._output.open("rb") as stream:
            stream.seek(max(0, stream.seek(0, os.SEEK_END) - most))
            return stream.read(most).decode(errors="replace")

    def press(self, key: str) -> None:
        """Press a key on its keyboard."""
        assert self._keyboard is not None
        with contextlib.suppress(OSError):  # it has ended, which the caller will notice
            os.write(self._keyboard, key.encode())

    def takes_interrupts_as_keys(self) -> bool:
        """Return True if it has set its terminal raw: then Ctrl-C sends no signal."""
        if self._keyboard is None:
            return False
        return not termios.tcgetattr(self._keyboard)[3] & termios.ISIG

    def wait(self, timeout: float) -> bool:
        """Wait for its end; return True if it ended within ``timeout`` seconds."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._popen.wait(timeout)
        return self.code is not None

    def group_is_gone(self) -> bool:
        """Return True if no process of its group is left."""
        return is_gone(self.pid)

    def ask_to_end(self, now: float) -> signal.Signals | None:
        """Send the first signal to end it, or the next one ahead of its time."""
        if not self._ladder:
            return None
        number, patience = self._ladder.pop(0)
        self.next_step = now + patience
        send(self.pid, number)
        return number

    def tick(self, now: float) -> signal.Signals | None:
        """Send the next signal if it is due; return it."""
        return self.ask_to_end(now) if now >= self.next_step else None

    def interrupt(self, timeout: float) -> bool:
        """Press Ctrl-C; return True if it ended within ``timeout`` seconds."""
        send(self.pid, signal.SIGINT)
        return self.wait(timeout)

    def end(self) -> None:
        """End it, and whatever it has started."""
        for number, patience in self._ladder:
            if self.code is None or number is signal.SIGKILL:
                send(self.pid, number)
                self.wait(min(patience, _KILL_WAIT))
        self.release()

    def release(self) -> None:
        """Free its resources, once its group is gone."""
        self.next_step = _NEVER
        for stream in self.streams:
            self._close(stream)
        self._close_keyboard()
        self._guard.forget(self.pid)

    def _close(self, stream: int) -> None:
        self._lines.pop(stream)[0].close()

    def _started(self, start: Start) -> "subprocess.Popen[bytes]":
        stdin: Stream = None if start.takes_input or start.takes_terminal else subprocess.DEVNULL
        stdout: Stream = None if start.takes_terminal else subprocess.PIPE
        command = start.command
        with contextlib.ExitStack() as opened:
            if start.output is not None:
                stdout = opened.enter_context(start.output.open("ab"))
            stderr = subprocess.STDOUT if start.output else stdout
            if start.has_keyboard:
                _check_executable(command[0], start.environment)
                self._keyboard, stdin = pty.openpty()
                opened.callback(os.close, stdin)
                stdout, stderr = _screen(stdin), stdout
                command = (*_WITH_TERMINAL, os.ttyname(stdin), *command)
            try:
                popen = self._guard.start(
                    command,
                    start.environment,
                    start.directory,
                    (stdin, stdout, stderr),
                    holds_interrupts=start.holds_interrupts,
                )
            except OSError:
                self._close_keyboard()
                raise
        if start.has_keyboard:
            copied = popen.pid, start.most_bytes
            self._copier = Thread(target=self._copy, args=copied, daemon=True)
            self._copier.start()
        if start.most_bytes and sys.platform == "linux":  # other systems cannot set a limit
            resource.prlimit(popen.pid, resource.RLIMIT_FSIZE, (start.most_bytes, start.most_bytes))
        return popen

    def _copy(self, pid: int, most: int) -> None:
        """Copy what it prints on its terminal into its file, up to the limit."""
        assert self._output is not None
        terminal = self._keyboard
        assert terminal is not None
        with self._output.open("ab", 0) as file, contextlib.suppress(OSError):  # it has ended
            while piece := os.read(terminal, _PIECE):
                left = max(0, most - file.tell()) if most else len(piece)
                file.write(piece[:left])
                if len(piece) > left:  # as the system does when a process exceeds the limit
                    send(pid, signal.SIGXFSZ)

    def _close_keyboard(self) -> None:
        if self._copier:
            self._copier.join(_COPY_WAIT)
            if self._copier.is_alive():  # a process outside of the group still uses the terminal
                return
        if self._keyboard is not None:
            os.close(self._keyboard)
            self._keyboard = None


def _screen(terminal: int) -> int:
    """Make a terminal pass on a program's output unchanged, and echo no keys."""
    manner = termios.tcgetattr(terminal)
    manner[1] &= ~termios.OPOST
    manner[3] &= ~termios.ECHO
    termios.tcsetattr(terminal, termios.TCSANOW, manner)
    return terminal


def _check_executable(word: str, environment: Mapping[str, str]) -> None:
    """Raise the error that a shell, which opens the terminal, would only print."""
    if shutil.which(word, path=environment.get("PATH")) is None:
        number = errno.EACCES if Path(word).is_file() else errno.ENOENT
        raise OSError(number, os.strerror(number))


class Lines:
    """Splits the output of a process, which comes in pieces, into lines."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, piece: bytes) -> list[str]:
        """Return the lines that this piece completes, without their line ends."""
        *whole, self._rest = (self._rest + piece).split(b"\n")
        if len(self._rest) > LONGEST:
            whole.append(self._rest)
            self._rest = b""
        return [_text(line) for line in whole]

    def end(self) -> list[str]:
        """Return the rest: a line without a line end."""
        rest, self._rest = self._rest, b""
        return [_text(rest)] if rest else []


def _text(line: bytes) -> str:
    return line.removesuffix(b"\r").decode(errors="backslashreplace")
