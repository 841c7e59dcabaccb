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


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file that a user named; if that fails, an existing file stays unchanged.

    Raises:
        LcmtoolsError: The file cannot be written.
    """
    with os_errors_as(f"cannot write {path}"):
        if path.exists() and not path.is_file():  # /dev/stdout or a pipe must not be replaced
            path.write_bytes(_encoded(content))
        else:
            write_atomically(path, content)


def write_atomically(path: Path, content: str | bytes, *, private: bool = False) -> None:
    """Write a file atomically: a concurrent reader sees all of the old or all of the new content.

    The folder must exist. If ``path`` is a symbolic link, its target is written. Only the user can
    read a private file; others keep their mode.
    """
    import tempfile  # late: completion seldom writes

    path = path.resolve()
    descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(_encoded(content))
        if not private:
            Path(temporary).chmod(path.stat().st_mode & 0o7777 if path.exists() else _usual_mode())
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise


def _encoded(content: str | bytes) -> bytes:
    return content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content


def _usual_mode() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
