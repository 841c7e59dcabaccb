"""The index beside a log, as lines of JSON: its content, and facts its format cannot express.

Sans-I/O. The log itself stays as LCM's own programs write and read it. While a log is recorded,
lines are appended to its index, so that an index that was cut off is correct as far as it goes;
events after its last block are found by reading the log.

Later versions may add keys, and values at the end of a line's list; a reader ignores those that it
does not know. Nothing else of a line changes. Lines, by their single key:

    index      the version of this format, greater by one with each addition
    sender     a sender's number in this file, its address and port, its name
    type       a message type: its name, its fingerprint, and its .lcm file's path and text
    node       a node's announcement as sent, with its time and sender
    block      events one after another: where they begin and end, their times, and for each
               channel the number of messages and bytes, the senders in order, the times of the
               first and the last message and the longest gap, and the first one's fingerprint;
               then, if their times go back, the most by which they do
    lost       a time, and for each sender's number the messages lost and sent since the line
               before; the number lost is negative if a late message closed a gap
    end        the log was closed; its size in bytes
"""

import json
from base64 import b64decode, b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, NamedTuple

from lcmtools.wire.log_events import HEAD_BYTES
from lcmtools.wire.packet import Packet, Sender

VERSION = 1
SUFFIX = ".index"
"""The index of ``ride.lcmlog`` is ``ride.lcmlog.index``."""


_MOST = (1 << 64) - 1
_LATEST = 1000 << 63
"""The largest time of an event [ns], which the log has in microseconds."""
_BLOCK_BYTES = 8 << 20  # a block ends after this many bytes ...
_BLOCK_TIME = 2_000_000_000  # ... or this much time in the log [ns] ...
_BLOCK_SHARE = 256  # ... but not before it has this part (1/256) of all bytes before it


@dataclass(slots=True)
class ChannelCount:
    """The messages of a channel in a range of a log; times are nanoseconds since 1970."""

    messages: int = 0
    bytes: int = 0  # of payloads
    # The senders' numbers in order, each with the number of its consecutive messages; -1 for an
    # unknown sender.
    senders: list[list[int]] = field(default_factory=list)
    first_time: int = 0  # the earliest
    last_time: int = 0  # the latest
    longest_gap: int = 0  # longest time without a message, between the first and the last [ns]
    fingerprint: int | None = None  # of the first message; None if it has none

    def add(self, time: int, size: int, sender: int = -1) -> None:
        """Count another message, not the first one."""
        self.messages += 1
        self.bytes += size
        if self.senders[-1][0] == sender:
            self.senders[-1][1] += 1
        else:
            self.senders.append([sender, 1])
        if time > self.last_time:
            self.longest_gap = max(self.longest_gap, time - self.last_time)
            self.last_time = time
        elif time < self.first_time:
            self.first_time = time


