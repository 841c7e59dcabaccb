"""Log files, read at once: what was recorded, and when, without playing it."""

import mmap
from collections.abc import Iterator
from pathlib import Path

from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.log import events
from lcmtools.wire.packet import Packet


def read_log(url: BusUrl) -> Iterator[Packet]:
    """The messages of a log in their order; their time is when they were recorded.

    Raises:
        BusError: The file cannot be read.
    """
    try:
        if Path(url.network).stat().st_size == 0:  # which cannot be mapped
            return
        with Path(url.network).open("rb") as file, _mapped(file.fileno()) as log:
            yield from events(log)
    except OSError as error:
        raise BusError(f"cannot read the log '{url.network}': {error.strerror}") from error


def _mapped(descriptor: int) -> mmap.mmap:
    return mmap.mmap(descriptor, 0, access=mmap.ACCESS_READ)
