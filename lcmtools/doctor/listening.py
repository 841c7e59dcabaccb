"""The evidence in the messages that arrive during the look.

Packets in, evidence out. Every message is counted; the time for decoding is limited, so that only
a sample of a busy bus is decoded.
"""

import contextlib
import shlex
import time
from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING, cast

from lcmtools.bounded import BoundedDict
from lcmtools.clock import CLOCK_TOPIC, join_stamp
from lcmtools.doctor.evidence import FrameParent, LogLine, Oddity, RelayEnd, Stream
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.graph.protocol import RELAY_CHANNEL
from lcmtools.messages.codec import decode
from lcmtools.messages.message_time import UNITS, MessageTime, message_time
from lcmtools.messages.registry import Message, type_name
from lcmtools.names import is_hidden, namespace_of
from lcmtools.observe.reading.decoding import Decoder, UnknownFingerprint
from lcmtools.wire.packet import Packet, Sender

if TYPE_CHECKING:  # these imports are slow, and most looks do not need them
    from lcmtools.graph.relay_report import Link
    from lcmtools.types.rosgraph_msgs import Clock, Log
    from lcmtools.types.tf2_msgs import TFMessage

_LOG = "/rosout"
_CLOCK, _LOGGED = "rosgraph_msgs/Clock", "rosgraph_msgs/Log"
_TRANSFORMS = "tf2_msgs/TFMessage"
_LEVELS = {4: "warning", 8: "error", 16: "fatal"}  # rosgraph_msgs/Log
_PARTS = 5  # of a look, whose rates of simulated time are compared
_CLOCK_SPAN = 0.3  # [s] of ticks are enough for the rate of simulated time
_MOST_TIMES = 5000
_MODULUS, _MOST_AHEAD = 1 << 32, 1000  # of a program's numbers on one channel
_MOST_RUNS, _MIXED = 4, 4  # programs on a port; turns that one program that is restarted has not
_MOST_STREAMS, _MOST_BYTES = 2000, 64 << 20
_MOST_RELAYS = 200
_MOST_ODDITIES, _MOST_LOGS, _MOST_FRAMES = 200, 50, 2000
_MOST_COMPARED = 1000  # messages of a channel
_COMPARED_BYTES = 256  # at a payload's beginning, and at its end
_LOG_CHARACTERS = 200
_SHARE = 0.3  # of the time may be spent on decoding
_ENTRY = 100  # bytes of a number in a set or a list
_LARGEST = 4 << 20  # bytes of a message that is decoded
_FUTURE, _OLD = 1.0, 10.0  # [s] the largest error of a stamp
_SIMULATED = 10**18  # [ns] an earlier stamp (2001) counts from a simulation's start

_DAY = 86_400 * 10**9  # [ns]
_FASTEST = 10  # times real time, or its part, at which a log is played

_Key = tuple[str, Sender | None]
_Stamped = tuple[int, int]  # arrival and stamp of a message [ns]


@dataclass(slots=True)
class _Stream:
    times: list[int] = field(default_factory=list)
    largest: int = 0
    bytes: int = 0
    format: str = ""
    numbered: dict[int, int] = field(default_factory=dict)  # hashes of payloads, by their numbers
    doubled: set[int] = field(default_factory=set)  # numbers
    repeated: set[int] = field(default_factory=set)  # hashes of payloads
    runs: list[int] = field(default_factory=list)  # the newest number of each program on its port
    newest_run: int = 0
    turns: int = 0  # messages of another program than the one before

    def take_number(self, seqno: int) -> None:
        """Assign a number to the program that counts up to it: several may share a port."""
        ahead = [((seqno - newest) % _MODULUS, n) for n, newest in enumerate(self.runs)]
        gap, at = min(ahead, default=(_MODULUS, 0))
        if not 0 < gap <= _MOST_AHEAD:
            at = len(self.runs) if len(self.runs) < _MOST_RUNS else 0
        self.turns += bool(self.runs) and at != self.newest_run
        self.runs[at : at + 1], self.newest_run = [seqno], at

    def size(self) -> int:
        """Return the memory that it takes [byte]."""
        counts = len(self.times), len(self.numbered), len(self.doubled), len(self.repeated)
        return _ENTRY * (1 + sum(counts))


