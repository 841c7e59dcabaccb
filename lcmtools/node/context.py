"""The context that a process's nodes share: bus, announcer, arguments, shutdown.

process.py chooses among a process's contexts and handles signals.
"""

import contextlib
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from threading import get_ident
from typing import Protocol

from lcmtools.arguments import NodeArguments
from lcmtools.bus.base import Bus
from lcmtools.bus.multicast import missing_route
from lcmtools.bus.network_watch import network_watch
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.sockets import PlainListeners
from lcmtools.bus.url import BusUrl, another_domain
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.graph.model import NodeInfo, Role
from lcmtools.graph.protocol import SHUTDOWN_CHANNEL, decode_shutdown
from lcmtools.names import base_name_of, resolve_namespace
from lcmtools.node.announcer import Announcer
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.graph_follower import GraphFollower
from lcmtools.node.lockstep import join_lockstep
from lcmtools.node.logger import Logger
from lcmtools.node.subscription import NO_TURN, Turn
from lcmtools.node.unused_arguments import UsedNames
from lcmtools.settings import usual_namespace

_UNRECORDED = (
    "no folder takes this node's record: if it is killed, nobody learns of it; set XDG_RUNTIME_DIR"
    " to a folder of this user"
)
_LOOK_AGAIN = 0.005  # [s] between looks for work without an event to wait for
_LONGEST_WAIT = 1.0
"""[s]. A Python signal handler cannot run during a wait if its signal came just before, or on
another thread; it runs when the wait ends."""


class Participant(Protocol):
    """A node, as far as its context knows it."""

    name: str

    @property
    def callbacks(self) -> Callbacks:
        """The callbacks that the spin functions run."""

    def describe(self) -> NodeInfo:
        """Return the announced description."""

    def get_logger(self) -> Logger:
        """Return the node's log."""

    def destroy_node(self) -> None:
        """End the node, which says goodbye."""


class Spin(Protocol):
    """A thread that runs the callbacks of nodes."""

    def stop(self) -> None:
        """Stop running callbacks."""


