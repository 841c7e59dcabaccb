"""The counters of endpoints, and the rates of their messages, as ``info`` shows them.

A rate needs two looks: nodes are asked again after a moment, and how far they have counted in
between, and when, gives the rate, however short the moment is.
"""

import time
from collections.abc import Sequence

from lcmtools.graph.model import Endpoint, Graph, Node, Topic, Traffic
from lcmtools.names import Resolver
from lcmtools.observe.describe import callback_record, callback_times
from lcmtools.observe.find import GLOBAL, find_topic
from lcmtools.observe.losses import Loss, Losses, losses, total
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.rates import average_rate, counted_rate
from lcmtools.observe.settled import settled

_LONGEST = 0.5  # [s] that rates are measured
_ENOUGH = 4  # messages on each topic, to end sooner
_AWAKENING = 0.3  # [s] that publishers have for a first message


class Counters:
    """The counters of endpoints, by two looks at a bus.

    Args:
        before: The first look.
        after: The second one.
        lost: The loss of each sender.
    """

    def __init__(self, before: Graph, after: Graph, lost: Losses | None = None) -> None:
        self._now = after.time
        self._lost = lost or {}
        self._before = {_key(n, e): e for n in before.nodes for e in n.endpoints}

    def of_endpoint(self, node: Node, endpoint: Endpoint) -> str:
        """An endpoint's counters in a line."""
        parts = [f"messages: {endpoint.messages}", f"bytes: {endpoint.bytes}"]
        parts += [f"drops: {endpoint.drops}"]
        parts += [f"depth: {endpoint.depth}"] if endpoint.depth else []
        measured, average = self._measured(node, endpoint), average_rate(node, endpoint)
        if measured is not None:
            parts.append(f"rate: {measured:.2f} Hz")
        elif average is not None:
            parts.append(f"rate: {average:.2g} Hz on average since its start")
        took = callback_times(endpoint)
        return ", ".join(
            [
                *parts,
                self._last(endpoint.last_time, node.time_there(self._now)),
                *([took] if took else []),
            ]
        )

    def of_program(self, seen: Traffic) -> str:
        """Return what was seen of a program that is no node, in a line."""
        parts = [f"seen messages: {seen.messages}", f"bytes: {seen.bytes}"]
        rate = seen.rate()
        parts += [f"rate: {rate:.2f} Hz"] if rate is not None else []
        return ", ".join([*parts, self._last(seen.last_time, self._now)])

    def record(self, node: Node, endpoint: Endpoint) -> dict[str, object]:
        """An endpoint and its counters, for JSON."""
        return {
            "node": node.name,
            "host": node.host,
            "address": node.sender.address if node.sender else None,
            "pid": node.pid,
            "stale": bool(node.stale),
            "types": list(endpoint.types),
            "depth": endpoint.depth,
            "messages": endpoint.messages,
            "bytes": endpoint.bytes,
            "drops": endpoint.drops,
            "rate": self._measured(node, endpoint),
            "average_rate": average_rate(node, endpoint),
            "last_time": endpoint.last_time or None,
            **callback_record(endpoint),
        }

    def _measured(self, node: Node, endpoint: Endpoint) -> float | None:
        before = self._before.get(_key(node, endpoint))
        return counted_rate(before, endpoint) if before else None

    def lost_of(self, node: Node) -> Loss | None:
        """Return the loss of a node's messages, of all its topics."""
        return total(node.senders(), self._lost)

    def lost_of_program(self, seen: Traffic) -> Loss | None:
        """Return the loss of a program that is no node."""
        return total([seen.sender], self._lost)

    @staticmethod
    def _last(last: int, now: int) -> str:
        return f"last: {max(0.0, (now - last) / 1e9):.1f} s ago" if last else "last: never"


def counted(
    monitor: BusMonitor, words: Sequence[str], wait: float | None, names: Resolver = GLOBAL
) -> tuple[Graph, Counters]:
    """A bus's graph, and the counters of the endpoints in it.

    Args:
        monitor: The bus.
        words: The topics, as typed.
        wait: How long to count [s]; None for as long as it takes, half a second at most.
        names: The namespace and the remaps that they are read by.

    Raises:
        LcmtoolsError: A topic is not on the bus; with what may have been meant.
    """
    monitor.listen_to([spelling for name in words for spelling in names.spellings(name)])
    graph = settled(monitor)
    topics = [find_topic(graph, name, names) for name in words]
    if monitor.is_log or not any(map(_may_be_counted, topics)):
        return graph, Counters(graph, graph)
    channels = [topic.name for topic in topics]
    # some publish only what somebody listens to: the first messages may be a moment away
    came = _listen(monitor, channels, _AWAKENING, 1)
    before = monitor.settle(foreign=False)
    if came or wait is not None:
        _listen(monitor, channels, _LONGEST if wait is None else wait, _enough(wait))
    after = monitor.settle(foreign=False)
    return after, Counters(before, after, losses(monitor.numbered))


def _enough(wait: float | None) -> int | None:
    return _ENOUGH if wait is None else None


def _listen(
    monitor: BusMonitor, channels: Sequence[str], longest: float, enough: int | None
) -> dict[str, int]:
    """Count messages until there are enough on each channel; give the channels that had any."""
    counts: dict[str, int] = {}
    deadline = time.monotonic() + longest
    while (left := deadline - time.monotonic()) > 0:
        for packet in monitor.receive(left):
            if packet.channel in channels:
                counts[packet.channel] = counts.get(packet.channel, 0) + 1
        if enough is not None and all(counts.get(channel, 0) >= enough for channel in channels):
            break
    return counts


def _may_be_counted(topic: Topic) -> bool:
    """Return whether there is a publisher."""
    return bool(topic.traffic) or any(not node.stale for node, _ in topic.publishers)


def _key(node: Node, endpoint: Endpoint) -> tuple[str, str, int, str, tuple[str, ...]]:
    return node.id, endpoint.topic, endpoint.role, endpoint.group, endpoint.types
