"""The frames of a bus or a log, as their transforms come."""

import math
import time
from collections.abc import Callable, Iterator

from lcmtools.errors import DecodeError
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import fingerprint, type_name
from lcmtools.names import Pattern
from lcmtools.observe.frames.frames import Trees
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet

_TYPE, _FINGERPRINT = type_name(TFMessage), fingerprint(TFMessage)
_LOOK_PERIOD = 0.5  # [s] between searches for topics
_WAIT = 0.1  # [s] at most between two states


class FollowedFrames:
    """The trees of frames, by the transforms on the topics in a namespace; None for all.

    ``notify`` is called with a sentence, once, on each kind of transform that is ignored.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        namespace: str | None = None,
        notify: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._monitor, self._notify = monitor, notify
        self._namespace = Pattern(namespace, hidden=True) if namespace else None
        self.trees = Trees()
        self.messages = 0  # number of messages with transforms
        self.time = 0  # of the last message [ns since 1970]
        self._told: set[str] = set()

    def follow(self, period: float, duration: float | None = None) -> Iterator[int]:
        """Yield the time [ns since 1970] once a period [s], and at the end.

        That is the end of a log, whose time is that of recording, or of ``duration`` [s].
        """
        self._monitor.discover()
        deadline = math.inf if duration is None else time.monotonic() + duration
        next_look, due = 0.0, 0
        try:
            while (now := time.monotonic()) < deadline:
                if now >= next_look:
                    next_look = now + _LOOK_PERIOD
                    self._listen()
                for packet in self._monitor.receive(_WAIT):
                    if not self._monitor.is_live:
                        due = due or packet.time + round(period * 1e9)
                        while packet.time > due:
                            yield due
                            due += round(period * 1e9)
                    self._add(packet)
                moment = time.time_ns()
                if self._monitor.is_live and moment >= due:
                    due = moment + round(period * 1e9)
                    yield moment
        except EOFError:
            pass
        yield self.time if not self._monitor.is_live else time.time_ns()

    def _listen(self) -> None:
        """Announce that it listens, so that publishers send what they have latched."""
        topics = self._monitor.graph().topics()
        self._monitor.listen_to([one.name for one in topics if _TYPE in one.types])

    def _add(self, packet: Packet) -> None:
        self.time = packet.time
        channel = packet.channel
        if packet.fingerprint != _FINGERPRINT:
            return
        if self._namespace and not self._namespace.covers(channel):
            return
        try:
            message = decode(TFMessage, packet.payload)
        except DecodeError as error:
            self._tell(f"a message on {channel} is ignored: {error}")
            return
        self.messages += 1
        frames = self.trees.at(channel)
        for one in message.transforms:
            if fault := frames.add(one, channel, packet.time, packet.sender):
                self._tell(fault)

    def _tell(self, fault: str) -> None:
        if fault not in self._told and len(self._told) < 10:  # noqa: PLR2004 - enough to see them
            self._told.add(fault)
            self._notify(fault)
