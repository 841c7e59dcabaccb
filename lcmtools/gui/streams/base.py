"""A stream: something of a source that a page gets updates of until it closes it.

A kind of stream is a class in a file of its own and a line in ``streams.STREAMS``.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import ClassVar

from lcmtools.gui.protocol import Frame, Json, Parameters, binary_frame, text_frame
from lcmtools.gui.source import Source, absence


@dataclass(frozen=True, slots=True)
class Update:
    """An update for a page: values, and numbers as bytes (little-endian) where there are many."""

    data: Mapping[str, Json]
    payload: bytes | memoryview | None = None

    def frame(self, number: int) -> Frame:
        """Return it as a frame of the stream with this number."""
        if self.payload is None:
            return text_frame({"id": number, "data": self.data})
        return binary_frame({"id": number, **self.data}, self.payload)


class PageStream(ABC):
    """A stream; made, updated and closed on the server's thread.

    What follows a topic calls ``self.follow(topic, self.take)`` in its ``__init__``: ``take`` is
    then called on the source's thread, has to be quick and to guard what it shares by a lock.
    """

    period: ClassVar[float] = 0.1  # the shortest time between two updates [s]
    # Equal streams of all pages are one, whose update is made once. Not for streams whose updates
    # add to each other: a slow page does not get all of them.
    is_shared: ClassVar[bool] = False
    commands: ClassVar[bool] = False  # only for pages that may command

    def __init__(self, source: Source, parameters: Parameters) -> None:
        self.source = source
        self.parameters = parameters
        self._topic = ""
        self._at_close = ExitStack()

    @abstractmethod
    def update(self) -> Update | None:
        """Return what is new since the last call, the newest only; None for nothing.

        Where a stream is shared, an update like the last one counts as nothing.
        """

    def problem(self) -> str:
        """Return why there is nothing to show, as a sentence; "" if all is well.

        Of a stream of one topic: that it is not there, or silent.
        """
        return absence(self.source, self._topic) if self._topic else ""

    def close(self) -> None:
        """Follow nothing any more."""
        self._at_close.close()

    def follow(self, topic: str, take: Callable[..., None]) -> None:
        """Take a topic's messages until the stream is closed."""
        self._topic = topic
        if topic:
            self.until_closed(self.source.follow(topic, take))

    def until_closed(self, end: Callable[[], None]) -> None:
        """Call this when the stream is closed."""
        self._at_close.callback(end)
