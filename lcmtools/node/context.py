"""What all nodes of a process share: the bus, the announcer, the arguments, the way to end.

``init``, ``ok``, ``shutdown`` and the spin functions work on the process's context, as in rclpy.
"""

import atexit
import contextlib
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import FrameType
from typing import Protocol

from lcmtools.arguments import NodeArguments, split_arguments
from lcmtools.bus.base import Bus
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import BusUrl, choose_url
from lcmtools.errors import BusError, LcmtoolsError, UsageError
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Graph, Node
from lcmtools.graph.protocol import NODE_CHANNEL, PROBE_CHANNEL, Probe, encode_probe, identity_in
from lcmtools.names import resolve_namespace
from lcmtools.node.announcer import Announcer
from lcmtools.node.wakeup import Wakeup
from lcmtools.wire.packet import Packet

_MOST_ANNOUNCED = 10_000
"""Announcements that are kept until somebody asks for the graph."""
_GRACE = 0.5
"""Seconds that a running callback gets to return after Ctrl-C before it is interrupted."""


class Participant(Protocol):
    """What the context needs of a node; see lcmtools.node.node."""

    def describe(self) -> Node:
        """What is announced."""
        ...

    def destroy_node(self) -> None:
        """Leave the bus."""
        ...


class Context:
    """A process's connection to a bus, with the nodes on it.

    Args:
        bus: The connection; closed with the context.
        arguments: What the command line said.
        environment: The process's environment variables.
        records: Where nodes leave their records; None for none.
    """

    def __init__(
        self,
        bus: Bus,
        arguments: NodeArguments,
        environment: Mapping[str, str],
        records: NodeRecords | None = None,
    ) -> None:
        self.default_namespace = resolve_namespace(environment.get("LCMTOOLS_NAMESPACE", ""))
        self.bus = bus
        self.arguments = arguments
        self.wakeup = Wakeup()
        self.declared_parameters: set[str] = set()
        self.notices: list[str] = []
        """What the first node should log: something on the command line has no effect."""
        self.host = socket.gethostname()
        self._records = records
        self._participants: list[Participant] = []
        self._stopping = False
        self._closed = False
        self.is_told = False
        """Whether the program has been told to end: what it does from then on is its ending."""
        self._graph_lock = threading.Lock()
        self._graph_builder: GraphBuilder | None = None
        self._announced_lock = threading.Lock()  # held for a moment only, on the receiving thread
        self._announced: dict[bytes, tuple[bytes, int]] = {}
        self.announcer = Announcer(bus, self._describe)

    def ok(self) -> bool:
        """Whether nodes should go on."""
        return not self._stopping

    def is_closed(self) -> bool:
        """Whether the bus has been left."""
        return self._closed

    def stop(self) -> None:
        """Ask everything that spins to return. Safe in signal handlers."""
        self._stopping = True
        self.wakeup.set()

    def add(self, participant: Participant) -> None:
        """Take a node in: announce it, and record that it runs."""
        self._participants.append(participant)
        if self._records:
            self._records.write(participant.describe())
        self.announcer.announce_soon()

    def remove(self, participant: Participant) -> None:
        """Let a node go: say goodbye for it."""
        if participant in self._participants:
            self._participants.remove(participant)
            node = participant.describe()
            self.announcer.say_goodbye(node)
            if self._records:
                self._records.remove(node.id)

    def is_first(self) -> bool:
        """Whether no node has been made yet: ``__name:=`` names the first one."""
        return not self._participants

    def graph(self) -> Graph:
        """The announced nodes of the bus; the first call starts listening to them."""
        if self._graph_builder is None:
            self._graph_builder = GraphBuilder()
            self.bus.subscribe(NODE_CHANNEL, self._hear)
            with contextlib.suppress(BusError):  # without it, they announce within a second
                self.bus.publish(PROBE_CHANNEL, encode_probe(Probe()))
        with self._graph_lock:
            for payload, now in self._take_announced():
                self._graph_builder.hear(Packet(NODE_CHANNEL, payload, now))
            return self._graph_builder.snapshot(time.time_ns())

    def close(self) -> None:
        """End all nodes and leave the bus."""
        if self._closed:
            return
        self._closed = True
        self.stop()
        for participant in tuple(self._participants):
            participant.destroy_node()
        self.announcer.close()
        self.bus.close()
        self.wakeup.close()

    def _describe(self) -> list[Node]:
        return [participant.describe() for participant in tuple(self._participants)]

    def _hear(self, payload: bytes, now: int) -> None:
        """Keep each node's latest announcement; decoding all would be most of the work."""
        identity = identity_in(payload)
        with self._announced_lock:
            if len(self._announced) < _MOST_ANNOUNCED or identity in self._announced:
                self._announced[identity] = payload, now

    def _take_announced(self) -> Iterable[tuple[bytes, int]]:
        with self._announced_lock:
            announced, self._announced = self._announced, {}
        return announced.values()


