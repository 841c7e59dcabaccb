"""Requests over the bus to nodes, to answer or to end; finding programs that are not nodes."""

import os
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from lcmtools.bounded import BoundedDict
from lcmtools.errors import LcmtoolsError, NothingReceived, UsageError
from lcmtools.graph.model import Graph, NodeInfo, Staleness
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    decode_announcement,
    decode_probe,
)
from lcmtools.observe.reading.find import find_nodes
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import Program, is_gone, is_here, programs
from lcmtools.observe.reports.describe import behind_text, host_text
from lcmtools.wire.packet import Packet

_PING_PERIOD = 1.0  # [s]
_ASK_AGAIN = 0.5  # [s]; any message on LCM may be lost


def _nonce() -> int:
    """Return a number that no other request has; never 0, which unrequested announcements have."""
    return int.from_bytes(os.urandom(7), "big") | 1


def ping(monitor: BusMonitor, node: NodeInfo, timeout: float) -> float:
    """Return the round trip time of a request to a node [s]; NothingReceived if it is silent."""
    return next(pings(monitor, node, timeout))[1]


def pings(monitor: BusMonitor, node: NodeInfo, timeout: float) -> Iterator[tuple[NodeInfo, float]]:
    """Yield the node and the round trip time of a request to it [s], once a second without end.

    If it has ended and is started anew, its next run is the node from then on.

    Raises:
        NothingReceived: The node did not answer in time, or has ended.
    """
    while True:
        node, seconds = _answered(monitor, node, timeout)
        yield node, seconds
        time.sleep(_PING_PERIOD)


def _answered(monitor: BusMonitor, node: NodeInfo, timeout: float) -> tuple[NodeInfo, float]:
    """Return the node that answers a request, and the time that this took [s].

    The request is repeated if no answer comes. A node may answer several requests at once, and
    repeats the number of the latest: an answer to somebody's later request counts.
    """
    if node.stale is Staleness.ENDED:
        raise NothingReceived(f"{node.name} {node.stale}", "lcmtools node cleanup forgets it")
    monitor.receive(0.0)  # a backlog must not count in the measured time
    begun = BoundedDict[int, float]()  # requests, by their nonces
    deadline, next_request = time.monotonic() + timeout, 0.0
    while (now := time.monotonic()) < deadline:
        if now >= next_request:
            requested, next_request, nonce = now, now + _ASK_AGAIN, _nonce()
            begun[nonce] = requested
            monitor.probe(node.name, nonce)
        for packet in monitor.receive(min(deadline, next_request) - now):
            if (other := _nonce_for(node, packet)) and other not in begun:
                begun[other] = requested
            answer = _announcement(packet)
            if answer and answer.answers in begun and _is_still(node, answer.node, monitor):
                return answer.node, time.monotonic() - begun[answer.answers]
    raise NothingReceived(
        f"{node.name} did not answer within {timeout:g} s",
        f"its process is {node.pid} on {host_text(node)}; lcmtools wtf shows more",
    )


def _is_still(node: NodeInfo, other: NodeInfo, monitor: BusMonitor) -> bool:
    """Return whether another announcement is of a node, or of its next run."""
    is_next = other.name == node.name and other.start_time > node.start_time
    return other.id == node.id or (is_next and _has_ended(node, monitor.graph()))


def _has_ended(node: NodeInfo, graph: Graph) -> bool:
    return is_gone(node) or all(one.id != node.id or bool(one.stale) for one in graph.nodes)


@dataclass(slots=True)
class NodeEnd:
    """The end of one node that was requested to end."""

    node: NodeInfo
    nonce: int  # which its answer repeats
    has_answered: bool = False  # to the request
    has_ended: bool = False  # it has said goodbye, or its process is gone
    others: tuple[str, ...] = ()  # names of other nodes of its process, which end with it

    def update(self, announcement: Announcement) -> None:
        """Update from an announcement."""
        if announcement.node.id == self.node.id:
            self.has_answered |= announcement.answers == self.nonce
            self.has_ended |= announcement.leaving

    def check_process(self) -> None:
        """Update from this computer's processes, because a goodbye may be lost."""
        self.has_ended |= is_gone(self.node)

    def to_json(self) -> dict[str, object]:
        """Return the result for JSON."""
        return {
            "node": self.node.name,
            "host": self.node.host,
            "pid": self.node.pid,
            "heard": self.has_answered or self.has_ended,
            "ended": self.has_ended,
            "ended_with_it": list(self.others) if self.has_ended else [],
        }

    def complaint(self, timeout: float) -> str:
        """Return the state of a node that does not end, and the command that ends it."""
        what = f"{self.node.name} does not answer"
        if self.has_answered:
            what = f"{self.node.name} was asked to shut down and still runs after {timeout:g} s"
        where = "" if is_here(self.node) else f"on {host_text(self.node)}, "
        return f"{what}; {where}to end it by force, type: kill -9 {self.node.pid}"