class Listening:
    """The evidence in messages as they arrive, of the streams that came first if there are many.

    ``types_of`` returns the announced types of a topic; ``share`` is the share of the time that
    decoding may take. Several programs may send from ``port``, that of the bus, as of Java.
    """

    def __init__(
        self, types_of: Callable[[str], Sequence[str]], share: float = _SHARE, port: int = 0
    ) -> None:
        self._share, self._port = share, port
        self._types_of, self._decoder = types_of, Decoder(types_of)
        self._classes = BoundedDict[
            tuple[bytes, tuple[str, ...]], "type[Message] | UnknownFingerprint"
        ](_MOST_STREAMS)
        self._streams = BoundedDict[_Key, _Stream](_MOST_STREAMS, _MOST_BYTES)
        # the first sender of each payload, by channel
        self._compared = BoundedDict[str, dict[int, Sender | None]](_MOST_STREAMS, _MOST_BYTES)
        self._odd: dict[tuple[str, _Key, str], Oddity] = {}
        self._frames: dict[tuple[str, str, str], Sender | None] = {}  # by tree, child and parent
        self._logs: Counter[tuple[str, str, str]] = Counter()  # by node, level and text
        self._old: dict[_Key, tuple[_Stamped, _Stamped]] = {}  # the first and the last old stamp
        self._current: set[Sender] = set()  # whose stamps, or some, are those of the present
        self._start = time.monotonic()
        self._spent = 0.0
        self.clock_ticks: deque[tuple[int, int]] = deque(maxlen=_MOST_TIMES)
        """Arrival and simulated time of the messages on ``/clock`` [ns]."""
        self.clock_sender: Sender | None = None
        self._clocks: set[Sender | None] = set()
        self.relays = RelayReports()

    def add_packet(self, packet: Packet) -> None:
        """Add a message to the evidence."""
        if is_hidden(packet.channel):
            if packet.channel == RELAY_CHANNEL:
                self.relays.add_report(packet.payload)
            return
        key = (packet.channel, packet.sender)
        stream = self._streams.use(key)
        if stream is None and len(self._streams) < _MOST_STREAMS:
            stream = _Stream()
        if stream is not None:
            self._count(packet, stream)
            self._streams.put(key, stream, stream.size())
        try:
            cls = self._class_of(packet)  # loading a type does not count as decoding
        except LcmtoolsError:  # unknown type
            if stream is not None:
                self._inspect_unknown(packet, stream)
            return
        now = time.monotonic()
        has_time = self._spent <= self._share * (now - self._start) + 0.05
        if has_time or packet.channel in (CLOCK_TOPIC, _LOG):
            self._inspect(packet, key, cls)
            self._spent += time.monotonic() - now

    def streams(self) -> tuple[Stream, ...]:
        """Return the messages by channel and sender; the senders have no names yet."""
        return tuple(
            Stream(
                *(*key, "", tuple(s.times), s.largest, s.bytes, len(s.times) >= _MOST_TIMES),
                format=s.format,
                doubled=len(s.doubled),
                repeated=len(s.repeated),
                programs=len(s.runs) if s.turns >= _MIXED else 1,
            )
            for key, s in sorted(self._streams.items(), key=str)
        )

    def oddities(self, name: Callable[[Sender | None], str]) -> tuple[Oddity, ...]:
        """Return the oddities in the messages, each once."""
        return tuple(
            replace(odd, name=name(key[1]), kind=self._replayed(key) if kind == "old" else kind)
            for (kind, key, place), odd in self._odd.items()
            # a constant number may belong to a message that is sent repeatedly
            if kind != "old" or place == "header.stamp" or self._replayed(key) == "replayed"
            if kind != "boot" or not self.clock_ticks  # the clock started later
            # with several clocks these are ambiguous
            if kind not in ("future", "old") or len(self._clocks) <= 1
        )

    def _replayed(self, key: _Key) -> str:
        """Return "replayed" if a topic's old stamps advance with the clock, else "old".

        A log has no current stamps beside them.
        """
        (arrival, stamped), (last_arrival, last_stamped) = self._old[key]
        advance, passed = last_stamped - stamped, last_arrival - arrival
        is_even = passed and 1 / _FASTEST < advance / passed < _FASTEST
        return "replayed" if is_even and key[1] not in self._current else "old"

    def frames(self, name: Callable[[Sender | None], str]) -> tuple[FrameParent, ...]:
        """Return the frames of transforms with their parents, each pair once."""
        return tuple(FrameParent(*link, name(sender)) for link, sender in self._frames.items())

    def logs(self) -> tuple[LogLine, ...]:
        """Return the warnings and errors on ``/rosout``, each once."""
        return tuple(LogLine(*entry, count) for entry, count in self._logs.items())

    def clock_ratio(self) -> float | None:
        """Return the simulated seconds per second in most parts of the look.

        A single pause is not slowness, nor is a quick part speed. None if there are too few ticks,
        or if time jumps back.
        """
        ticks = list(self.clock_ticks)
        seconds = (ticks[-1][0] - ticks[0][0]) / 1e9 if ticks else 0.0
        if seconds < _CLOCK_SPAN or self._jumps():
            return None
        step = max(1, (len(ticks) - 1) // _PARTS)
        parts = [(ticks[n], ticks[n + step]) for n in range(0, len(ticks) - step, step)]
        return median((b[1] - a[1]) / max(1, b[0] - a[0]) for a, b in parts)

    def clock_jumps(self) -> int:
        """Return how often simulated time jumps back; 0 if several clocks are published."""
        return self._jumps() if len(self._clocks) == 1 else 0

    def _jumps(self) -> int:
        return sum(later[1] < one[1] for one, later in pairwise(self.clock_ticks))

    def _class_of(self, packet: Packet) -> type[Message]:
        """Return the type of a message, looked up once and not for each channel of a large log.

        Of types with equal fields any one does.
        """
        key = packet.payload[:8], tuple(self._types_of(packet.channel))
        if key not in self._classes:
            import lcmtools.doctor.content  # noqa: F401 - does not count as decoding either

            try:
                self._classes[key] = self._decoder.message_class(packet)
            except UnknownFingerprint as error:
                self._classes[key] = error
        found = self._classes[key]
        if isinstance(found, UnknownFingerprint):
            raise found
        return found

    def _count(self, packet: Packet, stream: _Stream) -> None:
        if len(stream.times) < _MOST_TIMES:
            stream.times.append(packet.time)
        stream.largest = max(stream.largest, packet.size)
        stream.bytes += packet.size
        if packet.sender and packet.sender.port == self._port and packet.seqno is not None:
            stream.take_number(packet.seqno)
        self._compare(packet, stream)

    def _compare(self, packet: Packet, stream: _Stream) -> None:
        """Note whether the same message came before, from the same or another sender."""
        known = self._compared.use(packet.channel) or {}
        self._compared.put(packet.channel, known, _ENTRY * len(known))
        for memory in (known, stream.numbered):
            if len(memory) >= _MOST_COMPARED:
                memory.clear()
        ends = packet.payload[:_COMPARED_BYTES], packet.payload[-_COMPARED_BYTES:]
        message = hash((*ends, packet.size))
        if known.setdefault(message, packet.sender) != packet.sender:
            if len(stream.repeated) < _MOST_TIMES:
                stream.repeated.add(message)
        elif packet.seqno is not None and len(stream.doubled) < _MOST_TIMES:
            if stream.numbered.get(packet.seqno) == message:
                stream.doubled.add(packet.seqno)
            stream.numbered[packet.seqno] = message

    def _inspect_unknown(self, packet: Packet, stream: _Stream) -> None:
        from lcmtools.messages.foreign import foreign_format

        is_whole = packet.whole_bytes is None
        if not packet.payload or stream.format:
            return
        stream.format = foreign_format(packet.payload, is_whole=is_whole)

    def _inspect(self, packet: Packet, key: _Key, cls: type[Message]) -> None:
        if packet.whole_bytes is not None or packet.size > _LARGEST:
            return
        from lcmtools.doctor.content import oddities

        try:
            message = decode(cls, packet.payload)
        except DecodeError as error:
            self._add_oddity("undecodable", key, str(error))
            return
        kind = type_name(message)
        if kind == _CLOCK and packet.channel == CLOCK_TOPIC:
            stamp = cast("Clock", message).clock
            self.clock_ticks.append((packet.time, join_stamp(stamp.sec, stamp.nsec)))
            self.clock_sender = packet.sender
            self._clocks |= {packet.sender} if len(self._clocks) <= 1 else set()
        elif kind == _LOGGED:
            self._add_log(cast("Log", message))
        elif kind == _TRANSFORMS:
            self._add_frames(packet, cast("TFMessage", message))
        odd = list(oddities(message))
        for kind, text in odd:
            self._add_oddity(kind, key, text)
        if not any(kind == "nsec" for kind, _ in odd):
            self._check_stamp(message, packet.time, key)

    def _add_log(self, log: "Log") -> None:
        text = log.msg.strip().partition("\n")[0][:_LOG_CHARACTERS]
        entry = log.name, _LEVELS.get(log.level, ""), text
        if entry[1] and (entry in self._logs or len(self._logs) < _MOST_LOGS):
            self._logs[entry] += 1

    def _add_frames(self, packet: Packet, message: "TFMessage") -> None:
        tree = namespace_of(packet.channel)
        for one in message.transforms[: _MOST_FRAMES - len(self._frames)]:
            names = one.child_frame_id.strip("/"), one.header.frame_id.strip("/")
            self._frames.setdefault((tree, *names), packet.sender)

    def _check_stamp(self, message: Message, arrival: int, key: _Key) -> None:
        found = message_time(message)
        if found is None or not found.time:
            return
        if found.field == "utime" and (unit := _unit(int(found.value), arrival)):
            text = f"utime is {found.value}: {unit}, not microseconds"
            self._add_oddity("unit", key, text)
        elif found.field != "utime" or found.time >= _SIMULATED:  # else by another clock
            self._compare_time(found, arrival, key)

    def _compare_time(self, found: MessageTime, arrival: int, key: _Key) -> None:
        """Note a time that is not the present one."""
        stamped, place = found.time, str(found)
        if stamped < _SIMULATED and not self.clock_ticks:
            self._add_oddity("boot", key, f"{place} is {stamped / 1e9:.1f} s since a start")
            return
        late = (arrival - stamped) / 1e9
        if stamped < _SIMULATED:
            late = (self.clock_ticks[-1][1] - stamped) / 1e9
        if late < -_FUTURE:
            self._add_oddity("future", key, f"{place} is {-late:.1f} s in the future")
        elif late > _OLD:
            self._add_oddity("old", key, f"{place} is {late:.1f} s old")
            if key in self._old or len(self._old) < _MOST_STREAMS:
                first, _ = self._old.get(key, ((arrival, stamped), None))
                self._old[key] = first, (arrival, stamped)
        elif key[1] and len(self._current) < _MOST_STREAMS:
            self._current.add(key[1])

    def _add_oddity(self, kind: str, key: _Key, text: str) -> None:
        """Count an oddity by its kind and its place, the first word of its text."""
        place = (kind, key, text.partition(" ")[0])
        if known := self._odd.get(place):
            self._odd[place] = replace(known, count=known.count + 1)
        elif len(self._odd) < _MOST_ODDITIES:
            self._odd[place] = Oddity(kind, key[0], "", text)


def _unit(number: int, now: int) -> str:
    """Return the unit in which a number is near the time ``now`` [ns]; "" for microseconds."""
    near = (name for name, length in UNITS.items() if abs(number * length - now) < _DAY)
    return next((name for name in near if name != "microseconds"), "")


def target_rate(command: str) -> float | None:
    """Return the --rate in a simulator's command line; 1 by default, None for 0."""
    try:
        words = shlex.split(command.replace("--rate=", "--rate "))
    except ValueError:
        return 1.0
    for option, value in pairwise(words):
        if option == "--rate":
            with contextlib.suppress(ValueError):
                return float(value) or None
    return 1.0


class RelayReports:
    """The first and the last report of each relay during a look."""

    def __init__(self) -> None:
        self._found: BoundedDict[str, tuple[Link, Link]] = BoundedDict(_MOST_RELAYS)

    def add_report(self, payload: bytes) -> None:
        """Add a report, which includes other relays."""
        from lcmtools.graph.relay_report import decode_report

        report = decode_report(payload)
        for link in report.links if report else ():
            first, last = self._found.get(link.id, (link, link))
            self._found[link.id] = first, link if link.number > last.number else last

    def ends(self) -> tuple[RelayEnd, ...]:
        """Return both ends of each relay that has not left."""
        found = []
        for first, last in self._found.values():
            for was, end in zip(first.ends, last.ends, strict=True):
                known = last.name, last.host, end.bus, end.trouble, end.dropped - was.dropped
                if last.state.name != "LEFT":
                    stands_by = last.state.name == "STANDBY"
                    found.append(RelayEnd(*known, end.commands, stands_by, last.id))
        return tuple(found)
