"""Announcing a process's nodes on the bus: each second, on a change, and on a probe."""

import contextlib
import threading
import time
from collections.abc import Callable, Mapping

from lcmtools.bus.base import Bus, Faults, start_thread
from lcmtools.errors import BusError
from lcmtools.graph import protocol
from lcmtools.graph.announcing import Announcing
from lcmtools.graph.model import Endpoint, NodeInfo
from lcmtools.graph.protocol import ANSWER_SPREAD, PERIOD
from lcmtools.node.graph_follower import GraphFollower

_SHARE = 0.9  # of a period, after which the counters for the rates are replaced

_Counted = tuple[int, dict[object, Endpoint]]
"""Endpoints by their nodes and keys, and when they were counted [ns since 1970]."""


class Announcer:
    """Announces nodes from its own thread, so that a busy node stays visible.

    ``describe`` returns the current description of every node of this process. The thread also
    reads the announcements of others, once the ``follower`` is asked for them.
    """

    def __init__(
        self, bus: Bus, describe: Callable[[], list[NodeInfo]], follower: GraphFollower
    ) -> None:
        self._bus = bus
        self._describe = describe
        self._follower = follower
        follower.on_start = self._wake
        self._faults = Faults(bus.on_outage)
        self._changed = threading.Condition()
        self._schedule = Announcing(time.monotonic(), ANSWER_SPREAD)
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
            self._schedule.change(time.monotonic())
            self._changed.notify()

    def announce_changes(self) -> None:
        """Announce all nodes now if one has changed, ahead of any message that is sent next.

        A simulator must know the subscriptions before it is asked to step.
        """
        with self._sending:
            if self._is_behind:
                self._send_all({"": 0})

    def say_goodbye(self, node: NodeInfo) -> None:
        """Announce for the last time that a node exists, and that it ends."""
        with self._sending:
            self._send(protocol.Announcement(node, leaving=True))

    def answer(self, target: str, nonce: int) -> None:
        """Announce the node of this name at once, repeating ``nonce``."""
        with self._sending:
            self._send_all({target: nonce})

    def leave_to_parent(self) -> None:
        """Announce nothing in a forked process, where the thread may have held these locks."""
        self._changed, self._sending = threading.Condition(), threading.Lock()

    def close(self) -> None:
        """Stop announcing."""
        self._closed = True
        self._wake()
        self._thread.join(timeout=1.0)

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify()

    def _receive_probe(self, payload: bytes, _time: int) -> None:
        """Answer a probe: at once for one node, spread a little for all."""
        probe = protocol.decode_probe(payload)
        if probe is None or not (self._is_behind or probe.target in ("", *self._names)):
            return
        with self._changed:
            self._schedule.ask(probe, time.monotonic())
            is_due = self._schedule.due() <= time.monotonic()
            if not is_due:
                self._changed.notify()
        if is_due:
            self._announce()

    def _run(self) -> None:
        while not self._closed:
            with self._changed:
                left = self._schedule.due() - time.monotonic()
                if left > 0 and not self._closed:
                    self._changed.wait(min(left, self._follower.pause))
            try:
                self._follower.read()
                if not self._closed:
                    self._announce()
            except Exception as error:  # noqa: BLE001 - a node must not vanish for good
                self._faults.note("announcing", error)

    def _announce(self) -> None:
        """Announce what is due; then rest."""
        with self._changed:
            owed = self._schedule.take(time.monotonic())
        if owed:
            began = time.thread_time()
            with self._sending:
                self._send_all(owed)
            with self._changed:
                self._schedule.rest(time.monotonic(), time.thread_time() - began)

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

    def _with_rates(self, node: NodeInfo) -> NodeInfo:
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
