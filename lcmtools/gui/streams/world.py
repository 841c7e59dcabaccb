"""The streams of the world: drawable topics, frames, markers, and others' newest messages.

Each has a ``topic``, except the first one. ``gui.drawings`` has the form of messages for a page.
"""

import time
from typing import ClassVar

from lcmtools.errors import DecodeError
from lcmtools.graph.model import Graph
from lcmtools.gui.drawings import (
    DRAWINGS,
    Malformed,
    MarkerScene,
    drawing_kinds,
    frames_drawing,
)
from lcmtools.gui.frames import FrameStore
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, absence, age_text
from lcmtools.gui.streams.base import PageStream, Update, Waiting
from lcmtools.gui.streams.topics import current_rows, newest_simulator
from lcmtools.messages.registry import Message, type_name
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.simulators import simulators
from lcmtools.text_table import plural
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker, MarkerArray
from lcmtools.wire.packet import Packet

_MOST_WAITING = 2000  # waiting messages between two updates
_FASTEST = 20e6  # [bytes/s] of one stream's numbers; larger messages are sent less often


class Drawable(PageStream):
    """The topics that can be drawn, the types of the others, and the simulators."""

    period = 0.5
    is_shared = True

    def update(self) -> Update:
        """Return the current ones."""
        latest, kinds = self.source.latest, drawing_kinds()
        typed = [(row, row.types[0]) for row in current_rows(latest) if row.types]
        # frames have ages of their own, because several programs publish on one topic
        topics: list[Json] = [
            {"topic": row.channel, "type": name, "kind": kinds[name]}
            | {"silence": None if kinds[name] == "frames" else _silence(row, latest.graph)}
            for row, name in typed
            if name in kinds
        ]
        undrawn = sorted({name for _, name in typed if name not in kinds})
        found = sorted({node.name for node in simulators(latest.graph)})
        return Update({"topics": topics, "undrawn": undrawn, "simulators": found})


def _silence(row: ChannelRow, graph: Graph) -> Json:
    """Return how long a topic has been silent [s] that was sent repeatedly; None if it is not."""
    is_repeated = row.messages > max(1, len(row.senders))
    is_old = row.rate == 0 and is_repeated and not graph.topic(row.channel).is_latched
    return round(row.age) if is_old and row.age is not None else None


class _Messages(PageStream):
    """A topic's messages, which wait for the next update and are decoded then."""

    is_shared = True
    most_waiting: ClassVar[int] = 1

    def __init__(self, source: Source, *, topic: str) -> None:
        super().__init__(source)
        self._waiting = Waiting(self.most_waiting)
        self._mistake = ""
        self._has_come = False
        self.follow(topic, self._waiting.add)

    def problem(self) -> str:
        """Return why nothing has been drawn; a latched topic may be silent."""
        return self._mistake or ("" if self._has_come else absence(self.source, self._topic))

    def pop(self, *kinds: type[Message]) -> list[tuple[Packet, Message]]:
        """Remove and return the waiting messages that have one of these types."""
        packets, _ = self._waiting.pop()
        found: list[tuple[Packet, Message]] = []
        for packet in packets:
            try:
                message = self.source.decode(packet)
            except DecodeError as error:
                self._mistake = f"{self._topic}: {error}"
                continue
            if isinstance(message, kinds):
                self._mistake = ""
                found.append((packet, message))
            else:
                self._mistake = f"{self._topic}: the world cannot draw {type_name(message)}"
        self._has_come = self._has_come or bool(found)
        return found


class Frames(_Messages):
    """The frames of a topic of tf2_msgs/TFMessage: all of them, each at its latest pose."""

    period = 1 / 30
    most_waiting = _MOST_WAITING

    def __init__(self, source: Source, *, topic: str) -> None:
        super().__init__(source, topic=topic)
        self._store = FrameStore()
        self._old: list[str] = []
        self._seen: Snapshot | None = None

    def update(self) -> Update | None:
        """Return all frames, if any messages came, or one has become old."""
        found = self.pop(TFMessage)
        for packet, message in found:
            assert isinstance(message, TFMessage), "it was taken as one"
            if ignored := self._store.add(message, packet.time):
                self._mistake = f"{self._topic}: {ignored}"
        before = self._old
        if self.source.latest is not self._seen or (found and self._old):
            self._seen = self.source.latest
            old, began = self._old_frames(self._seen), newest_simulator(self._seen)
            self._store.forget([name for name, time in old.items() if time < began])
            self._old = [name for name, time in old.items() if time >= began]
        return frames_drawing(self._store, self._old) if found or self._old != before else None

    def problem(self) -> str:
        """Return also how old frames are that are no longer sent."""
        if (problem := super().problem()) or not self._old:
            return problem
        name, times = self._old[0], {child: link.time for child, _, link in self._store.latest()}
        age = (self.source.latest.graph.time - times[name]) / 1e9
        return (
            f"old: {len(self._old)} of {plural(len(times), 'frame')}, '{name}' for {age_text(age)}"
        )

    def _old_frames(self, latest: Snapshot) -> dict[str, int]:
        """Return the frames that are no longer sent, with the time of their last message [ns].

        Of one that came once, its topic tells it.
        """
        graph, row = latest.graph, latest.row(self._topic)
        if graph.topic(self._topic).is_latched:
            return {}
        is_silent = _silence(row, graph) is not None
        return {
            child: link.time
            for child, _, link in self._store.latest()
            if link.is_old(graph.time, is_once=is_silent)
        }


class Markers(_Messages):
    """The markers of a topic that exist at the time."""

    period = 0.1
    most_waiting = 100

    def __init__(self, source: Source, *, topic: str) -> None:
        super().__init__(source, topic=topic)
        self._scene = MarkerScene()
        self._last = b""

    def update(self) -> Update | None:
        """Return all markers, if they have changed."""
        for packet, message in self.pop(Marker, MarkerArray):
            if packet.payload != self._last:  # latched ones come repeatedly
                self._scene.add(message, time.monotonic())
                self._last = packet.payload
        return self._scene.drawing(time.monotonic())


class Newest(_Messages):
    """The newest message of a topic with one of the types in ``drawings.DRAWINGS``."""

    period = 1 / 30

    def __init__(self, source: Source, *, topic: str) -> None:
        super().__init__(source, topic=topic)
        self._not_before = 0.0

    def update(self) -> Update | None:
        """Return the newest message, if it has not been returned yet."""
        if time.monotonic() < self._not_before:
            return None
        for packet, message in self.pop(*DRAWINGS):
            drawing = DRAWINGS[type(message)]
            try:
                found = drawing.convert(message)
            except Malformed as error:
                self._mistake = f"{self._topic}: not drawn: {error}"
                continue
            self._not_before = time.monotonic() + len(found.payload or b"") / _FASTEST
            data = {**found.data, "kind": drawing.kind, "time": packet.time / 1e9}
            return Update(data, found.payload)
        return None
