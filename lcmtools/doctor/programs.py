"""Processes of this computer that use LCM: their state, their buses, their names in findings."""

import contextlib
import os
import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from ipaddress import IPv4Address
from pathlib import Path

from lcmtools.bus.processes import Process, UdpSocket, process_of, uses_lcm
from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.url import BusUrl, choose_url, parse_url
from lcmtools.doctor.connecting import loose_ends
from lcmtools.doctor.evidence import LcmProcess, Stream
from lcmtools.doctor.host import text_of
from lcmtools.doctor.listening import Listening
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.senders import SenderNames, SocketTable, is_here

_PROC = Path("/proc")
_KNOWN_GROUPS = frozenset({"224.0.0.251", "239.255.255.250", "224.0.0.252"})  # mDNS, SSDP, LLMNR
_VARIABLES = ("LCM_DEFAULT_URL", "LCMTOOLS_DOMAIN")
_NAME_CHARACTERS = 60
_MOST_BUSES = 3  # that are looked at
_LISTEN = 0.2  # [s]


def state_of(pid: int) -> str:
    """A process's state as ps shows it; "" where there is none."""
    return text_of(_PROC / str(pid) / "stat").rpartition(")")[2].strip()[:1]


def busy_time(pid: int) -> int:
    """The time that a process's first thread has computed, or waited for a processor [ns]."""
    numbers = text_of(_PROC / str(pid) / "schedstat").split()
    return int(numbers[0]) + int(numbers[1]) if len(numbers) > 1 else 0


def waited_time(pid: int) -> int:
    """The time that a process's threads have waited for a processor, all together [ns]."""
    files = (_PROC / str(pid) / "task").glob("*/schedstat")
    numbers = [text_of(file).split() for file in files]
    return sum(int(row[1]) for row in numbers if len(row) > 1)


def never_reads(pid: int) -> bool:
    """Return whether a process only sends, although it has a socket that receives.

    lcm.jar makes one for sending too, and starts a thread that reads with the first subscription.
    """
    if Path(text_of(_PROC / str(pid) / "cmdline").partition("\0")[0]).name != "java":
        return False
    names = [text_of(file) for file in (_PROC / str(pid) / "task").glob("*/comm")]
    return not any(name.startswith("Thread-") for name in names)


def lcm_processes(
    url: BusUrl, sockets: Iterable[UdpSocket], holders: Mapping[int, Process], seen: set[int]
) -> tuple[LcmProcess, ...]:
    """The processes of this user that have to do with LCM, with where they are.

    Those that listen to a multicast group are there. One that only sends is where it was seen
    (its port is one of ``seen``), or the bus that its variables name.
    """
    buses: dict[int, str] = {}
    sending: dict[int, set[int]] = {}
    own = os.getuid()
    for row in sockets:
        process = holders.get(row.inode)
        multicast = IPv4Address(row.address).is_multicast and row.address not in _KNOWN_GROUPS
        if not process or row.uid != own or process.pid == os.getpid():
            continue
        if row.port == url.port and (row.address == url.host or not multicast):
            buses[process.pid] = ""
        elif multicast:
            buses.setdefault(process.pid, f"{row.address}:{row.port}")
        else:
            sending.setdefault(process.pid, set()).add(row.port)
    found = [_lcm_process(pid, bus) for pid, bus in sorted(buses.items())]
    for pid, ports in sorted(sending.items()):
        if pid not in buses and uses_lcm(pid):
            bus = "" if ports & seen else _named_bus(pid, url)
            found.append(_lcm_process(pid, bus))
    return tuple(found)


def _named_bus(pid: int, url: BusUrl) -> str:
    """The bus that a process's variables name, where that is another multicast one."""
    with contextlib.suppress(LcmtoolsError):
        named, _ = choose_url("", "", _variables(pid))
        if named.is_multicast and (named.host, named.port) != (url.host, url.port):
            return f"{named.host}:{named.port}"
    return ""


