"""Suppressing the output of pybullet's C code."""

import ctypes
import fcntl
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def suppressed_output() -> Iterator[None]:
    """Redirect file descriptors 1 and 2 to /dev/null: C does not use sys.stdout.

    This also silences other threads, so use it only at the start and end of a program.
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
    """Return a copy of a descriptor above the standard ones; None if it was closed at the start."""
    try:
        return fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)
    except OSError:
        return None


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream and not stream.closed:
            stream.flush()
    ctypes.CDLL(None).fflush(None)
