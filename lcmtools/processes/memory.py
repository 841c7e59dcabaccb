"""The memory of this process."""

import contextlib

# malloc.h: memory is given back above M_TRIM_THRESHOLD, and blocks up to M_MMAP_THRESHOLD are kept;
# M_ARENA_MAX: all threads share it, as what one has freed another one needs
_SETTINGS = ((-1, 256 << 20), (-3, 32 << 20), (-8, 1))


def keep_freed_memory() -> None:
    """Have the C library keep the memory of large messages and pictures for the next ones.

    Else it gives each back to the kernel, which has to clear it for the next one; this takes longer
    than copying it. Only glibc knows these settings (mallopt(3)).
    """
    with contextlib.suppress(OSError, AttributeError):
        import ctypes

        library = ctypes.CDLL(None)
        for setting, value in _SETTINGS:
            library.mallopt(setting, value)
