"""Recording the bus for pages, by the recorder of ``bag record``, into files of one directory."""

import os
import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.recorder import BagRecorder, open_bus
from lcmtools.bag.recording_words import summary
from lcmtools.bag.series import USUAL_NAME, LogSeries
from lcmtools.bus.url import BusUrl
from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json
from lcmtools.observe.reading.find import GLOBAL


class Recordings:
    """The recordings of a server, one at a time; for any thread.

    Pages choose topics, never a file: the server chooses its name in the ``directory``.
    """

    def __init__(self, url: BusUrl, directory: Path) -> None:
        self._url, self._directory = url, directory
        self._lock = threading.Lock()
        self._stack = ExitStack()
        self._running: tuple[BagRecorder, LogSeries, Sequence[str]] | None = None
        self._began, self._told, self._fault = 0.0, "", ""

    def start(self, topics: Sequence[str]) -> None:
        """Begin to record topics; without any, all but hidden ones.

        Raises:
            LcmtoolsError: A recording is running, or the file cannot be written.
            BusError: The bus cannot be reached.
        """
        with self._lock, ExitStack() as stack:
            if self._running:
                raise LcmtoolsError("a recording is running already", "stop it first")
            try:
                folder = str(self._directory.absolute()).replace("%", "%%")  # no codes of a date
            except OSError:
                what = "the working directory of lcmtools gui is gone"
                raise LcmtoolsError(what, "--record-directory DIR chooses another") from None
            series = LogSeries(f"{folder}/{USUAL_NAME}")
            choice = RecordedTopics(topics, GLOBAL)
            monitor = stack.enter_context(open_bus(self._url, os.environ))
            recorder = stack.enter_context(BagRecorder(monitor, choice, series))
            self._stack = stack.pop_all()
            self._running, self._began = (recorder, series, topics), time.monotonic()
            self._told = self._fault = ""

    def stop(self) -> str:
        """End the recording and finish its file; return a sentence on it, "" if there is none.

        Raises:
            LcmtoolsError: Not everything could be written.
        """
        with self._lock:
            if self._running is None:
                return ""
            recorder, series, _ = self._running
            self._running = None
            try:
                self._stack.close()
            except LcmtoolsError as error:
                self._fault = str(error)
                raise
            finally:
                self._told = summary(recorder.progress(), series)
            return self._told

    def state(self) -> dict[str, Json]:
        """Return what is recorded, or the words on the last recording."""
        running = self._running
        if running is not None and running[0].wait(0.0):  # it has ended: the disk is full
            with suppress(LcmtoolsError):  # and is kept
                self.stop()
            running = None
        if running is None:
            return {"told": self._told, "fault": self._fault}
        recorder, series, topics = running
        progress = recorder.progress()
        return {
            "topics": topics,
            "seconds": round(time.monotonic() - self._began),
            "told": summary(progress, series),
            "fault": progress.trouble,
        }
