"""A topic's latest message, or a service's answer, as lines that can be unfolded."""

import time
from collections.abc import Sequence

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, publishers_of
from lcmtools.gui.streams.base import PageStream, Update, Waiting
from lcmtools.messages.registry import Message, type_name
from lcmtools.observe.channels.field_lines import FieldLine, field_lines

_SHARE = 0.1  # of a processor, at most, for messages that are slow to decode
_HEAD_BYTES = 256  # shown of a message that cannot be decoded


class LatestMessage(PageStream):
    """The latest message of ``topic``; the parts ``toggled`` are open instead of closed."""

    period = 0.1
    is_shared = True

    def __init__(self, source: Source, *, topic: str, toggled: tuple[str, ...] = ()) -> None:
        super().__init__(source)
        self._waiting = Waiting()
        self._fault = ""
        self._next = 0.0
        self._toggled = toggled
        self.follow(topic, self._waiting.add)

    def update(self) -> Update | None:
        """Return the newest message as lines, or the beginning of its bytes."""
        start = time.monotonic()
        if start < self._next:
            return None
        packets, _ = self._waiting.pop()
        if not packets:
            return None
        (packet,) = packets
        about: dict[str, Json] = {"time": packet.time / 1e9, "size": packet.size, "type": ""}
        try:
            about |= _unfolded(self.source.decode(packet), self._toggled)
            self._fault = ""
        except LcmtoolsError as error:
            self._fault = str(error)
            about["bytes"] = packet.payload[:_HEAD_BYTES].hex()
        self._next = start + (time.monotonic() - start) / _SHARE
        return Update(about)

    def problem(self) -> str:
        """Return why it cannot be decoded, or why nothing arrives."""
        return super().problem() or self._fault


class ServiceAnswer(PageStream):
    """The kept answer of a service with a ``number``, with ``toggled`` parts as above."""

    def __init__(self, source: Source, *, number: int, toggled: tuple[str, ...] = ()) -> None:
        super().__init__(source)
        answer = publishers_of(source).answers.get(number)
        self._lines = _unfolded(answer, toggled) if answer else None
        self._fault = "" if answer else "this answer is no longer kept; call the service again"

    def update(self) -> Update | None:
        """Return the answer as lines, once."""
        lines, self._lines = self._lines, None
        return Update(lines) if lines else None

    def problem(self) -> str:
        """Return why there is no answer."""
        return self._fault


def _unfolded(message: Message, toggled: Sequence[str]) -> dict[str, Json]:
    lines = [_line(line) for line in field_lines(message, toggled)]
    return {"type": type_name(message), "lines": lines}


def _line(line: FieldLine) -> Json:
    opens = 0 if not line.opens else 2 if line.is_open else 1
    return [line.path, line.label, line.depth, line.text, opens, line.number is not None]
