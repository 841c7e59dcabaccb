"""Silence for C code that prints: file descriptors 1 and 2 lead nowhere for a while.

Bullet prints from C, where redirecting sys.stdout has no effect. Other threads of the process are
silenced too, so this belongs to the start and the end of a program only.
"""

import ctypes
import fcntl
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def silenced() -> Iterator[None]:
    """Let nothing that is printed within reach stdout or stderr."""
    _flush()
    kept = {descriptor: _copy(descriptor) for descriptor in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in kept:
            os.dup2(nowhere, descriptor)
        yield
    finally:
        _flush()  # what C has buffered would come out later otherwise
        for descriptor, copy in kept.items():
            _give_back(descriptor, copy)
        if nowhere not in kept:
            os.close(nowhere)


def _copy(descriptor: int) -> int | None:
    """A copy of a descriptor above the standard ones; None where the program started without it."""
    try:
        return fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, 3)
    except OSError:
        return None


def _give_back(descriptor: int, copy: int | None) -> None:
    if copy is None:
        os.close(descriptor)
        return
    os.dup2(copy, descriptor)
    os.close(copy)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream and not stream.closed:
            stream.flush()
    ctypes.CDLL(None).fflush(None)