@dataclass(slots=True)
class Block:
    """A range of consecutive events."""

    start: int  # offset of the first event in the file [byte]
    end: int = 0
    first_time: int = 0  # the earliest [ns since 1970]
    last_time: int = 0  # the latest
    channels: dict[str, ChannelCount] = field(default_factory=dict)
    back: int = 0  # the most by which an event is earlier than one before it [ns]

    def add(self, packet: Packet, sender: int = -1) -> None:
        """Count another event; the head of its payload is enough (``Packet.whole_bytes``)."""
        channel, _, received, _, _, whole = packet[:6]
        time = received // 1000 * 1000  # in microseconds, as in the log
        size = len(packet[1]) if whole is None else whole
        if not self.channels:
            self.first_time = self.last_time = time
        elif time >= self.last_time:
            self.last_time = time
        else:
            self.back = max(self.back, self.last_time - time)
            self.first_time = min(self.first_time, time)
        count = self.channels.get(channel)
        if count is not None:
            count.add(time, size, sender)
            return
        self.channels[channel] = ChannelCount(
            1, size, [[sender, 1]], time, time, fingerprint=packet.fingerprint
        )

    @property
    def event_bytes(self) -> int:
        """The bytes of all events."""
        return sum(
            one.bytes + one.messages * (HEAD_BYTES + len(name.encode("utf-8", "surrogateescape")))
            for name, one in self.channels.items()
        )

    def is_full(self, end: int) -> bool:
        """Return whether a block of these events, up to this byte, is long enough."""
        size = end - self.start
        is_long = self.last_time - self.first_time >= _BLOCK_TIME
        is_long = is_long and size >= self.start // _BLOCK_SHARE
        most = max(_BLOCK_BYTES, self.start // _BLOCK_SHARE)
        return bool(self.channels) and (is_long or size >= most)


@dataclass(frozen=True, slots=True)
class RecordedSender:
    """A sender as the recorder saw it."""

    sender: Sender | None  # None if the bus does not identify it
    name: str  # its node's, else its process's, else its address


@dataclass(frozen=True, slots=True)
class RecordedType:
    """A message type of messages in a log."""

    name: str  # "geometry_msgs/Twist"
    fingerprint: int
    path: str  # of its .lcm file, relative to the folder of types
    source: str  # the file's text


@dataclass(frozen=True, slots=True)
class RecordedNode:
    """An announcement of a node."""

    time: int  # [ns since 1970]
    sender: int  # its sender's number, -1 if unknown
    payload: bytes


class LostMessages(NamedTuple):
    """The messages lost and sent since the previous record, by the sender's number."""

    time: int  # [ns since 1970]
    counts: Mapping[int, tuple[int, int]]


@dataclass(slots=True)
class LogIndex:
    """The content of an index."""

    blocks: list[Block] = field(default_factory=list)
    senders: dict[int, RecordedSender] = field(default_factory=dict)
    # By name; another version of a type by its name and fingerprint: "rover/state_t@0x1234...".
    types: dict[str, RecordedType] = field(default_factory=dict)
    nodes: list[RecordedNode] = field(default_factory=list)
    lost: list[LostMessages] = field(default_factory=list)
    size: int | None = None  # of a closed log [byte]; None if it was not closed

    @property
    def end(self) -> int:
        """The number of bytes of the log that the blocks cover."""
        return self.blocks[-1].end if self.blocks else 0


def index_line() -> str:
    """Return the first line of an index."""
    return _line("index", VERSION)


def sender_line(number: int, sender: RecordedSender) -> str:
    """Return the line of a sender; a later line with the same number replaces it."""
    at = [sender.sender.address, sender.sender.port] if sender.sender else None
    return _line("sender", [number, at, sender.name])


def type_line(one: RecordedType) -> str:
    """Return the line of a message type."""
    return _line("type", [one.name, f"{one.fingerprint:#018x}", one.path, one.source])


def node_line(node: RecordedNode) -> str:
    """Return the line of an announcement."""
    return _line("node", [node.time, node.sender, b64encode(node.payload).decode("ascii")])


def block_line(block: Block) -> str:
    """Return the line of a block."""
    start = block.first_time
    counts = {
        name: [
            *(one.messages, one.bytes, one.senders),
            *(one.first_time - start, one.last_time - start, one.longest_gap, one.fingerprint),
        ]
        for name, one in block.channels.items()
    }
    back = [block.back] if block.back else []
    return _line("block", [block.start, block.end, start, block.last_time, counts, *back])


def lost_line(lost: LostMessages) -> str:
    """Return the line of lost messages."""
    return _line("lost", [lost.time, {str(number): one for number, one in lost.counts.items()}])


def end_line(size: int) -> str:
    """Return the last line, for a log that was closed with this size in bytes."""
    return _line("end", size)


def parse_index(lines: Iterable[str]) -> LogIndex | None:
    """Return the content of an index of any version; None if it is none. A damaged line ends it."""
    known, rows = LogIndex(), _rows(lines)
    key, version = next(rows, ("", 0))
    if key != "index" or not isinstance(version, int):
        return None
    with suppress(ValueError, TypeError, LookupError, AttributeError):
        for key, value in rows:
            _add_row(known, key, value)
    return known


def _number(value: object, least: int = 0, most: int = _MOST) -> int:
    """Return a whole number; ValueError if it is another value, or one that no log has."""
    if type(value) is not int or not least <= value <= most:
        raise ValueError(value)
    return value


def _time(value: object) -> int:
    return _number(value, -_LATEST, _LATEST)


def _text(value: object) -> str:
    """Return a text; ValueError for surrogates that do not stand for a byte."""
    text = str(value)
    text.encode("utf-8", "surrogateescape")
    return text


def _rows(lines: Iterable[str]) -> Iterator[tuple[str, Any]]:
    for line in lines:
        try:
            row = json.loads(line)
        except (ValueError, RecursionError):  # nested too deeply
            return
        if not (isinstance(row, dict) and len(row) == 1):
            return
        yield next(iter(row.items()))


def _add_row(index: LogIndex, key: str, value: Any) -> None:  # noqa: ANN401 - any value of JSON
    if key == "block":
        block = _block(value)
        if block.start < index.end:
            raise ValueError("blocks follow each other")
        index.blocks.append(block)
    elif key == "sender":
        number, at, name, *_ = value
        sender = Sender(_text(at[0]), _number(at[1])) if at else None
        index.senders[_number(number, -1)] = RecordedSender(sender, _text(name))
    elif key == "type":
        name, digits, path, source, *_ = value
        one = RecordedType(_text(name), _number(int(digits, 16)), _text(path), _text(source))
        is_new = index.types.get(name, one).fingerprint == one.fingerprint
        index.types[name if is_new else f"{name}@{digits}"] = one
    elif key == "node":
        time, number, text, *_ = value
        index.nodes.append(RecordedNode(_time(time), _number(number, -1), b64decode(text)))
    elif key == "lost":
        time, counts, *_ = value
        found = {int(n): (_number(a, -_MOST), _number(b)) for n, (a, b, *_) in counts.items()}
        index.lost.append(LostMessages(_time(time), found))
    elif key == "end":
        index.size = _number(value)


def _block(value: Sequence[Any]) -> Block:
    start, end, first, last, counts, *back = value
    channels = {name: _count(_time(first), count[:7]) for name, count in counts.items()}
    block = Block(_number(start), _number(end), _time(first), _time(last), channels)
    block.back = _number(back[0], most=_LATEST) if back else 0
    if block.event_bytes > block.end - block.start:
        raise ValueError("more events than there is place for")
    return block


def _count(first: int, values: Sequence[Any]) -> ChannelCount:
    """Return the count of a channel in a block, checked at the speed of long indexes."""
    messages, size, senders, begin, stop, gap, number = values
    numbers = (messages, size, begin, stop, gap, *chain.from_iterable(senders))
    if {*map(type, numbers)} != {int} or not -_LATEST <= min(numbers) <= max(numbers) <= _LATEST:
        raise ValueError("not whole numbers")
    runs = senders[0][1] if len(senders) == 1 else sum(run for _, run in senders)
    if runs != messages or min(messages - 1, size, gap) < 0:
        raise ValueError("each message has a sender")
    if number is not None:
        _number(number)
    return ChannelCount(messages, size, senders, first + begin, first + stop, gap, number)


def disorder(blocks: Iterable[Block]) -> int:
    """Return the most by which an event is earlier than one before it [ns]; 0 if in order."""
    found, latest = 0, None
    for block in blocks:
        found = max(found, block.back, 0 if latest is None else latest - block.first_time)
        latest = block.last_time if latest is None else max(latest, block.last_time)
    return found


def _line(key: str, value: object) -> str:
    return json.dumps({key: value}, separators=(",", ":")) + "\n"
