"""Converting announcements of nodes on one bus for the other bus. Pure.

They get the names that their topics have there, lose the topics that do not pass, and carry their
path, so that no program takes their processes for ones on the other bus.
"""

from collections.abc import Callable
from functools import partial

from lcmtools.graph.model import STALE_AFTER, Endpoint, RelayStep, Role
from lcmtools.graph.protocol import Announcement
from lcmtools.observe.simulators import is_simulator
from lcmtools.relay.rules import Direction, Reason, Route

_MOST_STEPS = 16
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
        self._kept: dict[str, tuple[Announcement, int]] = {}

    def convert(self, announcement: Announcement, now: int) -> Announcement | None:
        """Return an announcement as it must be passed on; None if it must not.

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
            node=node._replace(name=name, endpoints=tuple(ends), path=path, ports=())
        )
        if announcement.leaving:
            self._kept.pop(node.id, None)
        else:
            self._kept[node.id] = passed._replace(answers=0), now
        return passed

    def recent(self, now: int) -> list[Announcement]:
        """Return the latest converted announcements of nodes that are not silent."""
        return [kept for kept, time in self._kept.values() if now - time <= STALE_AFTER]

    def forget(self) -> None:
        """Forget all, because another relay passes them on now."""
        self._kept.clear()

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
