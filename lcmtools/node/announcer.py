"""Announcing a process's nodes on the bus: each second, on a change, and on a probe."""

import contextlib
import math
import random
import threading
import time
from collections.abc import Callable

from lcmtools.bus.base import Bus
from lcmtools.errors import BusError
from lcmtools.graph import protocol
from lcmtools.graph.model import Endpoint, Node
from lcmtools.graph.protocol import ANSWER_SPREAD, PERIOD

_CHANGE_DELAY = 0.005  # [s]: a node that is being set up changes many times at once
_SHARE = 0.9  # of a period, after which the counters for the rates are replaced
_REST = 10  # rest for this many times the CPU time of announcing, which takes a tenth at most


class Announcer:
    """Announces nodes from its own thread, so that a busy node stays visible.

    ``describe`` returns the current description of every node of this process.
    """

    def __init__(self, bus: Bus, describe: Callable[[], list[Node]]) -> None:
        self._bus = bus
        self._describe = describe
        self._changed = threading.Condition()
        self._due = time.monotonic() + _CHANGE_DELAY
        self._rested = 0.0
        self._answer_due = math.inf
        self._owes_another = False
        self._is_behind = True
        self._nonce = 0
        self._closed = False
        self._sending = threading.Lock()
        # the endpoints as they were one or two periods ago, to compute their rates
        self._before: dict[object, Endpoint] = {}
        self._latest: dict[object, Endpoint] = {}
        self._next_count = 0.0
        bus.subscribe(protocol.PROBE_CHANNEL, self._receive_probe)
        self._thread = threading.Thread(target=self._run, name="announcer", daemon=True)
        self._thread.start()

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
                self._send_all()

    def say_goodbye(self, node: Node) -> None:
        """Announce for the last time that a node exists, and that it ends."""
        with self._sending:
            self._send(protocol.Announcement(node, leaving=True))

    def answer(self, target: str, nonce: int) -> None:
        """Announce the node of this name at once, repeating ``nonce``."""
        with self._sending:
            self._send_all(nonce, target)

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
        """Answer a probe: at once for one node, spread a little for all."""
        probe = protocol.decode_probe(payload)
        if probe is None:
            return
        if probe.target:
            self.answer(probe.target, probe.nonce)
            return
        answer = time.monotonic() + random.uniform(0, ANSWER_SPREAD)  # noqa: S311
        with self._changed:
            self._nonce = probe.nonce or self._nonce
            # a second probe is sent in case an answer is lost: it gets an answer of its own
            self._owes_another = self._answer_due < math.inf
            self._answer_due = min(self._answer_due, answer)
            self._changed.notify()

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._closed and (left := self._left()) > 0:
                    self._changed.wait(left)
                if self._closed:
                    return
                began = time.monotonic()
                self._due = began + PERIOD
                self._answer_due = began + ANSWER_SPREAD if self._owes_another else math.inf
                self._owes_another = False
                nonce, self._nonce = self._nonce, 0
            work_began = time.thread_time()  # CPU time: on a busy computer no node seems large
            with self._sending:
                self._send_all(nonce)
            worked = time.thread_time() - work_began
            self._rested = min(time.monotonic() + _REST * worked, began + PERIOD)

    def _left(self) -> float:
        """Return the time until the next announcement [s]."""
        return min(self._answer_due, max(self._due, self._rested)) - time.monotonic()

    def _send_all(self, nonce: int = 0, target: str = "") -> None:
        # called with the lock held, so that no node is announced again after its goodbye
        if not target:
            self._is_behind = False  # before describing: a change from now on sets it again
        nodes = self._describe()
        for node in nodes:
            if target in ("", node.name):
                self._send(protocol.Announcement(self._with_rates(node), answers=nonce))
        if (now := time.monotonic()) >= self._next_count:
            self._before, self._next_count = self._latest, now + _SHARE * PERIOD
            self._latest = {(node.id, end.key): end for node in nodes for end in node.endpoints}

    def _with_rates(self, node: Node) -> Node:
        """Return a node with the rates of its endpoints over the last one or two periods."""
        rated = []
        for end in node.endpoints:
            was = self._before.get((node.id, end.key)) or self._latest.get((node.id, end.key))
            rated.append(end._replace(rate=(was and end.rate_since(was)) or 0.0))
        return node._replace(endpoints=tuple(rated))

    def _send(self, announcement: protocol.Announcement) -> None:
        # a lost announcement is made up for by the next, a second later; a closing bus takes none
        payload = protocol.encode_announcement(announcement.sent_at(time.time_ns()))
        with contextlib.suppress(BusError):
            self._bus.publish(protocol.NODE_CHANNEL, payload)
