"""The stream of the tree of frames: each frame below its parent, its age, and who publishes it."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from lcmtools.errors import DecodeError
from lcmtools.gui.frames import FrameStore, Link
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update, Waiting
from lcmtools.messages.registry import type_name
from lcmtools.observe.channels.activity import SILENT_AFTER
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet

_MOST_WAITING = 5000  # messages between two updates


class Place(NamedTuple):
    """The place of a frame in the tree."""

    frame: str
    depth: int
    is_looped: bool  # no root leads to it: it is in a loop, or below one


Links = Mapping[str, Mapping[str, Link]]  # by child and parent


def current_parents(links: Links) -> dict[str, list[str]]:
    """Return the parents of each frame, the latest first; old ones only if there are no others."""
    found = {}
    for child, parents in links.items():
        latest = max(link.time for link in parents.values())
        present = [one for one, link in parents.items() if latest - link.time < SILENT_AFTER]
        found[child] = sorted(present, key=lambda one: -parents[one].time)
    return found


def ordered(parents: Mapping[str, Sequence[str]]) -> Iterator[Place]:
    """Yield each frame below its parent; a loop begins with its first frame."""
    children = defaultdict(list)
    for child in sorted(parents, reverse=True):
        children[parents[child][0]].append(child)
    roots = sorted(children.keys() - parents.keys())
    seen = set[str]()
    for start in (*roots, *sorted(parents)):
        waiting = [(start, 0)]
        while waiting:
            frame, depth = waiting.pop()
            if frame not in seen:
                seen.add(frame)
                yield Place(frame, depth, start in parents)
                waiting += [(child, depth + 1) for child in children.get(frame, ())]


def loop_of(frame: str, parents: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the frames of the loop that a frame is in, from it to itself; none without one."""
    path = [frame]
    while path[-1] in parents:
        path.append(parents[path[-1]][0])
        if path[-1] == frame:
            return path
        if len(path) > len(parents) + 1:  # a loop above it
            break
    return []


class FrameTree(PageStream):
    """The frames of all topics of tf2_msgs/TFMessage as a tree.

    Lines are a frame, its depth, its age [s], publisher and topic, and what is wrong with it.
    """

    period = 0.5
    is_shared = True

    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self._waiting = Waiting(_MOST_WAITING)
        self._followed: set[str] = set()
        self._store = FrameStore()
        self._names = SenderNames()
        self._mistake = ""

    def update(self) -> Update:
        """Return the present tree."""
        latest = self.source.latest
        for row in latest.rows:
            if type_name(TFMessage) in row.types and row.channel not in self._followed:
                self._followed.add(row.channel)
                self.until_closed(self.source.follow(row.channel, self._waiting.add))
        packets, _ = self._waiting.pop()
        for packet in packets:
            self._add(packet)
        senders = {link.sender for links in self._store.links.values() for link in links.values()}
        self._names.update(senders, latest.graph.nodes)
        parents = current_parents(self._store.links)
        lines = list(ordered(parents))
        roots = [one.frame for one in lines if not one.depth]
        about = f"{len(roots)} trees that nothing connects: {', '.join(roots)}" if roots[1:] else ""
        return Update({"about": about, "lines": [self._line(one, parents) for one in lines]})

    def problem(self) -> str:
        """Return which transform is ignored, or that there is none."""
        none = "" if self._followed else "no topic has transforms (tf2_msgs/TFMessage)"
        return self._mistake or none

    def _add(self, packet: Packet) -> None:
        try:
            message = self.source.decode(packet)
        except DecodeError as error:
            self._mistake = f"{packet.channel}: {error}"
            return
        if isinstance(message, TFMessage):
            ignored = self._store.add(message, packet.time, packet.channel, packet.sender)
            self._mistake = f"{packet.channel}: {ignored}" if ignored else self._mistake

    def _line(self, place: Place, parents: Mapping[str, Sequence[str]]) -> Json:
        frame, depth, is_looped = place
        if frame not in parents:
            return [frame, depth, None, "", "", ""]
        graph, (parent, *others) = self.source.latest.graph, parents[frame]
        link = self._store.links[frame][parent]
        age = max(0, graph.time - link.time)
        faults = [
            f"also in {one}, by {self._name(self._store.links[frame][one])}" for one in others
        ]
        if is_looped and (loop := loop_of(frame, parents)):
            faults.append(f"a loop: {' in '.join(loop)}")
        if link.is_old(graph.time) and not graph.topic(link.topic).is_latched:
            faults.append("old")
        return [frame, depth, round(age / 1e9, 1), self._name(link), link.topic, "; ".join(faults)]

    def _name(self, link: Link) -> str:
        known = self.source.latest.row(link.topic).senders
        return self._names.name(link.sender) if link.sender or not known else ", ".join(known)
