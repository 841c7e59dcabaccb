"""The stream of the nodes' log lines."""

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update, Waiting
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
        self._waiting, self._count = Waiting(_MOST), 0
        self._is_first = True
        self.until_closed(source.follow(_TOPIC, self._waiting.add))

    def update(self) -> Update | None:
        """Return the lines that have arrived."""
        packets, count = self._waiting.pop()
        left_out, self._count = count - self._count - len(packets), count
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
