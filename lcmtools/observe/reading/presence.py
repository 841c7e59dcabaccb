"""The presence on a bus of a node that is not a ``Node``: a command, a server or a relay.

It announces itself as nodes do: once a second, when it is asked, and when it leaves.
"""

import time
from collections.abc import Callable, Sequence

from lcmtools.bus.records import NodeRecords
from lcmtools.errors import BusError
from lcmtools.graph.announcing import Announcing
from lcmtools.graph.model import Endpoint, FullLine, NodeInfo, Traffic
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    SHUTDOWN_CHANNEL,
    Announcement,
    Probe,
    decode_probe,
    decode_shutdown,
    encode_announcement,
)


class Presence:
    """The announcements of one node on one bus; the code that receives from the bus calls it.

    ``send`` publishes a payload on a channel, and raises BusError if it cannot; ``on_shutdown`` is
    called when another program requests this one to end. ``records`` holds records of running
    nodes.
    """

    def __init__(
        self,
        node: NodeInfo,
        send: Callable[[str, bytes], None],
        on_shutdown: Callable[[], None] | None = None,
        records: NodeRecords | None = None,
    ) -> None:
        self.node = node  # as announced
        self._records, self._is_recorded = records, False
        self.trouble = ""  # the reason why the last announcement was not sent
        self.send, self._on_shutdown = send, on_shutdown
        self._schedule = Announcing(time.monotonic())

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
        for nonce in self._schedule.take(time.monotonic()).values():
            self.announce(answers=nonce)

    def answer(self, channel: str, payload: bytes) -> None:
        """Answer a message of the protocol, if it is for this node."""
        if channel == PROBE_CHANNEL:
            probe = decode_probe(payload)
            if probe is not None and probe.target in ("", self.node.name):
                self._schedule.ask(Probe(nonce=probe.nonce), time.monotonic())
                self.attend()
        elif channel == SHUTDOWN_CHANNEL:
            request = decode_shutdown(payload)
            if self._on_shutdown and request is not None and request.target == self.node.id:
                self.announce(answers=request.nonce)
                self._on_shutdown()

    def announce(self, *, leaving: bool = False, answers: int = 0) -> None:
        """Announce the node now."""
        if self._records and leaving:
            self._records.remove(self.node.id)
        elif self._records and not self._is_recorded:
            self._records.write(self.node)
            self._is_recorded = True
        announcement, began = Announcement(self.node, leaving, answers), time.thread_time()
        # a failed network may come back: the next announcement follows a period later
        try:
            self.send(NODE_CHANNEL, encode_announcement(announcement))
            self.trouble = ""
        except BusError as error:
            self.trouble = str(error)
        self._schedule.rest(time.monotonic(), time.thread_time() - began)


def _flows(node: NodeInfo) -> set[tuple[object, ...]]:
    return {(x.channel, x.sender, x.fingerprints, x.types) for x in node.observed}
