"""The sources that pages look at: a bus, or a log that is played.

A source reads on a thread of its own. ``latest`` is a frozen snapshot; ``follow`` hands the whole
messages of a channel over on the source's thread.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Literal, Protocol

from lcmtools.gui.protocol import Json
from lcmtools.gui.publishing import Publishers
from lcmtools.gui.steering import Steering
from lcmtools.messages.registry import Message
from lcmtools.names import check_length, closest
from lcmtools.observe.channels import ChannelSelection
from lcmtools.observe.decoding import Decoder
from lcmtools.observe.feed import Feed, Snapshot
from lcmtools.observe.following import Take
from lcmtools.observe.monitor import BusMonitor
from lcmtools.wire.packet import Packet

End = Callable[[], None]
"""Ends what was begun; called once."""


class Source(Protocol):
    """A bus or a log, as pages see it."""

    kind: Literal["bus", "log"]  # whether it is a bus or a log
    name: str  # the URL, or the file
    publishers: Publishers | None  # what publishes for pages; None where nobody can
    steering: Steering | None  # what drives robots for pages; likewise

    @property
    def latest(self) -> Snapshot:
        """Its channels, nodes and trouble; another object each time it changes."""

    def follow(self, channel: str, take: Take) -> End:
        """Pass a channel's whole messages on, on another thread; return the end of that."""

    def listen_to_all(self) -> End:
        """Let nodes know of a listener to every channel but images'; return the end of that."""

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises as ``Decoder.decode``."""

    def state(self) -> Mapping[str, Json]:
        """Return the state for all pages: ``trouble``, and more of a log."""

    def close(self) -> None:
        """Read no more, and publish no more."""


class BusSource:
    """A bus."""

    kind: Literal["bus", "log"] = "bus"

    def __init__(self, monitor: BusMonitor) -> None:
        self.name = str(monitor.url)
        publishers = Publishers(monitor.url)
        self.publishers: Publishers | None = publishers
        self.steering: Steering | None = Steering(publishers, is_lossy=monitor.url.is_multicast)
        self._feed = Feed(monitor, ChannelSelection())
        self._feed.listens_to_all = False
        self._feed.keeps_last = True
        self._feed.listens_to_large = False  # a table is not worth 100 MB/s of a camera
        self._decoder = Decoder(self._announced)
        self._listeners = 0
        self._feed.start()

    @property
    def latest(self) -> Snapshot:
        """The bus as it was last looked at."""
        return self._feed.latest

    def follow(self, channel: str, take: Take) -> End:
        """Pass a channel's whole messages on, on another thread; return the end of that.

        Raises:
            InvalidName: No channel can have this name.
        """
        return self._feed.follow(check_length(channel), take)

    def listen_to_all(self) -> End:
        """Announce to listen to every channel but those of images; return the end of that."""
        self._listeners += 1
        self._feed.listens_to_all = True

        def end() -> None:
            self._listeners -= 1
            self._feed.listens_to_all = self._listeners > 0

        return end

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises as ``Decoder.decode``."""
        return self._decoder.decode(packet)

    def state(self) -> Mapping[str, Json]:
        """Return the trouble of the bus."""
        return {"trouble": self.latest.trouble}

    def close(self) -> None:
        """Read no more, and publish no more."""
        if self.steering:
            self.steering.close()
        self._feed.stop()
        if self.publishers:
            self.publishers.close()

    def _announced(self, channel: str) -> Sequence[str]:
        row = self.latest.row(channel)
        return row.types if row.is_announced else ()


def absence(source: Source, topic: str) -> str:
    """Return the reason why no message of a topic comes, as a sentence; "" while some do."""
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
    return f"{topic} is silent: the last message came {_age(row.age)} ago" if row.is_silent else ""


def _age(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"  # noqa: PLR2004
