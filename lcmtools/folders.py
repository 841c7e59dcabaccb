"""The user's folders (XDG Base Directory Specification), bounded reading and atomic writing."""

import contextlib
import os
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from lcmtools.errors import InvalidFile, LcmtoolsError, os_errors_as

LARGEST = 1_000_000
"""Bytes of a file that people write; a longer one is something else."""
_PIPES = ("/dev/stdin", "/dev/fd/")  # as shells name those that they make
_STANDARD = {"-": 1, "/dev/stdout": 1, "/dev/stderr": 2}  # descriptors that a user may name


def home_folder(environment: Mapping[str, str], variable: str, default: str) -> Path | None:
    """Return a user's XDG folder; None if the environment has no home.

    It is the value of ``variable`` ("XDG_CACHE_HOME") if that is an absolute path, else the folder
    ``default`` (".cache") in the home.
    """
    named = environment.get(variable, "")
    if named.startswith("/"):
        return Path(named)
    home = environment.get("HOME", "")
    return Path(home) / default if home.startswith("/") else None


def cache_folder(environment: Mapping[str, str]) -> Path | None:
    """Return the folder for data that can be recomputed."""
    base = home_folder(environment, "XDG_CACHE_HOME", ".cache")
    return base / "lcmtools" if base else None


def runtime_folder(environment: Mapping[str, str]) -> Path | None:
    """Return the folder for short-lived data, such as the records of running nodes."""
    named = environment.get("XDG_RUNTIME_DIR", "")
    if named.startswith("/") and os.access(named, os.W_OK):
        return Path(named) / "lcmtools"
    return cache_folder(environment)


@contextlib.contextmanager
def opened(
    path: Path, what: str = "", kind: type[LcmtoolsError] = InvalidFile
) -> Iterator[BinaryIO]:
    """Open a file that a user named, to read it; a device or a pipe without an end is refused.

    Args:
        path: The file, or a pipe that a shell has made: <(command).
        what: The beginning of an error, "cannot read a.txt" by default.
        kind: The class of errors.
    """
    what = what or f"cannot read {path}"
    with os_errors_as(what, kind=kind):
        try:  # a pipe that nobody writes to does not block
            descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        except ValueError as error:  # a name that cannot be
            raise kind(f"{what}: {error}") from None
        with os.fdopen(descriptor, "rb") as file:
            mode = os.fstat(descriptor).st_mode
            if stat.S_ISFIFO(mode) and str(path).startswith(_PIPES):
                os.set_blocking(descriptor, True)
            elif not stat.S_ISREG(mode):
                raise kind(f"{what}: it is not a file")
            yield file


def read_bytes(
    path: Path, most: int = LARGEST, what: str = "", kind: type[LcmtoolsError] = InvalidFile
) -> bytes:
    """Read a file of at most so many bytes; otherwise like ``opened``."""
    what = what or f"cannot read {path}"
    with opened(path, what, kind) as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise kind(f"{what}: it has more than {most} bytes")
    return content


def read_text(
    path: Path, most: int = LARGEST, what: str = "", kind: type[LcmtoolsError] = InvalidFile
) -> str:
    """Read a file of UTF-8 text; otherwise like ``read_bytes``."""
    content = read_bytes(path, most, what, kind)
    with os_errors_as(what or f"cannot read {path}", kind=kind):
        return content.decode("utf-8")


def is_standard_output(path: str | Path | None) -> bool:
    """Return whether an output that a user named is standard output: "-" is."""
    return _STANDARD.get(str(path)) == 1


def is_stream(path: Path) -> bool:
    """Return whether ``open_stream`` opens a stream there."""
    return str(path) in _STANDARD or path.is_fifo() or path.is_char_device()


def open_stream(path: Path, *, binary: bool = True) -> int | None:
    """Open the stream at a path that a user named for output; None for a path of a file.

    A stream is written to, never replaced: standard output ("-"), a pipe, which waits for its
    reader, and a character device. A terminal takes text only.

    Raises:
        LcmtoolsError: Neither a file nor a stream can be there.
    """
    with os_errors_as(f"cannot write {path}"):
        if is_stream(path):
            number = _STANDARD.get(str(path))
            flags = os.O_WRONLY | os.O_CLOEXEC | os.O_NOCTTY
            descriptor = os.open(path, flags) if number is None else os.dup(number)
            if binary and os.isatty(descriptor):
                os.close(descriptor)
                what = f"cannot write {path}: it is a terminal"
                raise LcmtoolsError(what, "name a file, or pipe it into a program")
            return descriptor
        if path.is_dir():
            raise LcmtoolsError(f"{path} is a folder", "name another, or remove it")
        if path.exists() and not path.is_file():
            raise LcmtoolsError(f"{path} is neither a file nor a pipe", "name another")
    return None


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file that a user named; if that fails, an existing file stays unchanged.

    What is no file is written to as ``open_stream`` says, and not replaced.

    Raises:
        LcmtoolsError: The file cannot be written.
    """
    stream = open_stream(path, binary=isinstance(content, bytes))
    with os_errors_as(f"cannot write {path}"):
        if stream is None:
            _replace(path, content)
            return
        with os.fdopen(stream, "wb") as file:
            file.write(_encoded(content))


def write_atomically(path: Path, content: str | bytes, *, private: bool = False) -> None:
    """Write a file atomically: a concurrent reader sees all of the old or all of the new content.

    The folder must exist. If ``path`` is a symbolic link, its target is written; what is no file,
    as /dev/null, is not replaced. Only the user can read a private file; others keep their mode.
    """
    if path.exists() and not path.is_file():
        path.write_bytes(_encoded(content))
    else:
        _replace(path, content, private=private)


def usual_mode(path: Path) -> int:
    """Return the mode of a file that is written in the place of another, if there is one."""
    if path.exists():
        return path.stat().st_mode & 0o7777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _replace(path: Path, content: str | bytes, *, private: bool = False) -> None:
    import tempfile  # late: completion seldom writes

    path = path.resolve()
    descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(_encoded(content))
        if not private:
            Path(temporary).chmod(usual_mode(path))
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise


def _encoded(content: str | bytes) -> bytes:
    return content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content
