"""The files of a recording: one log, or several one after another."""

import re
from collections import deque
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from lcmtools.bag.writer import LogWriter
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.folders import is_stream
from lcmtools.observe.reading.log_file import index_path
from lcmtools.wire.log_compression import SUFFIXES, Compression, named_compression

USUAL_NAME = "%Y-%m-%d-%H-%M-%S.lcmlog"


class LogSeries:
    """The files of a recording, created one after another.

    Args:
        pattern: The path, with strftime(3) codes for the date ("%H-%M"); a folder for the usual
            name in it; or a stream, as ``folders.open_stream`` has it.
        numbered: ``ride.lcmlog`` is ``ride_0.lcmlog``, ``ride_1.lcmlog`` and so on.
        most: The number of files to keep; None for all.
        force: Overwrite existing files.
        compression: Compress the files, whose names then end in ".zst" or ".lz4"; None if only a
            pattern with such an end asks for it.
    """

    def __init__(
        self,
        pattern: str,
        *,
        numbered: bool = False,
        most: int | None = None,
        force: bool = False,
        compression: Compression | None = None,
    ) -> None:
        self.compression = compression or named_compression(Path(pattern))
        self._pattern = str(Path(pattern) / USUAL_NAME) if Path(pattern).is_dir() else pattern
        self._numbered, self._most, self._force = numbered, most, force
        self._base: Path | None = None
        self.paths: deque[Path] = deque()  # the files that are kept, the oldest first
        self.count = 0  # the number of files created

    def next(self) -> LogWriter:
        """Return the next log; delete the oldest one if there are too many.

        Raises:
            LcmtoolsError: It exists, or cannot be created.
        """
        writer = self._opened()
        self.count += 1
        self.paths.append(writer.path)
        while self._most is not None and len(self.paths) > self._most:
            oldest = self.paths.popleft()
            for path in (oldest, index_path(oldest)):
                with suppress(OSError):  # it has been removed already
                    path.unlink()
        return writer

    def _opened(self) -> LogWriter:
        if self._base is None or not self._numbered:
            self._base = Path(_dated(self._pattern))
            if self.compression and self._base.suffix == SUFFIXES[self.compression]:
                self._base = self._base.with_suffix("")  # it follows the number
        path = self._base
        if is_stream(path):
            if self._numbered:
                raise UsageError(f"{path} is no file, and is not split", "leave out --split")
            return LogWriter(path, compression=self.compression)
        if self._numbered or (self.count and path in self.paths):
            path = path.with_name(f"{path.stem}_{self.count}{path.suffix}")
        ending = SUFFIXES[self.compression] if self.compression else ""
        if not path.name.endswith(ending):
            path = path.with_name(path.name + ending)
        return LogWriter(path, force=self._force, compression=self.compression)


def _dated(pattern: str) -> str:
    now = datetime.now().astimezone()
    try:  # all of the name, except bytes that are not UTF-8, which strftime refuses
        return re.sub("[^\ud800-\udfff]+", lambda part: now.strftime(part.group()), pattern)
    except ValueError as error:
        raise LcmtoolsError(f"'{pattern}' is not a valid name with a date: {error}") from error
