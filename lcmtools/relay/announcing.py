"""Announcements of nodes on one bus, as they are passed on to the other. Pure.

They get the names that their topics have there, without the topics that do not pass, and the path
that they have come, so that nobody takes their process for one of the other bus.
"""

from collections.abc import Callable
from functools import partial

from lcmtools.graph.model import STALE_AFTER, Endpoint, RelayStep, Role
from lcmtools.graph.protocol import Announcement
from lcmtools.observe.actuators import is_simulator
from lcmtools.relay.rules import Direction, Reason, Route

_MOST_STEPS = 16
_OF_SERVICES = (Role.SERVICE, Role.CLIENT)


class Announced:
    """The nodes of one bus as they are announced on the other.

    ``step`` is the relay, and the bus that the nodes are on; ``onward`` and ``back`` are the rules
    for messages from their bus and to it. With ``one_way`` they go in one direction only.
    """

    def __init__(
        self, step: RelayStep, onward: Direction, back: Direction, *, one_way: bool
    ) -> None:
        self._step, self._onward, self._back = step, onward, back
        self._one_way = one_way
        self._kept: dict[str, tuple[Announcement, int]] = {}

    def take(self, said: Announcement, now: int) -> Announcement | None:
        """Return an announcement as it is to be passed on; None if it is not.

        ``now`` is in nanoseconds of any clock that only goes forward.
        """
        node = said.node
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
        passed = said._replace(
            node=node._replace(name=name, endpoints=tuple(ends), path=path, ports=())
        )
        if said.leaving:
            self._kept.pop(node.id, None)
        else:
            self._kept[node.id] = passed._replace(answers=0), now
        return passed

    def recent(self, now: int) -> list[Announcement]:
        """Return those of nodes that are not silent, as they were passed on last."""
        return [kept for kept, time in self._kept.values() if now - time <= STALE_AFTER]

    def forget(self) -> None:
        """Forget all: another relay passes them on now."""
        self._kept.clear()

    def target(self, name: str) -> str | None:
        """Return the name on its own bus of a node that is announced; None for others."""
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
        """The topic on the other bus whose messages come to a subscription."""
        name = self._onward.name(end.topic)
        return "" if isinstance(name, Reason) or route(name, end.types).reason else name