def _variables(pid: int) -> dict[str, str]:
    entries = text_of(_PROC / str(pid) / "environ").split("\0")
    pairs = dict(entry.partition("=")[::2] for entry in entries if entry)
    return {name: pairs[name] for name in _VARIABLES if pairs.get(name)}


def _lcm_process(pid: int, bus: str) -> LcmProcess:
    process = process_of(pid)
    folder = _PROC / str(pid)
    limits = [line.split() for line in text_of(folder / "limits").splitlines()]
    most = next((row[3] for row in limits if row[:3] == ["Max", "open", "files"]), "0")
    open_files = 0
    with contextlib.suppress(OSError):
        open_files = sum(1 for _ in (folder / "fd").iterdir())
    return LcmProcess(
        pid,
        process.command if process else "",
        bus,
        next((f"{name}={value}" for name, value in _variables(pid).items()), ""),
        open_files,
        int(most) if most.isdigit() else 0,
        state_of(pid),
    )


def with_topics(processes: Iterable[LcmProcess], graph: Graph) -> tuple[LcmProcess, ...]:
    """The processes, those on other buses with the topics there.

    Other buses are looked at only if a subscription or all nodes are missing on this one.
    """
    every = tuple(processes)
    buses = sorted({process.bus for process in every if process.bus})
    is_missed = any(loose_ends(graph, Role.SUBSCRIBER)) or not any(
        not node.tool for node in graph.nodes
    )
    if not is_missed:
        return every
    topics = {bus: _topics(bus) for bus in buses[:_MOST_BUSES]}
    return tuple(replace(p, topics=topics.get(p.bus, ())) for p in every)


def _topics(bus: str) -> tuple[str, ...]:
    """The topics of another bus."""
    with (
        contextlib.suppress(LcmtoolsError),
        QuickProbe(parse_url(f"udpm://{bus}?ttl=0")) as quick_probe,
    ):
        time.sleep(_LISTEN)
        graph = quick_probe.graph()
        announced = {e.topic for node in graph.nodes for e in node.having(Role.PUBLISHER)}
        seen = {traffic.channel for traffic in graph.traffic}
        return tuple(sorted(name for name in announced | seen if not is_hidden(name)))
    return ()


class ProgramNames:
    """The names of senders and processes, for people."""

    def __init__(
        self, monitor: BusMonitor, listening: Listening, graph: Graph, table: SocketTable
    ) -> None:
        self.table = table
        self.by_pid: dict[int, list[Node]] = {}
        for node in graph.nodes:
            if is_here(node):
                self.by_pid.setdefault(node.pid, []).append(node)
        self.senders = SenderNames(lambda _: table, called=self.of_process)
        seen = {one.sender for one in listening.streams()}
        tap = monitor.tap
        self.senders.learn(seen | set(tap.sequences) | set(tap.malformed) if tap else seen)
        self.senders.learn((), graph.nodes)

    def pid(self, stream: Stream) -> int | None:
        """A sender's process on this computer."""
        if node := self.senders.node(stream.sender):
            return node.pid if is_here(node) else None
        process = self.senders.process(stream.sender)
        return process.pid if process else None

    def of_process(self, process: Process) -> str:
        """A process's nodes, or its command, with its number."""
        nodes = self.by_pid.get(process.pid, [])
        called = ", ".join(node.name for node in nodes) or process.called(_NAME_CHARACTERS)
        return f"{called} (pid {process.pid})"

    def malformed(self, monitor: BusMonitor) -> tuple[tuple[str, str], ...]:
        """The senders of datagrams that are not LCM's, with the reason."""
        found = []
        for sender, reason in (monitor.tap.malformed if monitor.tap else {}).items():
            process = self.senders.process(sender)
            who = f"{sender}, {self.of_process(process)}" if process else str(sender)
            found.append((who, reason))
        return tuple(found)
