"""The two dangers of pybullet's C code: it prints, and it ends the process without a display."""

import ctypes
import fcntl
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from lcmtools.errors import LcmtoolsError


@contextmanager
def suppressed_output() -> Iterator[None]:
    """Redirect file descriptors 1 and 2 to /dev/null: sys.stdout has no effect on C.

    Other threads of the process are silent too, so this is for the start and the end of a program.
    """
    _flush()
    copies = {descriptor: _copy(descriptor) for descriptor in (1, 2)}
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in copies:
            os.dup2(null, descriptor)
        yield
    finally:
        _flush()  # otherwise C's buffer would be printed later
        for descriptor, copy in copies.items():
            if copy is None:
                os.close(descriptor)
            else:
                os.dup2(copy, descriptor)
                os.close(copy)
        if null not in copies:
            os.close(null)


def _copy(descriptor: int) -> int | None:
    """A copy of a descriptor above the standard ones; None if the program started without it."""
    try:
        return fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)
    except OSError:
        return None


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream and not stream.closed:
            stream.flush()
    ctypes.CDLL(None).fflush(None)


def check_display(environment: Mapping[str, str]) -> None:
    """Return if a window can be opened.

    Raises:
        LcmtoolsError: There is no display, or it refuses us.
    """
    name = environment.get("DISPLAY", "")
    if not name:
        raise LcmtoolsError(
            "--gui needs a display and DISPLAY is not set",
            "leave out --gui, or run it in a desktop session or below xvfb-run",
        )
    if not _can_open(name):
        raise LcmtoolsError(f"--gui cannot open the display '{name}'", "leave out --gui")


def _can_open(name: str) -> bool:
    """Try Xlib, which pybullet uses too."""
    try:
        xlib = ctypes.CDLL("libX11.so.6")
    except OSError:
        return False
    xlib.XOpenDisplay.restype = ctypes.c_void_p
    xlib.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = xlib.XOpenDisplay(name.encode())
    if not display:
        return False
    xlib.XCloseDisplay(display)
    return True
