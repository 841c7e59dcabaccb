"""The presence on a bus of a node that is not a ``Node``: a command, a server or a relay.

It announces itself as nodes do: once a second, when it is asked, and when it leaves.
"""

import os
import socket
import sys
import time
from collections.abc import Callable, Sequence

from lcmtools.bus.kernel import own_pid_namespace
from lcmtools.bus.records import NodeRecords
from lcmtools.errors import BusError
from lcmtools.graph.model import Endpoint, FullLine, Node, Traffic
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PERIOD,
    PROBE_CHANNEL,
    SHUTDOWN_CHANNEL,
    SOFTWARE,
    Announcement,
    decode_probe,
    decode_shutdown,
    encode_announcement,
)

_REST = 10  # rest for this many times the CPU time of an announcement before another answer


class Presence:
    """The announcements of one node on one bus; the code that receives from the bus calls it.

    ``send`` publishes a payload on a channel, and raises BusError if it cannot; ``on_shutdown`` is
    called when another program requests this one to end. ``records`` holds records of running
    nodes.
    """

    def __init__(
        self,
        node: Node,
        send: Callable[[str, bytes], None],
        on_shutdown: Callable[[], None] | None = None,
        records: NodeRecords | None = None,
    ) -> None:
        self.node = node  # as announced
        self._records = records
        self.trouble = ""  # the reason why the last announcement was not sent
        self.send, self._on_shutdown = send, on_shutdown
        self._next = self._rested = 0.0
        self._worked = 0.0  # CPU time of the latest announcement [s]; the first one imports modules
        self._owed = 0  # the nonce of a probe that is answered later

    def listen_to(self, endpoints: Sequence[Endpoint]) -> None:
        """Announce other endpoints."""
        self.node = self.node._replace(endpoints=tuple(endpoints))
        self.announce()

    def tell(self, observed: Sequence[Traffic], full_lines: tuple[FullLine, ...] = ()) -> None:
        """Announce what was observed of programs that are not nodes, at once if they changed.

        Also the lines that are full.
        """
        before = self.node
        self.node = before._replace(observed=tuple(observed), full_lines=full_lines)
        if _flows(before) != _flows(self.node):
            self.announce()

    def attend(self) -> None:
        """Announce the node if it is due."""
        if time.monotonic() >= self._next:
            self.announce(answers=self._owed)

    def answer(self, channel: str, payload: bytes) -> None:
        """Answer a message of the protocol, if it is for this node."""
        if channel == PROBE_CHANNEL:
            probe = decode_probe(payload)
            if probe is not None and probe.target in ("", self.node.name):
                self._answer_probe(probe.nonce)
        elif channel == SHUTDOWN_CHANNEL:
            request = decode_shutdown(payload)
            if self._on_shutdown and request is not None and request.target == self.node.id:
                self.announce(answers=request.nonce)
                self._on_shutdown()

    def _answer_probe(self, nonce: int) -> None:
        """Answer now, or a little later if probes come so often that answers would take long."""
        if time.monotonic() >= self._rested:
            self.announce(answers=nonce)
        else:
            self._owed = nonce or self._owed
            self._next = min(self._next, self._rested)

    def announce(self, *, leaving: bool = False, answers: int = 0) -> None:
        """Announce the node now."""
        if self._records and leaving:
            self._records.remove(self.node.id)
        elif self._records and not self._next:  # the first time
            self._records.write(self.node)
        announcement, began = Announcement(self.node, leaving, answers), time.thread_time()
        # a failed network may come back: the next announcement follows a period later
        try:
            self.send(NODE_CHANNEL, encode_announcement(announcement))
            self.trouble = ""
        except BusError as error:
            self.trouble = str(error)
        now = time.monotonic()
        self._owed, self._next = 0, now + PERIOD
        worked = time.thread_time() - began
        self._rested = now + min(PERIOD, _REST * min(worked, self._worked))
        self._worked = worked


def _flows(node: Node) -> set[tuple[object, ...]]:
    return {(x.channel, x.sender, x.fingerprints, x.types) for x in node.observed}


def own_node(name: str, *, tool: bool) -> Node:
    """Return this process as a node of this name; a tool is a command that only observes."""
    return Node(
        name=name,
        id=f"{os.getpid()}-{time.time_ns():x}",
        host=socket.gethostname(),
        pid=os.getpid(),
        start_time=time.time_ns(),
        command=" ".join(sys.argv),
        tool=tool,
        software=SOFTWARE,
        pid_namespace=own_pid_namespace(),
    )
