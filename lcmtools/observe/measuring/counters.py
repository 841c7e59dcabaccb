"""Rates and durations from the counters that nodes announce: arithmetic on two samples.

A rate that a node does not announce is computed from two samples of its counters and their times,
however short the time between them is.
"""

from collections.abc import Mapping

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.observe.reading.losses import Loss, Losses, total
from lcmtools.observe.reports.describe import behind_json, endpoint_types
from lcmtools.observe.simulators import is_simulator, pause_text

_SHORTEST = 200_000_000  # [ns] at least between two samples that tell how busy a node is
_TEN, _THOUSAND = 9.95, 999.5  # what rounds to 10 and 1000


def average_rate(node: NodeInfo, endpoint: Endpoint) -> float | None:
    """Return the rate of an endpoint's messages from its node's start to the last one [Hz].

    None before two messages, or if the times contradict each other.
    """
    span = endpoint.last_time - node.start_time
    if endpoint.messages < 2 or span <= 0:  # noqa: PLR2004 - an interval
        return None
    return endpoint.messages * 1e9 / span


def fair_average(node: NodeInfo, endpoint: Endpoint) -> float | None:
    """Return ``average_rate``; None for a publisher of a simulator, which is idle at times."""
    return None if _pauses(node, endpoint) else average_rate(node, endpoint)


def _pauses(node: NodeInfo, endpoint: Endpoint) -> bool:
    """Return whether a publisher sends only while something subscribes."""
    return endpoint.role is Role.PUBLISHER and is_simulator(node)


def callback_time(earlier: Endpoint, later: Endpoint) -> float | None:
    """Return the average duration of a call between two announcements [ns].

    A call that is still running counts by its time so far. None if there was no call.
    """
    calls, busy = later.calls - earlier.calls, later.busy - earlier.busy
    if calls < 0 or busy <= 0:
        return None
    mean, overall = busy / max(1, calls), later.busy / max(1, later.calls)
    # the first and the last call may be only partly between the two: if the average of all calls
    # is consistent with them, it is more accurate
    fits = calls and busy / (calls + 1) <= overall <= busy / max(1, calls - 1)
    return overall if fits else mean


def busy_share(earlier: NodeInfo, later: NodeInfo) -> float | None:
    """Return the part of the time between two announcements spent in callbacks, 1 at most.

    None if the announcements are too close together, or have no time of sending.
    """
    span, spent = later.sent - earlier.sent, later.busy - earlier.busy
    if not earlier.sent or span < _SHORTEST or spent < 0:
        return None
    return min(1.0, spent / span)


def duration_text(nanoseconds: float) -> str:
    """Return a time for people: "0.012 ms", "1.2 ms", "250 ms", "2.5 s"."""
    for value, unit in ((nanoseconds / 1e6, "ms"), (nanoseconds / 1e9, "s")):
        if value < _TEN:
            return f"{value:.2g} {unit}"
        if value < _THOUSAND:
            return f"{value:.0f} {unit}"
    return f"{nanoseconds / 1e9:.0f} s"


def callback_times(endpoint: Endpoint) -> str:
    """Return "callbacks: 1.2 ms mean, 30 ms longest"; "" before the first call."""
    if not endpoint.calls:
        return ""
    mean = duration_text(endpoint.busy / endpoint.calls)
    return f"callbacks: {mean} mean, {duration_text(endpoint.longest)} longest"


def callback_json(endpoint: Endpoint) -> dict[str, object]:
    """Return the same for JSON, in nanoseconds; None where its program does not count."""
    calls = {
        "callbacks": endpoint.calls,
        "callback_time": endpoint.busy,
        "longest_callback": endpoint.longest,
    }
    is_known = endpoint.is_counted or endpoint.role in (Role.SERVICE, Role.CLIENT)
    return {name: number if is_known else None for name, number in calls.items()}


UNCOUNTED = "messages: not known (its program does not count them)"


def counted(endpoint: Endpoint) -> dict[str, int | None]:
    """Return an endpoint's counts for JSON; None where its program does not count."""
    counts = {
        "messages": endpoint.messages,
        "bytes": endpoint.bytes,
        "drops": endpoint.drops,
        "incomplete": endpoint.incomplete,
    }
    return {name: number if endpoint.is_counted else None for name, number in counts.items()}


