"""The publishers in earlier looks of ``wtf --watch``. Evidence in, evidence out."""

from collections import deque
from dataclasses import replace
from itertools import pairwise

from lcmtools.doctor.evidence import Evidence, Publication
from lcmtools.names import is_hidden
from lcmtools.wire.packet import Sender

_KEPT, _LATEST = 200, 20  # times of arrival
_ENOUGH, _SPAN = 5, 900_000_000  # times, and their span [ns], that are enough for a rate
_UNKNOWN = 60.0  # [s] to remember a sender of unknown process

_Key = tuple[str, Sender | None]


class Memory:
    """The publishers of earlier looks, with their fastest rates."""

    def __init__(self) -> None:
        self._times: dict[_Key, deque[int]] = {}
        self._known: dict[_Key, Publication] = {}

    def count(self) -> int:
        """Return the number of remembered publishers, those of unknown rate included."""
        return len(self._known.keys() | self._times.keys())

    def recall(self, evidence: Evidence) -> Evidence:
        """Return the evidence with the publishers of earlier looks that have not ended."""
        running = {process.pid for process in evidence.processes}
        running |= {listener.pid for listener in evidence.listeners if listener.pid}
        running |= {node.pid for node in evidence.own_nodes() if not node.stale}
        nodes = {node.name for node in evidence.graph.nodes if not node.stale}
        ended = {(one.channel, one.sender) for one in evidence.streams if one.has_ended}

        def is_there(one: Publication) -> bool:
            age = (evidence.graph.time - one.last_time) / 1e9
            is_known = one.pid in running if one.pid else one.name in nodes or age < _UNKNOWN
            return is_known and (one.topic, one.sender) not in ended

        self._known = {key: one for key, one in self._known.items() if is_there(one)}
        now = evidence.graph.time
        self._times = {
            key: times
            for key, times in self._times.items()
            if key not in ended and (key in self._known or now - times[-1] < _UNKNOWN * 1e9)
        }
        return replace(evidence, remembered=tuple(self._known.values()))

    def remember(self, evidence: Evidence) -> None:
        """Remember the publishers of a look."""
        for stream in evidence.streams:
            if is_hidden(stream.channel) or stream.has_ended:
                continue
            if not stream.times:
                continue
            key = stream.channel, stream.sender
            times = self._times.setdefault(key, deque(maxlen=_KEPT))
            times.extend(stream.times[-_KEPT:])
            span = times[-1] - times[0]
            if len(times) >= _ENOUGH and span >= _SPAN:
                before = self._known[key].rate if key in self._known else 0.0
                rate = max(before, (len(times) - 1) * 1e9 / span)
                gap = max(b - a for a, b in pairwise(list(times)[-_LATEST:])) / 1e9
                self._known[key] = Publication(*key, stream.name, stream.pid, rate, gap, times[-1])
