"""The names of senders and processes in findings: a node's, else a command with its number."""

from lcmtools.bus.processes import Process
from lcmtools.doctor.evidence import Stream
from lcmtools.doctor.listening import Listening
from lcmtools.graph.model import Graph, Node
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.programs import is_here
from lcmtools.observe.senders import SenderNames, SocketTable

_NAME_CHARACTERS = 60


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
