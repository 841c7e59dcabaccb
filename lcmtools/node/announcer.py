"""Announcing a process's nodes on the bus: each second, on a change, and on a probe."""

import contextlib
import math
import random
import threading
import time
from collections.abc import Callable, Mapping

from lcmtools.bus.base import Bus, Faults, start_thread
from lcmtools.errors import BusError
from lcmtools.graph import protocol
from lcmtools.graph.model import Endpoint, Node
from lcmtools.graph.protocol import ANSWER_SPREAD, PERIOD

_CHANGE_DELAY = 0.005  # [s]: a node that is being set up changes many times at once
_SHARE = 0.9  # of a period, after which the counters for the rates are replaced
_REST = 10  # rest for this many times the CPU time of announcing, which takes a tenth at most

_Counted = tuple[int, dict[object, Endpoint]]
"""Endpoints by their nodes and keys, and when they were counted [ns since 1970]."""


class Announcer:
    """Announces nodes from its own thread, so that a busy node stays visible.

    ``describe`` returns the current description of every node of this process.
    """

    def __init__(self, bus: Bus, describe: Callable[[], list[Node]]) -> None:
        self._bus = bus
        self._describe = describe
        self._faults = Faults(bus.on_outage)
        self._changed = threading.Condition()
        self._due = time.monotonic() + _CHANGE_DELAY
        self._rested = 0.0
        self._answer_due = math.inf
        self._owed: dict[str, int] = {}  # nonces of probes by their targets, "" for all nodes
        self._owes_another = False
        self._answers_from = 0.0  # a probe of one node is answered at once
        self._is_behind = True
        self._names: set[str] = set()  # of the nodes as last announced
        self._closed = False
        self._sending = threading.Lock()
        # the endpoints as they were one or two periods ago, to compute their rates
        self._before: _Counted = (0, {})
        self._latest: _Counted = (0, {})
        self._next_count = 0.0
        bus.subscribe(protocol.PROBE_CHANNEL, self._receive_probe)
        self._thread = start_thread(self._run, "announcer")

    def announce_soon(self) -> None:
        """Announce all nodes in a moment, because one has changed; return at once.

        If announcing takes long, as for hundreds of endpoints, the next change waits longer.
        """
        with self._changed:
            self._is_behind = True
            self._due = min(self._due, time.monotonic() + _CHANGE_DELAY)
            self._changed.notify()

    def announce_changes(self) -> None:
        """Announce all nodes now if one has changed, ahead of any message that is sent next.

        A simulator must know the subscriptions before it is asked to step.
        """
        with self._sending:
            if self._is_behind:
                self._send_all({"": 0})

    def say_goodbye(self, node: Node) -> None:
        """Announce for the last time that a node exists, and that it ends."""
        with self._sending:
            self._send(protocol.Announcement(node, leaving=True))

    def answer(self, target: str, nonce: int) -> None:
        """Announce the node of this name at once, repeating ``nonce``."""
        self._announce({target: nonce})

    def leave_to_parent(self) -> None:
        """Announce nothing in a forked process, where the thread may have held these locks."""
        self._changed, self._sending = threading.Condition(), threading.Lock()

    def close(self) -> None:
        """Stop announcing."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join(timeout=1.0)

    def _receive_probe(self, payload: bytes, _time: int) -> None:
        """Answer a probe: at once for one node, spread a little for all.

        Many probes of one node soon after each other get one answer, with the last one's nonce.
        """
        probe = protocol.decode_probe(payload)
        if probe is None:
            return
        answer = now = time.monotonic()
        if not probe.target:
            answer += random.uniform(0, ANSWER_SPREAD)  # noqa: S311
        elif not (self._is_behind or probe.target in self._names):
            return
        elif now >= self._answers_from:
            self.answer(probe.target, probe.nonce)
            return
        else:
            answer = self._answers_from
        with self._changed:
            # a second probe is sent in case an answer is lost: it gets an answer of its own
            self._owes_another |= not probe.target and "" in self._owed
            self._owed[probe.target] = probe.nonce or self._owed.get(probe.target, 0)
            self._answer_due = min(self._answer_due, answer)
            self._changed.notify()

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._closed and (left := self._left()) > 0:
                    self._changed.wait(left)
                if self._closed:
                    return
                owed, began = self._owed, time.monotonic()
                if began >= max(self._due, self._rested):
                    owed.setdefault("", 0)
                if "" in owed:
                    self._due = began + PERIOD
                self._owed = {"": 0} if self._owes_another else {}
                self._answer_due = began + ANSWER_SPREAD if self._owes_another else math.inf
                self._owes_another = False
            try:
                self._announce(owed)
            except Exception as error:  # noqa: BLE001 - a node must not vanish for good
                self._faults.note("announcing", error)

    def _left(self) -> float:
        """Return the time until the next announcement [s]."""
        return min(self._answer_due, max(self._due, self._rested)) - time.monotonic()

    def _announce(self, owed: Mapping[str, int]) -> None:
        """Announce the nodes of these names, "" for all, each with a nonce; then rest."""
        began, work_began = time.monotonic(), time.thread_time()
        with self._sending:
            self._send_all(owed)
        worked = time.thread_time() - work_began  # on a busy computer no node seems large
        rested = min(time.monotonic() + _REST * worked, began + PERIOD)
        if "" in owed:
            self._rested = rested
        else:
            self._answers_from = max(rested, began + ANSWER_SPREAD)

    def _send_all(self, owed: Mapping[str, int]) -> None:
        # called with the lock held, so that no node is announced again after its goodbye
        if "" in owed:
            self._is_behind = False  # before describing: a change from now on sets it again
        nodes = self._describe()
        self._names = {node.name for node in nodes}
        for node in nodes:
            if (nonce := owed.get(node.name, owed.get(""))) is not None:
                self._send(protocol.Announcement(self._with_rates(node), answers=nonce))
        if (now := time.monotonic()) >= self._next_count:
            self._before, self._next_count = self._latest, now + _SHARE * PERIOD
            counted: dict[object, Endpoint] = {
                (node.id, end.key): end for node in nodes for end in node.endpoints
            }
            self._latest = time.time_ns(), counted

    def _with_rates(self, node: Node) -> Node:
        """Return a node with the rates of its endpoints over the last one or two periods."""
        ends = (end._replace(rate=self._rate((node.id, end.key), end)) for end in node.endpoints)
        return node._replace(endpoints=tuple(ends))

    def _rate(self, key: object, end: Endpoint) -> float:
        """Return the rate of an endpoint's messages; 0 if there were none, or not all the time."""
        for counted_at, counted in (self._before, self._latest):
            if was := counted.get(key):
                is_steady = end.is_steady_since(was, counted_at, round(PERIOD * 1e9))
                return (is_steady and end.rate_since(was)) or 0.0
        return 0.0

    def _send(self, announcement: protocol.Announcement) -> None:
        # a lost announcement is made up for by the next, a second later; a closing bus takes none
        payload = protocol.encode_announcement(announcement.sent_at(time.time_ns()))
        with contextlib.suppress(BusError):
            self._bus.publish(protocol.NODE_CHANNEL, payload)
