"""Processes of this computer that use LCM: their states, buses and displayed names."""

import contextlib
import os
import re
import resource
import sys
import time
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from ipaddress import IPv4Address
from itertools import chain
from pathlib import Path

from lcmtools.bus.kernel import ANNOUNCED, SELECTIVE, SUBSCRIBED, own_network
from lcmtools.bus.processes import PROC, Process, running
from lcmtools.bus.records import recorded_pids
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import BusUrl, choose_url, parse_url
from lcmtools.doctor.connecting import unconnected_ends
from lcmtools.doctor.evidence import LcmProcess, Stream
from lcmtools.doctor.listening import Listening
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.command_line import LONGEST_COMMAND, shortened
from lcmtools.graph.model import Graph, NodeInfo, Role
from lcmtools.names import is_hidden
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import SenderNames, is_here, nodes_by_pid
from lcmtools.wire.packet import Sender

_KNOWN_GROUPS = frozenset({"224.0.0.251", "239.255.255.250", "224.0.0.252"})  # mDNS, SSDP, LLMNR
_VARIABLES = ("LCM_DEFAULT_URL", "LCMTOOLS_DOMAIN")
_URL = re.compile(r"\b(?:udpm|mpudpm|tcpq|memq)://[\w.:?=&-]*")
_MOST_CODE = 4 << 20  # bytes of a file in which a URL is searched
_MOST_BUSES = 3  # other buses that are observed
_LISTEN, _MOST_LISTENS = 0.2, 6  # [s] to another bus; 1.2 s in all show what is sent at 1 Hz


def lcm_processes(url: BusUrl, table: SocketTable, seen: set[int]) -> tuple[LcmProcess, ...]:
    """Return the processes of this user that use LCM, with their buses.

    A process that joins a multicast group is on that bus. A process that only sends is on this bus
    if its port is one of ``seen``; else its arguments, variables or code name its bus, as for a
    process without UDP.
    """
    own, marked = os.getuid(), table.marked(ANNOUNCED, SELECTIVE, SUBSCRIBED)
    held = ((table.holders.get(inode), row) for inode, row in table.rows.items())
    mine = [(one, row) for one, row in held if one and row.uid == own and one.pid != os.getpid()]
    buses: dict[Process, str] = {}
    sending: dict[Process, set[int]] = {}
    for one, row in mine:
        multicast = IPv4Address(row.address).is_multicast and row.address not in _KNOWN_GROUPS
        if row.port == url.port and (row.address == url.host or not multicast):
            buses[one] = ""
        elif not multicast:
            sending.setdefault(one, set()).add(row.port)
        # lcmtools' sockets are marked; for Java only the command line can tell, which is a guess
        elif row.inode in marked or "lcm" in one.command or one.uses_lcm:
            said = _named_bus(one, url)  # one without a port is no bus, although a socket has one
            buses.setdefault(one, said if _is_faulty(said) else f"{row.address}:{row.port}")
    guessed = set()
    for one, ports in sending.items():
        if one not in buses and one.uses_lcm:
            code = "" if _argument_url(one) or _variables(one) else _code_url(one)
            buses[one] = "" if ports & seen else _named_bus(one, url, code)
            guessed |= {one.pid} if code else set()
    known = {one.pid for one, _ in mine} | {os.getpid()}
    others = (one for one in running() if one.pid not in known and one.uid == own)
    without_udp = (one for one in others if one.network == own_network())
    named = {one: bus for one in without_udp if "://" in (bus := _named_bus(one, url))}
    recorded = recorded_pids(os.environ) if named else ()
    buses |= {one: bus for one, bus in named.items() if one.pid in recorded or one.uses_lcm}
    return tuple(
        LcmProcess(
            one.pid,
            shortened(one.command or " ".join(one.words).strip(), LONGEST_COMMAND),
            bus,
            next((f"{name}={value}" for name, value in _variables(one).items()), ""),
            len(table.files.get(one.pid, ())),
            _most_files(one.pid),
            one.state,
            is_guess=one.pid in guessed,
        )
        for one, bus in sorted(buses.items(), key=lambda item: item[0].pid)
    )


def _named_bus(process: Process, url: BusUrl, code: str = "") -> str:
    """Return the other bus in a process's arguments, variables or code: HOST:PORT, or a URL."""
    variables = _variables(process)
    written = _argument_url(process) or code
    try:
        named, _ = choose_url(written, "", variables)
    except LcmtoolsError:  # a URL without a port, for example
        return written or variables.get("LCM_DEFAULT_URL", "")
    if named.file_name == url.file_name:
        return ""
    return f"{named.host}:{named.port}" if named.is_multicast else str(named)


def _is_faulty(bus: str) -> bool:
    """Return whether a named bus is a URL that names none."""
    with contextlib.suppress(LcmtoolsError):
        return "://" in bus and not parse_url(bus)
    return True


def _argument_url(process: Process) -> str:
    found = (_URL.search(word) for word in process.words)
    return next((match[0] for match in found if match), "")


