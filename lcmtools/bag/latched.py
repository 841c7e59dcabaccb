"""Messages that were latched when a part of a log begins: maps, static transforms, descriptions.

A log tells what was latched by the announcements of nodes in it; one of lcm-logger without any does
not.
"""

from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from operator import itemgetter

from lcmtools.bag.edits import between
from lcmtools.bag.summary import span_of
from lcmtools.bag.times import LogTime, time_window
from lcmtools.graph.protocol import decode_announcement, head_of
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.wire.packet import Packet


class LatchedTopics:
    """The latched topics at each time of a log, learned from the announcements of nodes."""

    def __init__(self, announcements: Iterable[Packet] = ()) -> None:
        self._said: list[tuple[int, str, frozenset[str]]] = []  # time [ns], node's id, topics
        self._revisions: dict[bytes, bytes] = {}
        for packet in announcements:
            self.add(packet)

    @property
    def is_known(self) -> bool:
        """False if the log has no node's announcement."""
        return bool(self._said)

    def add(self, packet: Packet) -> None:
        """Add an announcement."""
        identity, revision = head_of(packet.payload)
        if self._revisions.get(identity) == revision:
            return
        self._revisions[identity] = revision
        if said := decode_announcement(packet.payload):
            ends = () if said.leaving else said.node.endpoints
            topics = frozenset(end.topic for end in ends if end.latched)
            self._said.append((packet.time, said.node.id, topics))

    def at(self, time: int) -> frozenset[str]:
        """Return the topics that were latched at a time [ns since 1970]."""
        said = sorted(self._said, key=itemgetter(0))
        now = {node: topics for when, node, topics in said if when <= time}
        return frozenset().union(*now.values())

    def ever(self) -> frozenset[str]:
        """Return all topics that were latched at some time."""
        return frozenset().union(*(topics for _, _, topics in self._said))


def untold(path: object) -> str:
    """Return a sentence on a log that does not tell what was latched."""
    return f"{path} does not tell what was latched; what came once before the start is missing"


def part_of(
    log: LogFile,
    start: LogTime | None,
    end: LogTime | None,
    *,
    duration: float | None = None,
    notify: Callable[[str], None] = lambda _: None,
) -> tuple[tuple[int, int] | None, Iterator[Packet]]:
    """Return the times of a part of a log [ns since 1970], None for all of it, and its messages.

    What was latched when it begins comes first, with the time of its begin.

    Raises:
        UsageError: Nothing of the log lies between the times.
    """
    if not (start or end or duration is not None):
        return None, log.packets()
    latched = LatchedTopics(log.announcements())
    blocks = list(log.blocks(latched.add))
    span = span_of(blocks)
    first, last = time_window(span, start, end, duration=duration)
    found = between(log.packets(log.offset_at(first)), first, last)
    if first > span[0]:
        if not latched.is_known:
            notify(untold(log.path))
        held = log.latest(latched.at(first), first, blocks)
        found = chain((one._replace(time=first) for one in held), found)
    return (first, last), found