def end_nodes(monitor: BusMonitor, nodes: Sequence[NodeInfo], timeout: float) -> list[NodeEnd]:
    """Request nodes to end and wait until they have, for ``timeout`` seconds at most."""
    known = monitor.graph().nodes
    ends = [NodeEnd(node, _nonce(), others=_others_of_process(node, known)) for node in nodes]
    deadline, request_time = time.monotonic() + timeout, 0.0
    while (now := time.monotonic()) < deadline and (left := [e for e in ends if not e.has_ended]):
        if now >= request_time:
            request_time = now + _ASK_AGAIN
            for end in left:
                end.check_process()
                monitor.ask_to_end(end.node, end.nonce)
        packets = monitor.receive(min(request_time, deadline) - now)
        for announcement in filter(None, map(_announcement, packets)):
            for end in ends:
                end.update(announcement)
    for end in ends:
        end.check_process()
    return ends


def nodes_to_end(graph: Graph) -> list[NodeInfo]:
    """Return all running nodes of this bus that are not commands."""
    return [
        node
        for node in graph.nodes
        if not (node.is_hidden or node.tool or node.path or node.stale is Staleness.ENDED)
    ]


def node_to_end(monitor: BusMonitor, graph: Graph, word: str) -> NodeInfo:
    """Return the one node that a name, a pid or HOST:PID means.

    Raises:
        UsageError: The word is empty.
        LcmtoolsError: There is none, there are several, or it has ended or is not a node.
    """
    found = nodes_named(monitor, graph, word, _cannot_be_ended)
    if found[0].path:
        what = f"{found[0].name} is on another bus and cannot be shut down from here"
        raise LcmtoolsError(what, f"end it there: it is on {behind_text(found[0])}")
    if len(set(map(_process_key, found))) > 1:
        what = "pid" if word.isdecimal() else "name"
        raise LcmtoolsError(f"{len(found)} nodes have the {what} {word}", _distinction(found))
    if found[0].stale is Staleness.ENDED:
        raise LcmtoolsError(
            f"{found[0].name} has ended already, without saying goodbye",
            "lcmtools node cleanup forgets it",
        )
    return found[0]


def node_to_ping(monitor: BusMonitor, graph: Graph, word: str) -> NodeInfo:
    """Return the first node that a name or a pid means.

    Raises:
        UsageError: The word is empty.
        LcmtoolsError: There is none, nodes of different names match, or it is not a node.
    """
    return nodes_named(monitor, graph, word, _answers_no_ping)[0]


def nodes_named(
    monitor: BusMonitor, graph: Graph, word: str, refuse: Callable[[str, Program], LcmtoolsError]
) -> list[NodeInfo]:
    """Return what ``find_nodes`` does; for a program that is not a node, raise what is returned."""
    try:
        return find_nodes(graph, word)
    except UsageError:
        raise
    except LcmtoolsError:
        if others := find_programs(monitor, word):
            program = others[0]
            of = program.process and f"{program.process.command} (pid {program.process.pid})"
            raise refuse(f"{of or f'the program at {word}'} is not a node", program) from None
        raise


def find_programs(monitor: BusMonitor, word: str) -> list[Program]:
    """Return the programs that a word means (see ``program_names``)."""
    return [one for one in programs(monitor.settle(), monitor.url) if word in program_names(one)]


def program_place(program: Program) -> str:
    """Return a program's place: "host:pid", or the address that its messages come from."""
    if program.process:
        return f"{socket.gethostname()}:{program.process.pid}"
    if program.ports:
        return f"{program.address}:{program.ports[0]}"
    return program.address or "unknown address"


def program_names(program: Program) -> set[str]:
    """Return the words that name a program: its place, pid, command and the command's words."""
    names = {program_place(program)}
    if program.process:
        command = program.process.command
        names |= {str(program.process.pid), command}
        names |= {part.rpartition("/")[2] for part in command.split()}
    return names


def _announcement(packet: Packet) -> Announcement | None:
    return decode_announcement(packet.payload) if packet.channel == NODE_CHANNEL else None


def _nonce_for(node: NodeInfo, packet: Packet) -> int:
    """Return the number of a request to a node; 0 for anything else."""
    probe = decode_probe(packet.payload) if packet.channel == PROBE_CHANNEL else None
    return probe.nonce if probe and probe.target == node.name else 0


def _process_key(node: NodeInfo) -> tuple[str, str, int, int]:
    """A key for a node's process: computers may share names, and often have the same pids."""
    place = node.sender.address if node.sender else node.bus
    return node.host, place, node.pid, node.pid_namespace


def _others_of_process(node: NodeInfo, known: Sequence[NodeInfo]) -> tuple[str, ...]:
    return tuple(
        other.name
        for other in known
        if _process_key(other) == _process_key(node) and other.id != node.id and not other.stale
    )


def _distinction(nodes: Sequence[NodeInfo]) -> str:
    if len({node.pid for node in nodes}) == len(nodes):
        pids = [f"{node.pid} on {host_text(node)}" for node in nodes]
        return f"write a pid: {', '.join(pids)}"
    has_names = len({node.host for node in nodes}) > 1
    keys = map(_process_key, nodes)
    places = [f"{host if has_names else address}:{pid}" for host, address, pid, _ in keys]
    return f"write HOST:PID: {', '.join(places)}"


def _cannot_be_ended(what: str, program: Program) -> LcmtoolsError:
    hint = f"type: kill {program.process.pid}" if program.process else "end it on its computer"
    return LcmtoolsError(f"{what} and cannot be shut down", hint)


def _answers_no_ping(what: str, program: Program) -> LcmtoolsError:
    hint = f"lcmtools node info {program_place(program)} shows what is seen of it"
    return LcmtoolsError(f"{what} and answers no ping", hint)