class _Process:
    """The one context of this process and its signal handlers.

    The only state that the package keeps: ``init`` and ``spin`` are functions, as in rclpy.
    """

    def __init__(self) -> None:
        self.context: Context | None = None
        self.handlers: dict[int, Callable[[int, FrameType | None], object] | int | None] = {}


_process = _Process()


def init(
    args: Sequence[str] | None = None, *, url: str | None = None, handle_signals: bool = True
) -> list[str]:
    """Connect this process to the bus; the first thing a node's program does.

    Args:
        args: The command line without the program's name; ``sys.argv`` when None. Names
            (``__ns:=``, ``a:=b``), parameters (``_gain:=2.0``) and the bus are taken from it.
        url: The bus, where the command line says nothing.
        handle_signals: Let Ctrl-C and SIGTERM make ``spin`` return and ``ok`` False.

    Returns:
        The arguments that are the program's own.

    Raises:
        UsageError: The arguments are wrong.
        BusError: The bus cannot be reached, with what to type.
    """
    if _process.context is not None:
        raise LcmtoolsError("lcmtools.init() was called twice", "call lcmtools.shutdown() between")
    arguments, rest = split_arguments(sys.argv[1:] if args is None else args)
    bus_url, source = choose_url(arguments.lcm_url or url, arguments.domain, os.environ)
    _process.context = Context(
        _open_bus(bus_url), arguments, os.environ, NodeRecords(bus_url, os.environ)
    )
    if arguments.domain and source != "--domain":
        notice = f"--domain {arguments.domain} has no effect: {source} wins"
        _process.context.notices.append(notice)
    if handle_signals and threading.current_thread() is threading.main_thread():
        _process.handlers = {
            number: signal.signal(number, _interrupted)
            for number in (signal.SIGINT, signal.SIGTERM)
        }
    atexit.register(shutdown)
    return rest


def shutdown() -> None:
    """Say goodbye for all nodes and leave the bus. Does nothing the second time."""
    context, _process.context = _process.context, None
    if context is None:
        return
    with contextlib.suppress(KeyboardInterrupt):  # impatience does not stop a goodbye
        context.close()
    for number, handler in _process.handlers.items():
        if signal.getsignal(number) is _interrupted:
            signal.signal(number, handler)
    _process.handlers = {}
    atexit.unregister(shutdown)


def ok() -> bool:
    """Whether the program should go on: False after Ctrl-C, SIGTERM and ``shutdown``."""
    context = _process.context
    if context is None:
        return False
    context.is_told = not context.ok()
    return context.ok()


def current_context() -> Context:
    """The process's context.

    Raises:
        LcmtoolsError: ``init`` has not been called.
    """
    if _process.context is None:
        raise LcmtoolsError("there is no bus yet", "call lcmtools.init() first")
    return _process.context


def _open_bus(url: BusUrl) -> Bus:
    from lcmtools.bus.liblcm import LcmBus

    if url.provider == "file" and url.options.get("mode", "r") == "r":
        raise UsageError(
            f"{url} is a log to be read, and nodes need a bus",
            "look into it with lcmtools echo --lcm-url, or give the node another bus",
        )
    return LcmBus(url)


def _interrupted(_number: int, _frame: FrameType | None) -> None:
    """Ctrl-C or SIGTERM: ask everything to return; interrupt what does not within half a second."""
    context = _process.context
    if context is None or context.is_closed():
        return
    if not context.ok():
        raise KeyboardInterrupt
    context.stop()
    thread = threading.Timer(_GRACE, _interrupt_again, [context])
    thread.daemon = True
    thread.start()


def _interrupt_again(context: Context) -> None:
    """A callback is still running: break it off, as a second Ctrl-C would.

    A program that has been told may take its time: to stop a robot, for example.
    """
    main = threading.main_thread().ident
    if main is None or context.is_told or context.is_closed():
        return
    if _process.context is context:
        signal.pthread_kill(main, signal.SIGINT)
