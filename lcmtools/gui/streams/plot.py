"""The stream of a plot: all values of some numeric fields, with their times and units.

For a log, these are all values from its start to its end, wherever it is played.
"""

import threading
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from difflib import SequenceMatcher

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.graph.model import Graph
from lcmtools.gui.log_source import LogSource
from lcmtools.gui.protocol import Json, MalformedRequest
from lcmtools.gui.source import Source, absence
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.gui.type_forms import unit_of
from lcmtools.messages.message_time import message_time
from lcmtools.messages.path import Path, splits
from lcmtools.messages.registry import Message
from lcmtools.names import closest, is_hidden
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.measuring.curves import numbers
from lcmtools.observe.reading.arrivals import ArrivalClock
from lcmtools.observe.reading.selection import OneTopic, TopicPattern, select_topics
from lcmtools.wire.packet import Packet

_MOST_SAMPLES = 100_000  # that wait for a page; beyond this, the oldest are dropped and counted
_SAMPLE = 3  # numbers: its time [s since 1970], its value, and the number of its curve


@dataclass(slots=True)
class _Fields:
    """The fields selected by an argument, on its topics."""

    text: str
    selection: OneTopic | TopicPattern | None = None
    paths: dict[str, Path] = field(default_factory=dict)  # by topic
    curves: list[int] = field(default_factory=list)
    mistake: str = ""  # in the argument, or in the last message

    def update(self, graph: Graph) -> None:
        """Update the topics that match."""
        try:
            self.selection = self.selection or select_topics(self.text)
            self.selection.update(graph)
        except LcmtoolsError as error:
            self.mistake = str(error)
            return
        found = ((name, self.selection.path_on(name)) for name in graph.topic_names())
        self.paths = {name: path for name, path in found if path is not None}


