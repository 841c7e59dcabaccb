"""The stream of a topic's latest message, decoded, as lines that can be unfolded."""

import threading
import time

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json, Parameters
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.messages.registry import type_name
from lcmtools.observe.channels.field_lines import FieldLine, field_lines
from lcmtools.wire.packet import Packet

_SHARE = 0.1  # of a processor, at most, for messages that are slow to decode
_HEAD_BYTES = 256  # shown of a message that cannot be decoded


class LatestMessage(PageStream):
    """The latest message of ``topic``; the parts ``toggled`` are open instead of closed."""

    period = 0.1
    is_shared = True

    def __init__(self, source: Source, parameters: Parameters) -> None:
        super().__init__(source, parameters)
        self._lock = threading.Lock()
        self._packet: Packet | None = None
        self._fault = ""
        self._next = 0.0
        self._toggled = parameters.texts("toggled")
        self.follow(parameters.text("topic"), self.receive)

    def receive(self, packet: Packet) -> None:
        """Keep the newest packet."""
        with self._lock:
            self._packet = packet

    def update(self) -> Update | None:
        """Return the newest message as lines, or the beginning of its bytes."""
        start = time.monotonic()
        if start < self._next:
            return None
        with self._lock:
            packet, self._packet = self._packet, None
        if packet is None:
            return None
        about: dict[str, Json] = {"time": packet.time / 1e9, "size": packet.size, "type": ""}
        try:
            message = self.source.decode(packet)
            about |= {"type": type_name(message)}
            about["lines"] = [_line(line) for line in field_lines(message, self._toggled)]
            self._fault = ""
        except LcmtoolsError as error:
            self._fault = str(error)
            about["bytes"] = packet.payload[:_HEAD_BYTES].hex()
        self._next = start + (time.monotonic() - start) / _SHARE
        return Update(about)

    def problem(self) -> str:
        """Return why it cannot be decoded, or why nothing arrives."""
        return super().problem() or self._fault


def _line(line: FieldLine) -> Json:
    opens = 0 if not line.opens else 2 if line.is_open else 1
    return [line.path, line.label, line.depth, line.text, opens, line.number is not None]