class Counters:
    """The counters of endpoints from two samples of a bus, and the loss of each sender."""

    def __init__(self, before: Graph, after: Graph, lost: Losses | None = None) -> None:
        self._now, self._graph = after.time, after
        self._lost = lost or {}
        self._before: Mapping[object, Endpoint] = {
            (n.id, e.key): e for n in before.nodes for e in n.endpoints
        }

    def of_endpoint(self, node: NodeInfo, endpoint: Endpoint) -> str:
        """Return an endpoint's counters as one line.

        An announcer in a plain LCM program counts nothing; its messages are what was seen.
        """
        if not endpoint.messages and (seen := self._seen(node, endpoint)):
            return self.of_program(seen)
        if not endpoint.is_counted:
            return UNCOUNTED
        parts = [f"messages: {endpoint.messages}", f"bytes: {endpoint.bytes}"]
        parts += [f"drops: {endpoint.drops}"]
        parts += [f"incomplete: {endpoint.incomplete}"] if endpoint.incomplete else []
        parts += [f"depth: {endpoint.depth}"] if endpoint.depth else []
        measured, average = self.rate(node, endpoint), fair_average(node, endpoint)
        if measured is not None:
            parts.append(f"rate: {measured:.2f} Hz")
        elif average is not None:
            parts.append(f"rate: {average:.2g} Hz on average since its start")
        elif self._is_idle(node, endpoint):
            idle = "idle: it publishes only while something subscribes"
            parts.append(pause_text(self._graph) or idle)
        parts.append(_last(endpoint.last_time, node.time_there(self._now)))
        return ", ".join(filter(None, [*parts, callback_times(endpoint)]))

    def of_program(self, seen: Traffic) -> str:
        """Return the observed traffic of a program that is not a node, as one line."""
        rate = seen.rate()
        rates = [] if rate is None else [f"rate: {rate:.2f} Hz"]
        counts = [f"seen messages: {seen.messages}", f"bytes: {seen.bytes}"]
        return ", ".join([*counts, *rates, _last(seen.last_time, self._now)])

    def to_json(self, node: NodeInfo, endpoint: Endpoint) -> dict[str, object]:
        """Return an endpoint and its counters, for JSON."""
        return {
            "node": node.name,
            "host": node.host,
            "address": node.sender.address if node.sender else None,
            "pid": node.pid,
            "stale": bool(node.stale),
            **behind_json(node),
            "types": endpoint_types(endpoint),
            "depth": endpoint.depth,
            **counted(endpoint),
            "rate": self.rate(node, endpoint),
            "average_rate": fair_average(node, endpoint),
            "last_time": endpoint.last_time or None,
            **callback_json(endpoint),
        }

    def rate(self, node: NodeInfo, endpoint: Endpoint) -> float | None:
        """Return the rate of an endpoint's messages now [Hz]; None if it is unknown."""
        before = self._before.get((node.id, endpoint.key))
        measured = endpoint.rate_since(before) if before else None
        # what an idle publisher announces is of the moment when it stopped
        return measured or (None if self._is_idle(node, endpoint) else endpoint.rate) or None

    def lost(self, sender: NodeInfo | Traffic) -> Loss | None:
        """Return the loss of a node or a program, over all its topics; None if unknown."""
        senders = sender.senders() if isinstance(sender, NodeInfo) else [sender.sender]
        return total(senders, self._lost)

    def _seen(self, node: NodeInfo, endpoint: Endpoint) -> Traffic | None:
        own = node.senders() if endpoint.role is Role.PUBLISHER else ()
        on_topic = (seen for seen in self._graph.traffic if seen.channel == endpoint.topic)
        return next((seen for seen in on_topic if seen.sender in own), None)

    def _is_idle(self, node: NodeInfo, endpoint: Endpoint) -> bool:
        """Return whether a publisher waits for a subscriber."""
        if node.is_recorded or not _pauses(node, endpoint):
            return False
        return all(one.stale for one, _ in self._graph.topic(endpoint.topic).subscribers)


def _last(last: int, now: int) -> str:
    return f"last: {max(0.0, (now - last) / 1e9):.1f} s ago" if last else "last: never"