class Plot(PageStream):
    """Curves; each update has the new samples, in order of arrival.

    Their ``time`` is that of "arrival", by the system clock; the "stamp" of the message, or a field
    such as ``utime``; or the "simulated" time of arrival.
    """

    period = 0.05

    def __init__(
        self,
        source: Source,
        *,
        fields: tuple[str, ...] = (),
        choice: float = 0,
        time: str = "arrival",
    ) -> None:
        super().__init__(source)
        self._lock = threading.Condition()
        self._fields = [_Fields(text) for text in fields]
        self._choice = choice
        self._time = time
        if self._time not in ("arrival", "stamp", "simulated"):
            raise MalformedRequest(f"there is no time '{self._time[:40]}'")
        self._clock = ArrivalClock(is_simulated=True)
        self._curves: dict[str, int] = {}
        self._units: list[str] = []
        self._samples = array("d")
        self._left_out = 0
        self._followed: set[str] = set()
        self._seen: Snapshot | None = None
        self._told: Json = None
        self._reader: threading.Thread | None = None  # reads a log
        self._about_log: dict[str, Json] = {}
        self._is_closed = False

    def update(self) -> Update | None:
        """Return the samples since the last call."""
        self._follow_topics()
        with self._lock:
            samples, self._samples = self._samples, array("d")
            left_out, self._left_out = self._left_out, 0
            self._lock.notify_all()
        data, self._about_log = self._about_log, {}
        if left_out:
            data["leftOut"] = left_out
        about = self._about()
        if about != self._told:
            self._told = data["fields"] = about
            data["curves"] = list(self._curves)
            data["units"] = list(self._units)
        if not samples and not data:
            return None
        return Update({"choice": self._choice, **data}, samples.tobytes())  # which fields these are

    def close(self) -> None:
        """Stop following topics and reading a log."""
        with self._lock:
            self._is_closed = True
            self._lock.notify_all()
        super().close()
        if self._reader:
            self._reader.join()

    def _follow_topics(self) -> None:
        """Follow the topics that exist now."""
        latest = self.source.latest
        if latest is self._seen:
            return
        is_first, self._seen = self._seen is None, latest
        for one in self._fields:
            one.update(latest.graph)
        wanted = {topic for one in self._fields for topic in one.paths}
        if self._time == "simulated":
            wanted.add(CLOCK_TOPIC)
        for topic in wanted - self._followed:
            self._followed.add(topic)
            if not isinstance(self.source, LogSource):
                self.until_closed(self.source.follow(topic, self._receive))
        if isinstance(self.source, LogSource) and is_first:
            every, packets = self.source.read(self._followed)
            start = self.source.start if self._time == "arrival" else None
            self._about_log = {"start": start, "every": every}
            self._reader = threading.Thread(
                target=self._read, args=[packets], name="plot of a log", daemon=True
            )
            self._reader.start()

    def _read(self, packets: Iterator[Packet]) -> None:
        """Read messages as fast as the page accepts the samples."""
        few = _SAMPLE * _MOST_SAMPLES // 4
        for packet in packets:
            with self._lock:
                self._lock.wait_for(lambda: self._is_closed or len(self._samples) < few)
                if self._is_closed:
                    return
            self._receive(packet)

    def _receive(self, packet: Packet) -> None:
        self._clock.update(packet)
        try:
            message = self.source.decode(packet)
            time = self._time_of(packet, message)
        except DecodeError as error:
            self._note(packet.channel, str(error))
            return
        with self._lock:
            for one in self._fields:
                path = one.paths.get(packet.channel)
                if path is None:
                    continue
                try:
                    found = numbers(message, path)
                except LcmtoolsError as error:
                    one.mistake = str(error)
                    continue
                one.mistake = ""
                for inner, value in found:
                    curve = self._curve(one, f"{packet.channel}/{inner}")
                    if curve == len(self._units):
                        self._units.append(unit_of(type(message), inner))
                    self._samples.extend((time, value, curve))
            extra = len(self._samples) - _SAMPLE * _MOST_SAMPLES
            if extra > 0:
                del self._samples[: extra + _SAMPLE * _MOST_SAMPLES // 2]
                self._left_out += extra // _SAMPLE + _MOST_SAMPLES // 2

    def _time_of(self, packet: Packet, message: Message) -> float:
        """Return the time of a message's samples [s]; DecodeError if it is not known."""
        if self._time == "stamp":
            found = message_time(message)
            if not found or not found.time:
                what = f"{found.field} is {found.value:g}" if found else "they have no header.stamp"
                raise DecodeError(f"the messages of {packet.channel} have no time: {what}")
            return found.time / 1e9
        if self._time == "simulated":
            if self._clock.now is None:
                raise DecodeError(f"simulated time is not known: nothing came on {CLOCK_TOPIC} yet")
            return self._clock.now / 1e9
        return packet.time / 1e9

    def _curve(self, one: _Fields, label: str) -> int:
        curve = self._curves.setdefault(label, len(self._curves))
        if curve not in one.curves:
            one.curves.append(curve)
        return curve

    def _note(self, channel: str, mistake: str) -> None:
        with self._lock:
            for one in self._fields:
                if channel in one.paths:
                    one.mistake = mistake

    def _about(self) -> Json:
        with self._lock:
            return [
                {"text": one.text, "problem": self._problem(one), "curves": list(one.curves)}
                for one in self._fields
            ]

    def _problem(self, one: _Fields) -> str:
        """Return why an argument has no curve; "" if all is well."""
        if one.mistake or not one.paths:
            return one.mistake or _unknown(one.text, self.source.latest.graph)
        is_read = self._reader is not None and self._reader.is_alive()
        return "" if one.curves or is_read else absence(self.source, next(iter(one.paths)))


def _unknown(text: str, graph: Graph) -> str:
    """Return a sentence that an argument begins with no known topic, with a similar one."""
    known = [name for name in graph.topic_names() if not is_hidden(name)]
    near = [(topic, one, rest) for topic, rest in splits(text) for one in closest(topic, known)]
    hint = "waiting for it"
    if near:
        _, name, rest = max(near, key=lambda one: SequenceMatcher(None, *one[:2]).ratio())
        hint = f"did you mean {name}{rest}?"
    return f"there is no topic for {text}; {hint}"
