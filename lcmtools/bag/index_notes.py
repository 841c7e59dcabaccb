"""A recorder's notes for the index of each of its files.

A worker looks up names of processes and files of types, so that reading goes on.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import suppress
from pathlib import PurePath
from time import monotonic
from zlib import crc32

from lcmtools.bag.writer import LogWriter
from lcmtools.bounded import BoundedDict
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.builder import MOST_FINGERPRINTS, MOST_FLOWS, MOST_NODES
from lcmtools.graph.model import Graph, NodeInfo, Role
from lcmtools.graph.protocol import decode_announcement, head_of
from lcmtools.messages.enums import EnumType, enum_name
from lcmtools.messages.fields import fields, parts
from lcmtools.messages.registry import Message, fingerprint, type_name, versions
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.losses import Loss, Losses
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.packages.user_types import read_source, source_file
from lcmtools.wire.log_index import LostMessages, RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender


def recorded_types(packets: Iterable[Packet], decoder: Decoder) -> list[RecordedType]:
    """Return the types of messages and of their fields, as far as known here."""
    known: dict[type[Message], None] = {}
    for packet in packets:
        with suppress(LcmtoolsError):  # an unknown type does no harm to the log
            known.update(dict.fromkeys(parts(decoder.message_class(packet))))
    found: list[RecordedType] = []
    for kind in known:
        with suppress(LcmtoolsError):  # its file does not exist here
            found += _recorded(kind)
    return list(dict.fromkeys(found))


def _recorded(kind: type[Message]) -> Iterator[RecordedType]:
    """Yield a type, and the enums of its fields."""
    place = PurePath()
    if any(len(versions(type_name(one))) > 1 for one in parts(kind)):
        folder = str(PurePath(source_file(kind)).parent).encode()
        place = PurePath(f"{crc32(folder):08x}")  # beside its parts
    own = type_name(kind), fingerprint(kind), source_file(kind)
    enums = [part.type.cls for part in fields(kind) if isinstance(part.type, EnumType)]
    named = [(enum_name(one), one.__hash_number__, one.__file__) for one in enums]
    for name, number, file in (own, *named):
        path = place / name.rpartition("/")[0] / PurePath(file).name
        yield RecordedType(name, number, str(path), read_source(file, name) + "\n")


_AGAIN = 5.0  # [s] until a sender without a name is looked up again
_NOTE_PERIOD = 2.0  # [s] between records of sent messages if none are lost
_FINGERPRINT_BYTES = 8
_MOST_KEPT_BYTES = 64 << 20  # of the last messages of latched topics
_MOST_NODE_BYTES = 2 << 20  # of announcements: a thousand nodes
_MOST_UNKNOWN, _MOST_NEW = 1000, 4000
"""Channels whose types are looked up at a time, and those with types that are new."""


class IndexNotes:
    """The notes of one recording; ``worker``, with one thread, does slow look-ups."""

    def __init__(self, monitor: BusMonitor, worker: Executor) -> None:
        self._monitor, self._worker = monitor, worker
        # The losses since the beginning by sender's name, for senders with losses.
        self.losses: Mapping[str, Loss] = {}
        self._names = SenderNames()
        self._announced: dict[str, tuple[str, ...]] = {}  # the types of channels in a look-up
        self._decoder = Decoder(lambda channel: self._announced[channel])
        # Senders' numbers and names in the current file.
        self._numbers = BoundedDict[Sender | None, int](MOST_FLOWS)
        self._named = BoundedDict[Sender, str](MOST_FLOWS)
        # The last announcement of each node by its id, and the nodes that have ended.
        self._nodes = BoundedDict[str, Packet](MOST_NODES, _MOST_NODE_BYTES)
        self._left = BoundedDict[str, NodeInfo](MOST_NODES, _MOST_NODE_BYTES)
        self._revisions = BoundedDict[bytes, bytes](MOST_NODES, _MOST_NODE_BYTES)
        self._types: dict[tuple[str, int], RecordedType] = {}
        # The fingerprints that have occurred, on each channel and in all.
        self._seen = BoundedDict[str, tuple[bytes, ...]](MOST_FLOWS)
        self._known = BoundedDict[bytes, bool](MOST_FLOWS)
        self._unknown: list[Packet] = []
        self._latched: frozenset[str] = frozenset()
        # The last message of each sender on each latched topic.
        self._held = BoundedDict[tuple[str, Sender | None], Packet](MOST_FLOWS, _MOST_KEPT_BYTES)
        self._missed: set[tuple[str, Sender | None]] = set()
        self._lookup: Future[list[RecordedType]] | None = None
        self._next_lookup = 0.0
        self._noted: Losses = {}  # losses recorded in the file's index
        self._lost = BoundedDict[Sender, Loss](MOST_FLOWS)  # since the beginning
        self._next_note = 0.0
        self._last_time = 0  # of the latest added message [ns since 1970], which reveals a loss

    def begin(self, writer: LogWriter, *, is_split: bool = False, time: int = 0) -> None:
        """Begin a file with the current types and nodes, and messages that were latched before.

        These get the time of the begin [ns since 1970].
        """
        self._numbers.clear()
        writer.add_types(self._types.values())
        for packet in self._nodes.values():
            self._add_node(packet, writer)
        if is_split:
            self._noted = self._monitor.losses()
        self._missed.clear()
        held = [packet for packet in self._held.values() if packet.channel in self._latched]
        self.add([packet._replace(time=time) for packet in held], writer)

    def hold(self, packets: Iterable[Packet]) -> None:
        """Keep latched messages for the begin of the next file."""
        for packet in packets:
            if packet.channel in self._latched:
                self._held.put((packet.channel, packet.sender), packet, len(packet.payload))

    def miss(self, packets: Sequence[Packet]) -> None:
        """Keep latched messages that come in a pause, for the next messages that are added."""
        self.hold(packets)
        self._missed |= {
            (one.channel, one.sender) for one in packets if one.channel in self._latched
        }

    def add(self, packets: Sequence[Packet], writer: LogWriter) -> None:
        """Add messages to a file, with their senders."""
        if self._missed and packets:
            held = [self._held.get(key) for key in self._missed]
            late = sorted((one for one in held if one), key=lambda one: one.time)
            packets = [*(one._replace(time=packets[0].time) for one in late), *packets]
            self._missed.clear()
        numbers, seen, latched, add = self._numbers, self._seen, self._latched, writer.add
        for packet in packets:
            number = numbers.use(packet.sender)
            if number is None:
                number = self._number(packet.sender, writer)
            head = packet.payload[:_FINGERPRINT_BYTES]
            heads = seen.use(packet.channel) or ()
            if head not in heads and len(heads) < MOST_FINGERPRINTS:
                seen[packet.channel] = (*heads, head)
                self._note_unknown(packet._replace(payload=head))
            if latched and packet.channel in latched:
                self._held.put((packet.channel, packet.sender), packet, len(packet.payload))
            add(packet, number)
            self._last_time = packet.time

    def add_announcement(self, packet: Packet, writer: LogWriter | None) -> bool:
        """Keep an announcement; return whether it differs from the node's last one."""
        identity, revision = head_of(packet.payload)
        if self._revisions.use(identity) == revision:
            return False
        self._revisions.put(identity, revision, len(identity) + len(revision))
        announcement = decode_announcement(packet.payload)
        if announcement is None:
            return False
        size, node = len(packet.payload), announcement.node
        if announcement.leaving and not node.path:  # else the packet's sender is a relay
            named = node._replace(sender=packet.sender, endpoints=(), errors=(), command="")
            self._left.put(node.id, named, len(node.name) + len(node.host))
            self._next_lookup = 0.0
        if node.tool and not any(end.role is Role.PUBLISHER for end in node.endpoints):
            return True  # it only observes, as this recorder does
        if announcement.leaving:
            self._nodes.pop(node.id, None)
        else:
            self._nodes.put(node.id, packet, size)
        if writer is not None:
            self._add_node(packet, writer)
        return True

    def _note_unknown(self, packet: Packet) -> None:
        """Note a message whose type is to be looked up; if there are many, one of each type."""
        is_known, count = self._known.use(packet.payload), len(self._unknown)
        self._known[packet.payload] = True
        if count < (_MOST_UNKNOWN if is_known else _MOST_NEW):
            self._unknown.append(packet)
            self._next_lookup = 0.0

    def update(self, graph: Graph) -> None:
        """Update the latched topics from a changed graph."""
        self._latched = frozenset(topic.name for topic in graph.topics() if topic.is_latched)
        self._next_lookup = 0.0

    def annotate(self, writer: LogWriter, *, in_full: bool = False) -> None:
        """Add the names, types and losses known by now; all of them if ``in_full``."""
        if self._lookup is None and (in_full or monotonic() >= self._next_lookup):
            self._begin_lookup()
        if self._lookup is not None and (in_full or self._lookup.done()):
            self._end_lookup(self._lookup, writer)
            if in_full and self._unknown:
                self.annotate(writer, in_full=True)
                return
        self._note_losses(writer, in_full=in_full)

    def _note_losses(self, writer: LogWriter, *, in_full: bool) -> None:
        """Add the losses since the last note, if there is news; update the totals."""
        found, numbers = self._monitor.losses(), self._numbers
        counts: dict[int, tuple[int, int]] = {}
        for sender, loss in found.items():
            before = self._noted.get(sender, Loss())
            number = numbers.get(sender)
            if number is not None and loss != before:
                counts[number] = loss.lost - before.lost, loss.sent - before.sent
        now, is_news = monotonic(), any(lost for lost, _ in counts.values())
        if counts and (in_full or is_news or now >= self._next_note):
            self._next_note = now + _NOTE_PERIOD
            self._noted = {one: loss for one, loss in found.items() if one in numbers}
            writer.add_lost(LostMessages(self._last_time // 1000 * 1000, counts))
        for sender, loss in found.items():
            if loss.lost and sender in self._named:
                self._lost[sender] = loss
        total: dict[str, Loss] = {}
        for sender, loss in self._lost.items():
            name = self._named.get(sender) or str(sender)
            total[name] = total.get(name, Loss()) + loss
        self.losses = total

    def _number(self, sender: Sender | None, writer: LogWriter) -> int:
        if sender is None:
            return -1
        name = self._named[sender] = self._names.name(sender)
        number = self._numbers[sender] = writer.sender_number(sender, name)
        self._next_lookup = 0.0
        return number

    def _add_node(self, packet: Packet, writer: LogWriter) -> None:
        number = self._numbers.use(packet.sender)
        if number is None:
            number = self._number(packet.sender, writer)
        writer.add_node(RecordedNode(packet.time, number, packet.payload))

    def _begin_lookup(self) -> None:
        self._next_lookup = monotonic() + _AGAIN
        packets, self._unknown = self._unknown, []
        types_of = self._monitor.types_of
        self._announced = {packet.channel: types_of(packet.channel) for packet in packets}
        nodes = (*self._left.values(), *self._monitor.graph().nodes)
        self._lookup = self._worker.submit(self._identify, list(self._numbers), nodes, packets)

    def _end_lookup(self, lookup: "Future[list[RecordedType]]", writer: LogWriter) -> None:
        self._lookup = None
        self._types.update(((one.name, one.fingerprint), one) for one in lookup.result())
        writer.add_types(self._types.values())
        for sender, number in self._numbers.items():
            name = self._names.name(sender)
            if sender is not None and name != self._named.get(sender):
                self._named[sender] = name  # later files have the name from the beginning
                writer.rename_sender(number, sender, name)

    def _identify(
        self, senders: list[Sender | None], nodes: tuple[NodeInfo, ...], packets: list[Packet]
    ) -> list[RecordedType]:
        """Return the types of packets, and learn the names of senders; on the worker's thread."""
        self._names.update(senders, nodes)
        return recorded_types(packets, self._decoder)