class Context:
    """A process's connection to a bus, and the nodes on it; closing it closes the connection.

    ``records`` holds the records of running nodes. A private bus has no URL.
    """

    def __init__(
        self,
        bus: Bus,
        arguments: NodeArguments,
        environment: Mapping[str, str],
        records: NodeRecords | None = None,
        url: BusUrl | None = None,
    ) -> None:
        self.default_namespace = resolve_namespace(usual_namespace(environment))
        self.bus, self.url = bus, url
        bus.on_outage = self._warn
        bus.on_received = self.wake
        self.arguments = arguments
        self._wakeups: dict[int, WakeupEvent] = {}  # of waiting threads, by thread
        self.used = UsedNames()
        self.notices = [text] if url and (text := missing_route(url)) else []
        """Warnings about the network and the command line, which the next node logs."""
        self.note = ""
        """A sentence on the program, which the first node that spins logs."""
        self.on_shutdown_request: Callable[[], None] = self.stop
        """Called when another program requests a shutdown."""
        self._records = records
        self._recorded: dict[str, frozenset[tuple[str, Role]]] = {}
        self._recording = threading.Lock()
        self.plain_listeners = PlainListeners(url) if url else None
        self._participants: list[Participant] = []
        self.background_spins: list[Spin] = []
        self._stopping = False
        self._closed = self.is_of_parent = self._is_shutdown_requested = self.is_ending = False
        """True once the program knows that it should end; it may then take its time."""
        self.follower = GraphFollower(bus, url)
        self.announcer = Announcer(bus, self._describe, self.follower)
        network_watch.tell(self._warn)
        bus.subscribe(SHUTDOWN_CHANNEL, self._receive_shutdown)
        # Not None while a recording is played to this program message by message.
        self.lockstep = join_lockstep(bus, environment, self._all_callbacks, self.wake)

    def ok(self) -> bool:
        """Return whether nodes should go on."""
        return not self._stopping

    def is_closed(self) -> bool:
        """Return whether the connection is closed."""
        return self._closed

    def stop(self) -> None:
        """Make all spin functions return. Safe in signal handlers."""
        self._stopping = True
        self.wake()

    def wake(self) -> None:
        """Wake the waiting threads, so that they look for work."""
        for wakeup in tuple(self._wakeups.values()):
            wakeup.set()

    def run_once(
        self,
        callbacks: Sequence[Callbacks],
        timeout: float | None,
        is_over: Callable[[], bool] | None = None,
    ) -> None:
        """Wait for something to do, for ``timeout`` seconds at most (None: without end); do it.

        Returns as soon as callbacks have run, or when the time is over or the program should end,
        or when ``is_over`` returns True after a ``wake``.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        self.run(callbacks, is_over, deadline=deadline, is_once=True)

    def run(  # noqa: C901 - without calls: it is the path of each message
        self,
        callbacks: Sequence[Callbacks],
        is_over: Callable[[], bool] | None = None,
        *,
        deadline: float | None = None,
        is_once: bool = False,
    ) -> None:
        """Run callbacks until the program should end, or a time [s], or ``is_over`` returns True.

        With ``is_once``, only until one or more have run.
        """
        turn, thread = Turn(), get_ident()
        wakeup = self._wakeups.get(thread)
        try:
            while not (self._stopping or (is_over and is_over())):
                has_run = False
                for one in callbacks:
                    one.turn = turn  # again: a callback may have spun its node
                    if one.ready or one.timers:
                        has_run = one.run_ready() or has_run
                if is_once and (has_run or turn.has_run):
                    return
                if has_run:
                    continue
                wait = None if deadline is None else deadline - time.monotonic()
                if wait is not None and wait <= 0:
                    return
                for one in callbacks:
                    if one.timers and (due := one.time_to_timer()) is not None:
                        wait = due if wait is None else min(due, wait)
                if self.lockstep:
                    self.lockstep.answer(callbacks)
                if wakeup is None:
                    wakeup = self._add_wakeup(thread)
                    continue  # a ``wake`` may have missed it
                turn.thread = thread if self.bus.runs_callbacks else 0
                is_long = wait is None or wait > _LONGEST_WAIT
                self.bus.wait(wakeup, _LONGEST_WAIT if is_long else wait)
                turn.thread = 0
        finally:
            turn.thread = 0
            for one in callbacks:
                one.turn = NO_TURN

    def add(self, participant: Participant) -> None:
        """Add a node: announce it, and record that it runs."""
        self._participants.append(participant)
        node = self._describe_recorded(participant)
        if self._records and not node.tool and (other := self._records.namesake(node)):
            self.notices.append(
                f"pid {other.pid} is a node of this name too: end one of them, "
                f"or start this one {_apart_from(other, self._records, self.url)}"
            )
        self.announcer.announce_soon()

    def remove(self, participant: Participant) -> None:
        """Remove a node: say goodbye for it."""
        if participant in self._participants:
            self._participants.remove(participant)
            node = participant.describe()
            self.announcer.say_goodbye(node)
            self._recorded.pop(node.id, None)
            if self._records:
                self._records.remove(node.id)

    def server(self, service: str, *threads: int | None) -> str:
        """Return the node here that has a service and that one of these threads spins, else "".

        None is no thread.
        """
        for node in tuple(self._participants):
            services = [one.name for one in tuple(node.callbacks.services)]
            if service in services and node.callbacks.spinning_thread in threads:
                return node.name
        return ""

    def is_first(self) -> bool:
        """Return whether no node has been made yet: ``__name:=`` names the first one."""
        return not self._participants

    def _add_wakeup(self, thread: int) -> WakeupEvent | None:
        """Return an event that wakes this thread; None if the system gives no more descriptors."""
        try:
            self._wakeups[thread] = WakeupEvent()
        except OSError:
            time.sleep(_LOOK_AGAIN)
        return self._wakeups.get(thread)

    def _all_callbacks(self) -> list[Callbacks]:
        return [participant.callbacks for participant in tuple(self._participants)]

    def close(self) -> None:
        """End all nodes and leave the bus."""
        if self._closed:
            return
        self._closed = True
        network_watch.forget(self._warn)
        self.stop()
        for spin in tuple(self.background_spins):
            spin.stop()
        for participant in tuple(self._participants):
            participant.destroy_node()
        self.announcer.close()
        self.follower.close()
        self.bus.close()
        for wakeup in self._wakeups.values():
            wakeup.close()

    def leave_to_parent(self) -> None:
        """End in a forked process: the threads, nodes, goodbyes and the bus remain the parent's."""
        self._closed = self._stopping = self.is_of_parent = True
        self.announcer.leave_to_parent()
        self.follower.leave_to_parent()
        self.bus.leave_to_parent()

    def _warn(self, text: str) -> None:
        """Log, once per process, a problem of the bus; commands report it themselves."""
        for participant in tuple(self._participants):
            if not participant.describe().tool:
                participant.get_logger().warning(text)
                return

    def _describe(self) -> list[NodeInfo]:
        return [self._describe_recorded(participant) for participant in tuple(self._participants)]

    def _describe_recorded(self, participant: Participant) -> NodeInfo:
        """Return a node's description; write its record if it is new or its topics have changed."""
        node = participant.describe()
        topics = frozenset((endpoint.topic, endpoint.role) for endpoint in node.endpoints)
        with self._recording:  # when this returns the record exists, whichever thread wrote it
            if self._records and self._recorded.get(node.id) != topics:
                self._recorded[node.id] = topics
                if not self._records.write(node) and _UNRECORDED not in self.notices:
                    self.notices.append(_UNRECORDED)
        return node

    def _receive_shutdown(self, payload: bytes, _time: int) -> None:
        """End this program if the request is for one of its nodes; runs on the receiving thread.

        It answers before it ends, so that the requester can recognize a program that hangs.
        """
        request = decode_shutdown(payload)
        if request is None:
            return
        for participant in tuple(self._participants):
            node = participant.describe()
            if node.id == request.target:
                try:
                    self.announcer.answer(node.name, request.nonce)
                finally:
                    self._obey(participant, request.requester)
                return

    def _obey(self, participant: Participant, requester: str) -> None:
        """End this program, then log who wanted it: that may fail. A request may be repeated."""
        if not self._is_shutdown_requested:
            self._is_shutdown_requested = True
            try:
                self.on_shutdown_request()
            finally:
                who = f"by {requester}" if requester else "over the bus"
                with contextlib.suppress(Exception):
                    participant.get_logger().warning(f"shutdown requested {who}")


def _apart_from(other: NodeInfo, records: NodeRecords, url: BusUrl | None) -> str:
    """Return how to start a node of the same name; a bus has one publisher of the time."""
    if CLOCK_TOPIC in records.topics([other.id], Role.PUBLISHER):
        return f"on another bus, with --domain {another_domain(str(url))}"
    return f"with __name:={base_name_of(other.name)}2"
