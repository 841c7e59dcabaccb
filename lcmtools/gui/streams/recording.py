"""Starting and stopping a recording, and the stream of its state."""

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json
from lcmtools.gui.recording import Recordings
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update


def record(source: Source, *, topics: tuple[str, ...] = ()) -> Json:
    """Begin to record ``topics``; without any, all but hidden ones."""
    _recordings(source).start(topics)
    return None


def stop(source: Source) -> Json:
    """End the recording."""
    return _recordings(source).stop()


class RecordingState(PageStream):
    """The recording that is running, or the words on the last one."""

    period = 0.5
    is_shared = True

    def update(self) -> Update:
        """Return the state."""
        return Update(_recordings(self.source).state())


def _recordings(source: Source) -> Recordings:
    if source.recordings is None:
        raise LcmtoolsError("a log is not recorded", "open the window on a bus")
    return source.recordings
