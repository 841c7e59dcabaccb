"""The open streams of all pages; equal ones are shared if their kind allows it."""

import time
from collections.abc import Mapping

from lcmtools.errors import LcmtoolsError
from lcmtools.gui import streams
from lcmtools.gui.protocol import Json, json_arguments
from lcmtools.gui.source import Source, topic_named
from lcmtools.gui.streams.base import PageStream, Update


class OpenStream:
    """A stream with its latest update."""

    def __init__(self, stream: PageStream) -> None:
        self.stream = stream
        self.latest: Update | None = None  # the latest update; None before the first
        self.version = 0  # the number of updates so far
        self.problem = ""  # the reason why there is nothing to show; "" if all is well
        self.users = 0
        self._next = 0.0

    def refresh(self) -> None:
        """Get new data, at most once per period of the stream."""
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + self.stream.period * 0.9  # the pages' clocks decide
        try:
            update = self.stream.update()
            self.problem = self.stream.problem()
        except LcmtoolsError as error:
            self.problem = str(error)
            return
        except Exception as error:  # noqa: BLE001 - shown in the panel; the others go on
            self.problem = f"a fault of lcmtools ({type(error).__name__}: {error})"
            return
        # updates of streams that are not shared accumulate
        if update is not None and not (self.stream.is_shared and update == self.latest):
            self.latest = update
            self.version += 1


class StreamPool:
    """The streams of one server's pages."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._shared: dict[tuple[str, str], OpenStream] = {}

    def open(self, name: str, values: Mapping[str, Json]) -> OpenStream:
        """Open a stream, or use another page's; MalformedRequest for a bad name or parameters."""
        make = streams.stream_class(name)
        parameters = json_arguments(make, values)
        if topic := parameters.get("topic"):
            parameters["topic"] = topic_named(self._source, topic)
        key = name, repr(sorted(parameters.items()))
        found = self._shared.get(key)
        if found is None:
            found = OpenStream(make(self._source, **parameters))
            if found.stream.is_shared:
                self._shared[key] = found
        found.users += 1
        return found

    def close(self, one: OpenStream) -> None:
        """Release a stream; the last page closes it."""
        one.users -= 1
        if not one.users:
            self._shared = {key: other for key, other in self._shared.items() if other is not one}
            one.stream.close()
