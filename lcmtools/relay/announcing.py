"""Converting announcements of nodes on one bus for the other bus. Pure.

They get the names that their topics have there, lose the topics that do not pass, and carry their
path, so that no program takes their processes for ones on the other bus. Programs that announce
nothing are told of by what is heard of them.
"""

import heapq
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import chain
from operator import attrgetter

from lcmtools.bounded import BoundedDict
from lcmtools.graph.builder import MOST_NODES
from lcmtools.graph.model import STALE_AFTER, Endpoint, Graph, RelayStep, Role, Traffic
from lcmtools.graph.protocol import MOST_OBSERVED, Announcement
from lcmtools.messages.registry import candidates
from lcmtools.observe.reports.describe import Computers
from lcmtools.observe.simulators import is_simulator
from lcmtools.relay.rules import Direction, Reason, Route
from lcmtools.wire.packet import Sender

_MOST_STEPS = 16
_MOST_NODE_BYTES = 2 << 20  # of the announcements that are kept
_RECENT = 10_000_000_000  # [ns] since its last message that a program is told of
_YOUNG = 100_000_000  # [ns] after its first one
_OF_SERVICES = (Role.SERVICE, Role.CLIENT)


class Announced:
    """The nodes of one bus, as announced on the other.

    ``step`` is the relay and the bus that the nodes are on; ``onward`` and ``back`` are the rules
    for messages from their bus and to it. With ``one_way`` messages pass in one direction only.
    """

    def __init__(
        self, step: RelayStep, onward: Direction, back: Direction, *, one_way: bool
    ) -> None:
        self._step, self._onward, self._back = step, onward, back
        self._one_way = one_way
        self._kept = BoundedDict[str, tuple[Announcement, int]](MOST_NODES, _MOST_NODE_BYTES)

    def convert(self, announcement: Announcement, size: int, now: int) -> Announcement | None:
        """Return an announcement of a size [byte] as it must be passed on; None if it must not.

        ``now`` is the time of any monotonic clock [ns].
        """
        node = announcement.node
        if len(node.path) >= _MOST_STEPS or any(step.id == self._step.id for step in node.path):
            return None
        obeyed = is_simulator(node)
        ends = [end for one in node.endpoints if (end := self._endpoint(one, obeyed=obeyed))]
        name = self._onward.name(node.name)
        if isinstance(name, Reason):
            name = node.name
        if node.endpoints and not ends and node.id not in self._kept:
            return None
        path = (self._step, *node.path)
        passed = announcement._replace(
            node=node._replace(
                name=name,
                endpoints=tuple(ends),
                observed=renamed(node.observed, self._onward),
                path=path,
                ports=(),
            )
        )
        if announcement.leaving:
            self._kept.pop(node.id, None)
        else:
            self._kept.put(node.id, (passed._replace(answers=0), now), size)
        return passed

    def recent(self, now: int) -> list[Announcement]:
        """Return the latest converted announcements of nodes that are not silent.

        Each tells how long it was kept, so that clocks can be compared by it.
        """
        while self._kept and now - self._kept.oldest()[1] > STALE_AFTER:
            self._kept.drop_oldest()
        return [_kept_for(now - time, one) for one, time in self._kept.values()]

    def target(self, name: str) -> str | None:
        """Return an announced node's name on its own bus; None for others."""
        known = (one.node for one, _ in self._kept.values())
        if not any(node.name == name for node in known):
            return None
        own = self._back.name(name)
        return name if isinstance(own, Reason) else own

    def _endpoint(self, end: Endpoint, *, obeyed: bool) -> Endpoint | None:
        name: str | Reason
        if end.role in _OF_SERVICES:
            if self._one_way or self._onward.route(end.topic, ()).reason:
                return None
            name = self._onward.name(end.topic)
        elif end.role is Role.PUBLISHER:
            name = self._onward.route(end.topic, end.types).name
        else:
            name = self._name_of_subscription(end, partial(self._back.route, obeyed=obeyed))
        return None if isinstance(name, Reason) or not name else end._replace(topic=name)

    def _name_of_subscription(self, end: Endpoint, route: Callable[..., Route]) -> str:
        """Return the topic on the other bus whose messages reach a subscription."""
        name = self._onward.name(end.topic)
        return "" if isinstance(name, Reason) or route(name, end.types).reason else name


def heard_of_programs(graph: Graph, bus: str = "") -> Iterator[Traffic]:
    """Yield the recent messages of programs that are not nodes, the newest first, up to a bound.

    Senders have the names of their computers. Those of a new sender are left out for a moment, in
    which a node announces itself. ``bus`` is the name of their bus, if they are told on another.
    """
    own = (seen for seen in graph.foreign() if not seen.observer)
    known = (seen for seen in own if not is_young(seen, graph.time))
    recent = (seen for seen in known if graph.time - seen.last_time < _RECENT)
    computers = Computers(graph.nodes)
    for seen in heapq.nlargest(MOST_OBSERVED, recent, key=attrgetter("last_time")):
        sender = seen.sender and Sender(computers.of_traffic(seen), seen.sender.port)
        yield seen._replace(sender=sender, bus=bus)


def is_young(seen: Traffic, now: int) -> bool:
    """Return whether the sender may be a node that has not announced itself yet."""
    return now - seen.first_time <= _YOUNG


def renamed(observed: Iterable[Traffic], onward: Direction) -> tuple[Traffic, ...]:
    """Return what passes of programs' messages, with the names of the channels on the other bus."""
    routes = ((seen, onward.route(seen.channel, possible_types(seen))) for seen in observed)
    return tuple(seen._replace(channel=route.name) for seen, route in routes if not route.reason)


def possible_types(seen: Traffic) -> set[str]:
    """Return the types that messages may have: attached to them, or from their fingerprints."""
    return {*seen.types, *chain.from_iterable(map(candidates, seen.fingerprints))}


def _kept_for(age: int, announcement: Announcement) -> Announcement:
    last, *others = announcement.node.path
    path = (last._replace(kept=age), *others)
    return announcement._replace(node=announcement.node._replace(path=path))
