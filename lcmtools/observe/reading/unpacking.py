"""Writing what is unpacked from a compressed file to a temporary place, as far as there is room."""

import logging
import shutil
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from lcmtools.errors import BusError
from lcmtools.escapes import ESCAPES
from lcmtools.observe.reports.describe import size_text

_SHARE = 0.9  # of the free space
_PATIENCE = 1.0  # [s] before progress is told
_AGAIN = 5.0  # [s] between two lines


def fitting(pieces: Iterable[bytes], source: Path) -> Iterator[bytes]:
    """Yield the pieces of a file that is being unpacked; log a line now and then.

    Raises:
        BusError: They need more than the free space for temporary files allows.
    """
    place = tempfile.gettempdir()
    most = int(_SHARE * shutil.disk_usage(place).free)
    done, next_line = 0, time.monotonic() + _PATIENCE
    for piece in pieces:
        done += len(piece)
        if done > most:
            what = f"{source} has more than {size_text(most)} when unpacked, too many for {place}"
            raise BusError(what, "set TMPDIR to a folder with more space")
        if (now := time.monotonic()) > next_line:
            next_line = now + _AGAIN
            text = f"lcmtools: unpacking {source}: {size_text(done)} so far"
            logging.getLogger("lcmtools").warning("%s", text.translate(ESCAPES))
        yield piece
