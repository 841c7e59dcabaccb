"""The index beside a log, as lines of JSON: what the log has, and what its format cannot say.

Sans-I/O. The log itself stays as LCM's own programs write and read it. The index is appended to
while a log is recorded, a line at a time, so that one that was cut off is right as far as it goes;
events behind its last block are found by reading the log from there. Lines, by their one key:

    index      the version of this form
    sender     a sender's number in this file, its address and port, its name
    type       a message type: its name, its fingerprint, and its .lcm file's path and text
    node       an announcement of a node, as it was sent, with its time and sender
    block      events one after another: where they begin and end, their times, and for each
               channel the number of messages and bytes, and the senders in order
    losses     messages lost until then, by the sender's number
    end        the log was closed, and has so many bytes
"""

import json
from base64 import b64decode, b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from lcmtools.wire.packet import Sender

VERSION = 1
SUFFIX = ".index"
"""The index of ``ride.lcmlog`` is ``ride.lcmlog.index``."""


@dataclass(slots=True)
class ChannelCount:
    """The messages of a channel within some bytes of a log."""

    messages: int = 0
    bytes: int = 0  # of payloads
    # The senders' numbers in order, each with the number of its messages one after another; -1
    # for a sender that is not known.
    senders: list[list[int]] = field(default_factory=list)

    def add(self, size: int, sender: int = -1) -> None:
        """Count one message more."""
        self.messages += 1
        self.bytes += size
        if self.senders and self.senders[-1][0] == sender:
            self.senders[-1][1] += 1
        else:
            self.senders.append([sender, 1])


@dataclass(slots=True)
class Block:
    """Events one after another."""

    start: int  # of the first, in bytes of the file
    end: int = 0
    first_time: int = 0  # the earliest [ns since 1970]
    last_time: int = 0  # the latest
    channels: dict[str, ChannelCount] = field(default_factory=dict)

    def add(self, channel: str, time: int, size: int, sender: int = -1) -> None:
        """Count one event more; ``size`` is its payload's."""
        if not self.channels:
            self.first_time = self.last_time = time
        elif time > self.last_time:
            self.last_time = time
        elif time < self.first_time:
            self.first_time = time
        count = self.channels.get(channel)
        if count is None:
            count = self.channels[channel] = ChannelCount()
        count.add(size, sender)


@dataclass(frozen=True, slots=True)
class RecordedSender:
    """A sender as the recorder saw it."""

    sender: Sender | None  # None where the bus names none
    name: str  # of its node, else of its process, else its address


@dataclass(frozen=True, slots=True)
class RecordedType:
    """A message type that a log has messages of."""

    name: str  # "geometry_msgs/Twist"
    fingerprint: int
    path: str  # of its .lcm file, from the folder of types on
    source: str  # the file's text


@dataclass(frozen=True, slots=True)
class RecordedNode:
    """An announcement of a node."""

    time: int  # [ns since 1970]
    sender: int  # its sender's number, -1 where that is not known
    payload: bytes


@dataclass(slots=True)
class LogIndex:
    """What an index says of its log."""

    blocks: list[Block] = field(default_factory=list)
    senders: dict[int, RecordedSender] = field(default_factory=dict)
    types: dict[str, RecordedType] = field(default_factory=dict)
    nodes: list[RecordedNode] = field(default_factory=list)
    losses: dict[int, int] = field(default_factory=dict)  # messages, by the sender's number
    size: int | None = None  # of the closed log, in bytes; None for one that was not closed

    @property
    def end(self) -> int:
        """Bytes of the log that the blocks cover."""
        return self.blocks[-1].end if self.blocks else 0


def index_line() -> str:
    """Return the first line of an index."""
    return _line("index", VERSION)


def sender_line(number: int, sender: RecordedSender) -> str:
    """Return the line of a sender; a later one with the same number takes its place."""
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
    counts = {name: [c.messages, c.bytes, c.senders] for name, c in block.channels.items()}
    return _line("block", [block.start, block.end, block.first_time, block.last_time, counts])


def losses_line(losses: Mapping[int, int]) -> str:
    """Return the line of the losses until now."""
    return _line("losses", {str(number): lost for number, lost in losses.items()})


def end_line(size: int) -> str:
    """Return the last line of a log that was closed with so many bytes."""
    return _line("end", size)


def parse_index(lines: Iterable[str]) -> LogIndex | None:
    """Return what the lines say; None if they are no index. One that is damaged ends it."""
    known, rows = LogIndex(), _rows(lines)
    if next(rows, None) != ("index", VERSION):
        return None
    with suppress(ValueError, TypeError, LookupError, AttributeError):
        for key, value in rows:
            _take(known, key, value)
    return known


def _rows(lines: Iterable[str]) -> Iterator[tuple[str, Any]]:
    for line in lines:
        try:
            row = json.loads(line)
        except ValueError:
            return
        if not (isinstance(row, dict) and len(row) == 1):
            return
        yield next(iter(row.items()))


def _take(index: LogIndex, key: str, value: Any) -> None:  # noqa: ANN401 - as JSON has it
    if key == "block":
        index.blocks.append(_block(value))
    elif key == "sender":
        number, at, name = value
        sender = Sender(str(at[0]), int(at[1])) if at else None
        index.senders[int(number)] = RecordedSender(sender, str(name))
    elif key == "type":
        name, digits, path, source = value
        index.types[name] = RecordedType(name, int(digits, 16), str(path), str(source))
    elif key == "node":
        time, number, text = value
        index.nodes.append(RecordedNode(int(time), int(number), b64decode(text)))
    elif key == "losses":
        index.losses = {int(number): int(lost) for number, lost in value.items()}
    elif key == "end":
        index.size = int(value)


def _block(value: Sequence[Any]) -> Block:
    start, end, first, last, counts = value
    channels = {
        str(name): ChannelCount(int(messages), int(size), [[int(a), int(b)] for a, b in senders])
        for name, (messages, size, senders) in counts.items()
    }
    return Block(int(start), int(end), int(first), int(last), channels)


def _line(key: str, value: object) -> str:
    return json.dumps({key: value}, separators=(",", ":")) + "\n"
