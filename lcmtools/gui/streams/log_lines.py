"""The stream of the nodes' log lines."""

import threading
from collections import deque

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.wire.packet import Packet

_TOPIC = "/rosout"
_MOST = 500  # lines that wait for a page; beyond this, the oldest are dropped


class LogLines(PageStream):
    """The lines on /rosout; each update has those since the last one.

    The first one has earlier lines too, which the page has already if it has lost its connection.
    """

    period = 0.2

    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self._lock = threading.Lock()
        self._waiting: deque[Packet] = deque(maxlen=_MOST)
        self._left_out = 0
        self._is_first = True
        self.until_closed(source.follow(_TOPIC, self.receive))

    def receive(self, packet: Packet) -> None:
        """Queue a line."""
        with self._lock:
            self._left_out += len(self._waiting) == _MOST
            self._waiting.append(packet)

    def update(self) -> Update | None:
        """Return the lines that have arrived."""
        with self._lock:
            packets, left_out = [*self._waiting], self._left_out
            self._waiting.clear()
            self._left_out = 0
        if not packets:
            return None
        lines = [line for packet in packets if (line := self._line(packet)) is not None]
        is_first, self._is_first = self._is_first, False
        return Update({"lines": lines, "leftOut": left_out, "isFirst": is_first})

    def _line(self, packet: Packet) -> Json:
        try:
            message = self.source.decode(packet)
            place = f"{message.file}:{message.line}" if message.file else ""  # type: ignore[attr-defined] # a log line has it
            about = (message.level, message.name, message.msg)  # type: ignore[attr-defined]
        except (LcmtoolsError, AttributeError):  # messages of another type
            return None
        return [packet.time / 1e9, *about, place]
