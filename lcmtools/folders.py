"""A user's folders by the XDG rules, and writing a file as a whole or not at all."""

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

from lcmtools.errors import os_errors_as


def home_folder(environment: Mapping[str, str], variable: str, default: str) -> Path | None:
    """Return a folder of the user's by the XDG rules; None where the environment names no home.

    The variable ("XDG_CACHE_HOME") names the folder, if by an absolute path; else it has its
    ``default`` place in the home (".cache").
    """
    named = environment.get(variable, "")
    if named.startswith("/"):
        return Path(named)
    home = environment.get("HOME", "")
    return Path(home) / default if home.startswith("/") else None


def cache_folder(environment: Mapping[str, str]) -> Path | None:
    """Return the folder for data that can be computed again."""
    base = home_folder(environment, "XDG_CACHE_HOME", ".cache")
    return base / "lcmtools" if base else None


def runtime_folder(environment: Mapping[str, str]) -> Path | None:
    """Return the folder for data that is valid for a moment."""
    named = environment.get("XDG_RUNTIME_DIR", "")
    if named.startswith("/") and os.access(named, os.W_OK):
        return Path(named) / "lcmtools"
    return cache_folder(environment)


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file that a person has named: as a whole, or the one before stays.

    Raises:
        LcmtoolsError: It cannot be written.
    """
    with os_errors_as(f"cannot write {path}"):
        if path.exists() and not path.is_file():  # /dev/stdout, a pipe: not to be replaced
            path.write_bytes(_encoded(content))
        else:
            write_atomically(path, content)


def write_atomically(path: Path, content: str | bytes, *, private: bool = False) -> None:
    """Write a file in an existing folder; a concurrent reader sees the old or the new one, whole.

    Where ``path`` is a link, as a settings file kept elsewhere may be, its target is written.
    A private file can be read by the user only; others keep their mode.
    """
    import tempfile  # completion seldom writes

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
