"""The user's folders (XDG Base Directory Specification), and atomic writing of files."""

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

from lcmtools.errors import os_errors_as


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
