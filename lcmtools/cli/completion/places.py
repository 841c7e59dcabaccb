"""Where files of a user's go, by the XDG rules, and writing one as a whole or not at all."""

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path


def home_folder(environment: Mapping[str, str], variable: str, default: str) -> Path | None:
    """A folder of the user's; None where the environment names no home.

    Args:
        environment: The environment variables.
        variable: Names it where it is absolute ("XDG_CACHE_HOME"), by the XDG rules.
        default: Where it is in the home otherwise (".cache").
    """
    named = environment.get(variable, "")
    if named.startswith("/"):
        return Path(named)
    home = environment.get("HOME", "")
    return Path(home) / default if home.startswith("/") else None


def cache_folder(environment: Mapping[str, str]) -> Path | None:
    """Where lcmtools keeps what it could find out again."""
    base = home_folder(environment, "XDG_CACHE_HOME", ".cache")
    return base / "lcmtools" if base else None


def runtime_folder(environment: Mapping[str, str]) -> Path | None:
    """Where lcmtools keeps what is true for a moment."""
    named = environment.get("XDG_RUNTIME_DIR", "")
    if named.startswith("/") and os.access(named, os.W_OK):
        return Path(named) / "lcmtools"
    return cache_folder(environment)


def write_atomically(path: Path, text: str, *, private: bool = False) -> None:
    """Write a file, so that whoever reads it meanwhile sees the old or the new one, whole.

    Where ``path`` is a link, as a settings file kept elsewhere may be, its target is written.

    Args:
        path: The file; its folder exists.
        text: What it shall say.
        private: Only the user may read it; otherwise as an old file had it, or as usual.

    Raises:
        OSError: It cannot be written; then nothing has changed.
    """
    import tempfile  # what completes a word seldom writes

    path = path.resolve()
    descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", errors="surrogateescape") as file:
            file.write(text)
        if not private:
            Path(temporary).chmod(path.stat().st_mode & 0o7777 if path.exists() else _usual_mode())
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise


def _usual_mode() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
