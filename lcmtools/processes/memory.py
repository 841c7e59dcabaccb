"""The memory of this process."""

import contextlib

# malloc.h: memory above M_TRIM_THRESHOLD is given back, and blocks up to M_MMAP_THRESHOLD are kept;
# M_ARENA_MAX: all threads share one arena, because one needs what another has freed
_SETTINGS = ((-1, 256 << 20), (-3, 32 << 20), (-8, 1))


def keep_freed_memory() -> None:
    """Let the C library keep the memory of large messages and pictures for the next ones.

    Otherwise it returns each block to the kernel, which has to clear it for the next use; this
    takes longer than copying it. Only glibc has these settings (mallopt(3)).
    """
    with contextlib.suppress(OSError, AttributeError):
        import ctypes

        library = ctypes.CDLL(None)
        for setting, value in _SETTINGS:
            library.mallopt(setting, value)
