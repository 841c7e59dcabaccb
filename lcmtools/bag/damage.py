"""The errors that libraries raise for damaged files."""

import struct

_LIBRARIES = ("mcap", "rosbags", "zstandard", "sqlite3")
_BROKEN = (
    *(AssertionError, EOFError, LookupError, OSError, ValueError, struct.error),
    *(RuntimeError, MemoryError, OverflowError, TypeError),  # from lz4, and for strange values
)
"""Errors that the libraries raise in addition to their own."""


def damage_text(error: Exception) -> str | None:
    """Return an error for a damaged file in one line; None if it is another error."""
    is_of_library = type(error).__module__.partition(".")[0] in _LIBRARIES
    if not (is_of_library or isinstance(error, _BROKEN)):
        return None
    return str(error).strip().partition("\n")[0] or type(error).__name__
