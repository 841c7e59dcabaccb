"""A recorder's notes for the index of each of its files.

A worker looks up names of processes and files of types, so that reading goes on.
"""

import time
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor, Future

from lcmtools.bag.recorded_types import recorded_types
from lcmtools.bag.writer import LogWriter
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.graph.protocol import decode_announcement, head_of
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.losses import Loss, Losses
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.wire.log_index import LostMessages, RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender

_AGAIN = 5.0  # [s] until a sender without a name is looked up again
_NOTE_PERIOD = 2.0  # [s] between records of sent messages if none are lost
_FINGERPRINT_BYTES = 8


class IndexNotes:
    """The notes of one recording; ``worker``, with one thread, does slow look-ups."""

    def __init__(self, monitor: BusMonitor, worker: Executor) -> None:
        self._monitor, self._worker = monitor, worker
        # The losses since the beginning by sender's name, for senders with losses.
        self.losses: Mapping[str, Loss] = {}
        self._names = SenderNames()
        self._announced: dict[str, tuple[str, ...]] = {}
        self._decoder = Decoder(self._announced.__getitem__)
        self._numbers: dict[Sender | None, int] = {}  # senders' numbers in the current file
        self._named: dict[Sender, str] = {}  # senders' names in the current file
        self._nodes: dict[str, Packet] = {}  # the last announcement of each node by its id
        self._left: dict[str, Node] = {}  # the nodes that have ended, by id
        self._revisions: dict[bytes, bytes] = {}
        self._types: dict[tuple[str, int], RecordedType] = {}
        self._seen: set[tuple[str, bytes]] = set()  # channels and fingerprints that have occurred
        self._unknown: list[Packet] = []
        self._latched: frozenset[str] = frozenset()
        self._held: dict[str, Packet] = {}  # the last message of each latched topic
        self._lookup: Future[list[RecordedType]] | None = None
        self._next_lookup = 0.0
        self._noted: Losses = {}  # losses recorded in the file's index
        self._next_note = 0.0
        self._last_time = 0  # of the latest added message [ns since 1970], which reveals a loss

    def begin(self, writer: LogWriter, *, is_split: bool = False) -> None:
        """Begin a file with the current types and nodes and, after a split, latched messages."""
        self._numbers = {}
        writer.add_types(self._types.values())
        for packet in self._nodes.values():
            self._add_node(packet, writer)
        if is_split:
            self._noted = self._monitor.losses()
            held = [packet for packet in self._held.values() if packet.channel in self._latched]
            now = time.time_ns()
            self.add([packet._replace(time=now) for packet in held], writer)

    def add(self, packets: Iterable[Packet], writer: LogWriter) -> None:
        """Add messages to a file, with their senders."""
        numbers, seen, latched, add = self._numbers, self._seen, self._latched, writer.add
        for packet in packets:
            number = numbers.get(packet.sender)
            if number is None:
                number = self._number(packet.sender, writer)
            key = packet.channel, packet.payload[:_FINGERPRINT_BYTES]
            if key not in seen:
                seen.add(key)
                self._unknown.append(packet._replace(payload=key[1]))
                self._next_lookup = 0.0
            if latched and packet.channel in latched:
                self._held[packet.channel] = packet
            add(packet, number)
            self._last_time = packet.time

    def add_announcement(self, packet: Packet, writer: LogWriter | None) -> bool:
        """Keep an announcement; return whether it differs from the node's last one."""
        identity, revision = head_of(packet.payload)
        if self._revisions.get(identity) == revision:
            return False
        self._revisions[identity] = revision
        announcement = decode_announcement(packet.payload)
        if announcement is None:
            return False
        if announcement.leaving:
            self._left[announcement.node.id] = announcement.node._replace(sender=packet.sender)
            self._next_lookup = 0.0
        ends = announcement.node.endpoints
        if announcement.node.tool and not any(end.role is Role.PUBLISHER for end in ends):
            return True  # it only observes, as this recorder does
        if announcement.leaving:
            self._nodes.pop(announcement.node.id, None)
        else:
            self._nodes[announcement.node.id] = packet
        if writer is not None:
            self._add_node(packet, writer)
        return True

    def update(self, graph: Graph) -> None:
        """Update the latched topics from a changed graph."""
        self._latched = frozenset(topic.name for topic in graph.topics() if topic.is_latched)
        self._next_lookup = 0.0

    def annotate(self, writer: LogWriter, *, in_full: bool = False) -> None:
        """Add the names, types and losses known by now; all of them if ``in_full``."""
        if self._lookup is None and (in_full or time.monotonic() >= self._next_lookup):
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
            if sender in numbers and loss != before:
                counts[numbers[sender]] = loss.lost - before.lost, loss.sent - before.sent
        now, is_news = time.monotonic(), any(lost for lost, _ in counts.values())
        if counts and (in_full or is_news or now >= self._next_note):
            self._next_note = now + _NOTE_PERIOD
            self._noted = {**self._noted, **{one: found[one] for one in found if one in numbers}}
            writer.add_lost(LostMessages(self._last_time // 1000 * 1000, counts))
        total: dict[str, Loss] = {}
        for sender, loss in found.items():
            if loss.lost and sender in self._named:
                name = self._named[sender]
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
        number = self._numbers.get(packet.sender)
        if number is None:
            number = self._number(packet.sender, writer)
        writer.add_node(RecordedNode(packet.time, number, packet.payload))

    def _begin_lookup(self) -> None:
        self._next_lookup = time.monotonic() + _AGAIN
        packets, self._unknown = self._unknown, []
        for packet in packets:
            self._announced[packet.channel] = self._monitor.types_of(packet.channel)
        nodes = (*self._left.values(), *self._monitor.graph().nodes)
        self._lookup = self._worker.submit(self._identify, list(self._numbers), nodes, packets)

    def _end_lookup(self, lookup: "Future[list[RecordedType]]", writer: LogWriter) -> None:
        self._lookup = None
        self._types.update(((one.name, one.fingerprint), one) for one in lookup.result())
        writer.add_types(self._types.values())
        for sender, number in self._numbers.items():
            name = self._names.name(sender)
            if sender is not None and name != self._named[sender]:
                self._named[sender] = name  # later files have the name from the beginning
                writer.rename_sender(number, sender, name)

    def _identify(
        self, senders: list[Sender | None], nodes: tuple[Node, ...], packets: list[Packet]
    ) -> list[RecordedType]:
        """Return the types of packets, and learn the names of senders; on the worker's thread."""
        self._names.update(senders, nodes)
        return recorded_types(packets, self._decoder)