def _code_url(process: Process) -> str:
    """Return the only URL of a bus in a process's script or executable; "" for none or several."""
    program, *words = process.words
    script = next((word for word in words if word and not word.startswith("-")), "")
    folder = PROC / str(process.pid)
    file = folder / "cwd" / script if "python" in Path(program).name else folder / "exe"
    with contextlib.suppress(OSError):  # the process may end meanwhile
        if file.stat().st_size < _MOST_CODE:
            urls = set(_URL.findall(file.read_text(errors="replace")))
            return str(urls.pop()) if len(urls) == 1 else ""
    return ""


def _variables(process: Process) -> dict[str, str]:
    known = process.environment
    return {name: known[name] for name in _VARIABLES if known.get(name)}


def _most_files(pid: int) -> int:
    with contextlib.suppress(OSError):
        if sys.platform == "linux":
            return max(0, resource.prlimit(pid, resource.RLIMIT_NOFILE)[0])
    return 0


def with_topics(processes: Iterable[LcmProcess], graph: Graph) -> tuple[LcmProcess, ...]:
    """Add to processes on other buses the topics there, and those of this bus that they wait for.

    Other buses are observed only if this one has no nodes, or unconnected ones.
    """
    every = tuple(processes)
    missed = {end.topic for _, end in unconnected_ends(graph, Role.SUBSCRIBER)}
    announced = {e.topic for node in graph.nodes for e in node.endpoints}
    offered = {end.topic for _, end in unconnected_ends(graph, Role.PUBLISHER)}
    offered |= _published(graph) - announced
    if not (missed or offered) and any(not node.tool for node in graph.nodes):
        return every
    topics, awaited = _topics([process for process in every if process.bus], missed)
    found = []
    for one in every:
        there, missing = topics[one.bus], awaited[one.pid] & offered - topics[one.bus]
        known = tuple(sorted(there)), tuple(sorted(missing))
        found.append(replace(one, topics=known[0], awaited=known[1]))
    return tuple(found)


def _topics(
    processes: Sequence[LcmProcess], missed: set[str]
) -> tuple[Mapping[str, set[str]], Mapping[int, set[str]]]:
    """Return the topics that are published on other buses, and those that each process waits for.

    Plain LCM programs may publish a missing topic rarely: they get more time.
    """
    from lcmtools.bus.quick_probe import QuickProbe

    pids = {process.pid for process in processes}
    topics: dict[str, set[str]] = defaultdict(set)
    awaited: dict[int, set[str]] = defaultdict(set)
    with contextlib.ExitStack() as stack:
        probes = {}
        for bus in sorted({process.bus for process in processes})[:_MOST_BUSES]:
            with contextlib.suppress(LcmtoolsError):
                probe = QuickProbe(parse_url(f"udpm://{bus}?ttl=0"))
                probes[bus] = stack.enter_context(probe)
        for _ in range(_MOST_LISTENS if probes else 0):
            time.sleep(_LISTEN)
            for bus, probe in probes.items():
                graph = probe.graph()
                pids -= {node.pid for node in graph.nodes if is_here(node)}
                topics[bus] |= _published(graph)
                for node, end in unconnected_ends(graph, Role.SUBSCRIBER):
                    if is_here(node):
                        awaited[node.pid].add(end.topic)
            if not pids or missed.issubset(chain.from_iterable(topics.values())):
                break
    return topics, awaited


def _published(graph: Graph) -> set[str]:
    announced = {e.topic for node in graph.nodes for e in node.having(Role.PUBLISHER)}
    seen = {traffic.channel for traffic in graph.traffic}
    return {name for name in announced | seen if not is_hidden(name)}


class ProgramNames:
    """The displayed names of senders and processes."""

    def __init__(
        self,
        monitor: BusMonitor,
        listening: Listening,
        nodes: Collection[NodeInfo],
        table: SocketTable,
    ) -> None:
        self.table = table
        self.by_pid = nodes_by_pid(nodes, table.holders.values())
        self.senders = SenderNames(lambda: table, called=self.of_process)
        seen = {one.sender for one in listening.streams()}
        tap = monitor.tap
        self.senders.update(seen | set(tap.sequences) | set(tap.malformed) if tap else seen)
        self.senders.update((), nodes)

    def name(self, sender: Sender | None) -> str:
        """Return a sender's node, else its process, or all processes that may share its port."""
        known = self.senders.name(sender)
        if sender is None or known != str(sender):
            return known
        able = self.table.processes(sender)
        names = sorted(self.of_process(process) for process in able.candidates)
        if names and not able.are_all:
            names.append("another program")
        return " or ".join(names) or known

    def pid(self, stream: Stream) -> int | None:
        """Return a sender's process on this computer."""
        if node := self.senders.node(stream.sender):
            return node.pid if is_here(node) else None
        process = self.senders.process(stream.sender)
        return process.pid if process else None

    def of_process(self, process: Process) -> str:
        """Return a process's nodes, or its command, with its number."""
        nodes = ", ".join(node.name for node in self.by_pid.get(process.pid, []))
        return f"{nodes or shortened(process.command, LONGEST_COMMAND)} (pid {process.pid})"

    def malformed(self, monitor: BusMonitor) -> tuple[tuple[str, str], ...]:
        """Return the senders of datagrams that are not LCM's, with the reasons."""
        malformed = monitor.tap.malformed if monitor.tap else {}
        known = ((sender, self.senders.process(sender), why) for sender, why in malformed.items())
        return tuple((f"{s}, {self.of_process(p)}" if p else str(s), why) for s, p, why in known)
