"""Rates that a slow line takes of the topics whose messages are dropped for it. Pure."""

from collections import deque
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from lcmtools.graph.model import Endpoint, FullLine, Role

_WINDOW = 5.0  # [s]
_LEAST = 1.0  # [s]
_MOST = 10  # topics


class _Counts(NamedTuple):
    time: float  # [s]
    passed: Mapping[str, int]
    dropped: Mapping[str, int]


class LineRates:
    """The rates of the last seconds, from the counts of messages of each channel."""

    def __init__(self) -> None:
        self._known: deque[_Counts] = deque()

    def update(
        self, passed: Mapping[str, int], dropped: Mapping[str, int], now: float
    ) -> dict[str, float]:
        """Add the counts of now, a time of any monotonic clock [s].

        Returns the channels that lost messages in the last seconds, those that lost the most first,
        and how many of their messages passed in a second.
        """
        latest = _Counts(now, dict(passed), dict(dropped))
        self._known.append(latest)
        while len(self._known) > 2 and now - self._known[1].time >= _WINDOW:  # noqa: PLR2004
            self._known.popleft()
        first = self._known[0]
        if now - first.time < _LEAST:
            return {}
        lost = {name: number - first.dropped.get(name, 0) for name, number in dropped.items()}
        names = sorted((name for name in lost if lost[name] > 0), key=lambda name: -lost[name])
        return {name: _rate(first, latest, name) for name in names[:_MOST]}


class NodeLines:
    """The full line of a node, as far as it concerns what the node itself publishes."""

    def __init__(self) -> None:
        self._rates = LineRates()

    def update(
        self, endpoints: Iterable[Endpoint], unsent: tuple[str, Mapping[str, int]], now: float
    ) -> tuple[FullLine, ...]:
        """Return the line, if it is full now, a time of any monotonic clock [s].

        ``unsent`` is its other end, and the number of messages of each channel not sent so far.
        """
        to, counts = unsent
        if not (to and counts):
            self._rates = LineRates()  # what is sent while nobody is connected did not pass
            return ()
        sent = {x.topic: x.messages for x in endpoints if x.role is Role.PUBLISHER}
        dropped = {topic: counts.get(topic, 0) for topic in sent}
        passed = {topic: messages - dropped[topic] for topic, messages in sent.items()}
        rates = self._rates.update(passed, dropped, now)
        line = FullLine(to, sum(dropped.values()), tuple(rates.items()))
        return (line,) if rates else ()


def _rate(first: _Counts, last: _Counts, name: str) -> float:
    passed = last.passed.get(name, 0) - first.passed.get(name, 0)
    return max(0.0, passed / (last.time - first.time))
