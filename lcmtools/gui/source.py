"""The sources that pages show: a bus, or a log that is played.

A source reads on its own thread. ``latest`` is a frozen snapshot; ``follow`` passes on a channel's
whole messages on the source's thread.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Literal, Protocol

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.page_publisher import Publishers
from lcmtools.gui.protocol import Json
from lcmtools.gui.recording import Recordings
from lcmtools.gui.steering import SpeedLimits, Steering
from lcmtools.gui.steering_process import SteeringProcess
from lcmtools.messages.registry import Message
from lcmtools.names import check_length, closest, resolve
from lcmtools.observe.channels.feed import Feed, Snapshot
from lcmtools.observe.channels.rows import ChannelSelection
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.following import Receiver
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.publish.publication import check_topic
from lcmtools.wire.packet import Packet

_LIMITS = SpeedLimits()
_HERE = Path()
_SHARED = ("udpm", "mpudpm", "tcpq", "zenoh")  # providers that another process can publish with

End = Callable[[], None]  # ends what was begun; must be called once


class Source(Protocol):
    """A bus or a log, as shown by pages."""

    kind: Literal["bus", "log"]  # whether it is a bus or a log
    name: str  # the URL, or the file
    publishers: Publishers | None  # publishes for pages; None if not possible
    steering: Steering | None  # drives robots for pages; likewise
    recordings: Recordings | None  # records for pages; likewise

    @property
    def latest(self) -> Snapshot:
        """Its channels, nodes and problems; a new object each time it changes."""

    def follow(self, channel: str, receive: Receiver) -> End:
        """Pass a channel's whole messages on, on another thread; return a call to end it."""

    def listen_to_all(self) -> End:
        """Announce a listener to every channel except images'; return a call to end it."""

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises errors as ``Decoder.decode``."""

    def state(self) -> Mapping[str, Json]:
        """Return the state for all pages: ``trouble``, and more for a log."""

    def close(self) -> None:
        """Stop reading and publishing."""


class BusSource:
    """A bus; pages can command velocities up to ``limits``, and record in the ``directory``."""

    kind: Literal["bus", "log"] = "bus"

    def __init__(
        self, monitor: BusMonitor, limits: SpeedLimits = _LIMITS, directory: Path = _HERE
    ) -> None:
        self.name = str(monitor.url)
        publishers = Publishers(monitor.url)
        self.publishers: Publishers | None = publishers
        self.steering: Steering | None = None
        if monitor.url.provider in _SHARED:
            start = partial(SteeringProcess, monitor.url)
            self.steering = Steering(publishers, limits, start)
        self.recordings: Recordings | None = Recordings(monitor.url, directory)
        self._feed = Feed(monitor, ChannelSelection(), keeps_last=True)
        self._feed.listens_to_all = False
        self._feed.listens_to_large = False  # a table is not worth a camera's 100 MB/s
        self._decoder = Decoder(self._announced)
        self._listeners = 0
        self._feed.start()

    @property
    def latest(self) -> Snapshot:
        """The latest snapshot of the bus."""
        return self._feed.latest

    def follow(self, channel: str, receive: Receiver) -> End:
        """Pass a channel's whole messages on, on another thread; return a call to end it.

        Raises:
            InvalidName: No channel can have this name.
        """
        return self._feed.follow(check_length(channel), receive)

    def listen_to_all(self) -> End:
        """Announce a listener to every channel except images'; return a call to end it."""
        self._listeners += 1
        self._feed.listens_to_all = True

        def end() -> None:
            self._listeners -= 1
            self._feed.listens_to_all = self._listeners > 0

        return end

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises errors as ``Decoder.decode``."""
        return self._decoder.decode(packet)

    def state(self) -> Mapping[str, Json]:
        """Return the bus's problem."""
        return {"trouble": self.latest.trouble}

    def close(self) -> None:
        """Stop reading and publishing, and finish a recording."""
        if self.steering:
            self.steering.close()
        self._feed.stop()
        if self.publishers:
            self.publishers.close()
        if self.recordings:
            self.recordings.stop()

    def _announced(self, channel: str) -> Sequence[str]:
        row = self.latest.row(channel)
        return row.types if row.is_announced else ()


def publishers_of(source: Source) -> Publishers:
    """Return what publishes for pages; LcmtoolsError if nothing can be published here."""
    if source.publishers is None:
        raise LcmtoolsError("a log takes no messages", "open the window on a bus")
    return source.publishers


def topic_named(source: Source, text: str) -> str:
    """Return the topic that a page means: a slash may be missing, unless a channel is named so."""
    channels = {row.channel for row in source.latest.rows}
    return f"/{text}" if text not in channels and f"/{text}" in channels else text


def topic_to_publish(source: Source, text: str) -> str:
    """Return the topic to publish on: a name on the bus as it is, others by ROS's rules."""
    topic = topic_named(source, text)
    is_known = any(row.channel == topic for row in source.latest.rows)
    check_topic(topic, plain_channel=is_known)
    return topic if is_known else resolve(topic)


def absence(source: Source, topic: str) -> str:
    """Return a sentence on why no message arrives on a topic; "" while some do."""
    if not topic:
        return "choose a topic"
    latest = source.latest
    row = latest.row(topic)
    if row.age is None and not row.types and not row.senders and not row.listeners:
        near = closest(topic, [one.channel for one in latest.rows])
        hint = f"; did you mean {near[0]}?" if near else "; waiting for it"
        return f"there is no topic {topic}{hint}"
    if row.age is None:
        who = f"published by {', '.join(row.senders)}" if row.senders else "nothing publishes it"
        return f"no message of {topic} has come yet; {who}"
    said = f"{topic} is silent: the last message came {age_text(row.age)} ago"
    return said if row.is_silent else ""


def age_text(age: float) -> str:
    """Return an age [s] in seconds or minutes."""
    return f"{age:.0f} s" if age < 100 else f"{age / 60:.0f} min"  # noqa: PLR2004
