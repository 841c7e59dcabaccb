"""Asking nodes to end, and finding out whether they do."""

import secrets
import time
from dataclasses import dataclass

from lcmtools.bus.processes import process_of
from lcmtools.graph.model import Node
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, decode_announcement
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.programs import is_here

_ASK_AGAIN = 0.5  # [s]; any message on LCM may be lost


@dataclass(slots=True)
class Ending:
    """How it goes with one node that was asked to end.

    Attributes:
        node: The node.
        nonce: What its answer repeats.
        heard: It has answered that it was asked.
        ended: It has said goodbye, or its process is gone.
        others: The names of other nodes of its process, which end with it.
    """

    node: Node
    nonce: int
    heard: bool = False
    ended: bool = False
    others: tuple[str, ...] = ()

    def learn(self, announcement: Announcement) -> None:
        """Learn from what was announced."""
        if announcement.node.id == self.node.id:
            self.heard = self.heard or announcement.answers == self.nonce
            self.ended = self.ended or announcement.leaving

    def look_at_process(self) -> None:
        """Learn from this computer's processes: a goodbye may be lost."""
        if is_here(self.node) and process_of(self.node.pid) is None:
            self.ended = True

    def complaint(self, timeout: float) -> tuple[str, str]:
        """What is the matter with a node that does not end, and what to type."""
        if self.heard:
            what = f"{self.node.name} was asked and has not ended within {timeout:g} s"
        else:
            what = f"{self.node.name} does not answer"
        where = "" if is_here(self.node) else f"on {self.node.host}, "
        return what, f"{where}to end it whatever it does, type: kill -9 {self.node.pid}"


def place_of(node: Node) -> tuple[str, str, int]:
    """Which process a node is; computers may have the same name, and often have the same pids."""
    return node.host, node.sender.address if node.sender else "", node.pid


def end_nodes(monitor: BusMonitor, nodes: list[Node], timeout: float) -> list[Ending]:
    """Ask nodes to end and wait until they have, for ``timeout`` seconds at most."""
    known = monitor.graph().nodes
    endings = [Ending(node, secrets.randbits(62) | 1, others=_with(node, known)) for node in nodes]
    deadline, ask = time.monotonic() + timeout, 0.0
    while (now := time.monotonic()) < deadline and (left := _left(endings)):
        if now >= ask:
            ask = now + _ASK_AGAIN
            for ending in left:
                ending.look_at_process()
                monitor.ask_to_end(ending.node, ending.nonce)
        _listen(monitor, endings, min(ask, deadline) - now)
    for ending in _left(endings):
        ending.look_at_process()
    return endings


def _left(endings: list[Ending]) -> list[Ending]:
    return [ending for ending in endings if not ending.ended]


def _listen(monitor: BusMonitor, endings: list[Ending], seconds: float) -> None:
    for packet in monitor.receive(seconds):
        if packet.channel == NODE_CHANNEL and (said := decode_announcement(packet.payload)):
            for ending in endings:
                ending.learn(said)


def _with(node: Node, known: tuple[Node, ...]) -> tuple[str, ...]:
    """The names of the other nodes of a node's process."""
    return tuple(
        other.name
        for other in known
        if place_of(other) == place_of(node) and other.id != node.id and not other.stale
    )
