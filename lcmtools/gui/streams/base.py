"""A stream: a part of a source, with updates for a page until the page closes it.

A kind of stream is a class in its own file and a line in ``streams.STREAMS``.
"""

import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import ClassVar

from lcmtools.gui.protocol import Frame, Json, binary_frame, text_frame
from lcmtools.gui.source import Source, absence
from lcmtools.wire.packet import Packet


@dataclass(frozen=True, slots=True)
class Update:
    """An update for a page: values, and many numbers as bytes (little-endian)."""

    data: Mapping[str, Json]
    payload: bytes | memoryview | None = None

    def frame(self, number: int) -> Frame:
        """Return the update as a frame of the stream with this number."""
        if self.payload is None:
            return text_frame({"id": number, "data": self.data})
        return binary_frame({"id": number, **self.data}, self.payload)


class Waiting:
    """The newest packets, at most ``most``, which wait for a stream's next update."""

    def __init__(self, most: int = 1) -> None:
        self._packets: deque[Packet] = deque(maxlen=most)
        self._count = 0
        self._lock = threading.Lock()

    def add(self, packet: Packet) -> None:
        """Add a packet; on the source's thread."""
        with self._lock:
            self._packets.append(packet)
            self._count += 1

    def pop(self) -> tuple[list[Packet], int]:
        """Remove and return the packets, and the number of those that have ever come."""
        with self._lock:
            packets = list(self._packets)
            self._packets.clear()
            return packets, self._count


class PageStream(ABC):
    """A stream; made, updated and closed on the server's thread.

    Its parameters are arguments by keyword, which are read by their annotations.

    A stream of a topic calls ``self.follow(topic, take)`` in its ``__init__``. ``take`` is
    called on the source's thread; it must be quick, and lock shared data: as ``Waiting.add``.
    """

    period: ClassVar[float] = 0.1  # the shortest time between two updates [s]
    # Equal streams of all pages are one stream, whose updates are created once. Not for streams
    # whose updates accumulate: a slow page does not get all of them.
    is_shared: ClassVar[bool] = False
    commands: ClassVar[bool] = False  # True if only for pages that may command

    def __init__(self, source: Source) -> None:
        self.source = source
        self._topic = ""
        self._at_close = ExitStack()

    @abstractmethod
    def update(self) -> Update | None:
        """Return what is new since the last call, the newest only; None if nothing is new.

        If a stream is shared, an update equal to the last one is not sent.
        """

    def problem(self) -> str:
        """Return a sentence on why there is nothing to show; "" if all is well.

        For a stream of one topic: that it does not exist, or is silent.
        """
        return absence(self.source, self._topic) if self._topic else ""

    def close(self) -> None:
        """Stop following topics."""
        self._at_close.close()

    def follow(self, topic: str, take: Callable[..., None]) -> None:
        """Receive a topic's messages until the stream is closed."""
        self._topic = topic
        if topic:
            self.until_closed(self.source.follow(topic, take))

    def until_closed(self, end: Callable[[], None]) -> None:
        """Call ``end`` when the stream is closed."""
        self._at_close.callback(end)
