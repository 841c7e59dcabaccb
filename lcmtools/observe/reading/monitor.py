"""The monitor of a bus or a log, which pulls packets and learns the graph from them.

It announces the topics that it listens to, as a node does with its subscriptions.
"""

import contextlib
import math
import os
import socket
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from lcmtools.bus.multicast import missing_route
from lcmtools.bus.network_watch import network_watch
from lcmtools.bus.processes import Process, is_local
from lcmtools.bus.records import NodeRecords, this_process
from lcmtools.bus.sockets import SocketTable, sockets_are_known
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.graph.builder import MOST_FLOWS, MOST_NODES, GraphBuilder
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness
from lcmtools.graph.protocol import (
    PERIOD,
    PROBE_CHANNEL,
    PROTOCOL_CHANNELS,
    SHUTDOWN_CHANNEL,
    Probe,
    Shutdown,
    encode_probe,
    encode_shutdown,
)
from lcmtools.observe.reading.losses import Losses, losses
from lcmtools.observe.reading.presence import Presence
from lcmtools.observe.reading.senders import is_here
from lcmtools.observe.reading.sources import LogObserver, Observer, open_observer
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:  # not needed for a bus
    from lcmtools.observe.reading.logs import Logs

QUIET = 0.03  # the graph counts as complete when no node has appeared for this time [s]
_AT_LEAST = 0.05  # [s] that nodes have to answer, several times as long as they need
_AT_LEAST_AFAR = 0.1  # [s] the same between computers: a wireless link may take some tens of ms
_AHEAD = 0.025  # [s] at most that count as waiting if the request was sent ahead
_AGAIN = 0.02  # [s] before a second request, if datagrams may be lost
_AT_MOST = 0.25  # [s] at most in addition, if nodes keep appearing
_NUMBERED = ("udpm", "zenoh", "file")  # providers whose messages have numbers, which show losses
_MOST_LISTENED = 2000  # topics in an announcement
_FOREIGN = 1.2  # [s] for programs that do not answer: a little more than one period at 1 Hz


class BusMonitor:
    """The monitor of a bus or a log.

    Args:
        url: The URL of the bus, or of a log.
        tool: The command's name, announced while it listens ("echo").
        environment: The process's environment variables.
        observer: The source of the messages; None for the best observer that the bus allows.
        whole: Assemble large messages; else only their heads are read (``Packet.whole_bytes``).
        plays: Play a log at its own speed; else it is read at once.
        on_outage: Called with a sentence when the connection to a server is lost or restored, and
            once when there is more on the bus than is remembered.
        on_shutdown: Called when another program requests this one to end; None to ignore that.
        asked: The time at which ``observer`` requested all nodes to announce themselves [s of
            ``time.monotonic``]; 0 if it has not.

    Raises:
        BusError: The bus cannot be reached; the error says what to type.
    """

    def __init__(  # noqa: PLR0913 - each is a separate option
        self,
        url: BusUrl,
        tool: str,
        environment: Mapping[str, str],
        observer: Observer | None = None,
        *,
        whole: bool = False,
        plays: bool = True,
        on_outage: Callable[[str], None] = lambda _: None,
        on_shutdown: Callable[[], None] | None = None,
        asked: float = 0.0,
    ) -> None:
        self.url = url
        self._asked = asked
        self.trouble = ""  # of the connection; "" for none
        self._on_outage = on_outage
        self._news: deque[str] = deque()  # of the network; appended to by its watch
        self._last_time, self._has_told = 0, False
        with contextlib.ExitStack() as opened:
            self._observer = observer or open_observer(
                url, whole=whole, plays=plays, on_outage=self._note_outage
            )
            opened.callback(self._observer.close)
            self.is_log, self.is_live = self._observer.is_log, self._observer.is_live
            self._records = NodeRecords(url, environment)
            node = this_process(f"/_lcmtools_{tool}_{os.getpid()}", tool=True)
            self._presence = Presence(node, self._observer.send, on_shutdown)
            self._builder = GraphBuilder(but=node.id, is_log=self.is_log)
            if self.logs:
                self._add_indexes(self.logs)
            self._news.extend(filter(None, [missing_route(url)]))
            network_watch.tell(self._news.append)
            opened.pop_all()

    def __enter__(self) -> "BusMonitor":
        """Use the monitor as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Say goodbye and leave the bus."""
        self.close()

    def close(self) -> None:
        """Say goodbye and leave the bus."""
        if self._is_present:
            self._presence.announce(leaving=True)
        network_watch.forget(self._news.append)
        self._observer.close()

    def listen_to(self, topics: Sequence[str]) -> None:
        """Announce that this command listens to these topics; does nothing on a log.

        If there are too many for an announcement, those without a known type are left out first.
        """
        if len(topics) > _MOST_LISTENED:
            topics = sorted(topics, key=lambda topic: not self.types_of(topic))[:_MOST_LISTENED]
        if not self.is_log:
            self._presence.listen_to([Endpoint(topic, Role.SUBSCRIBER) for topic in topics])

    def rewind(self) -> None:
        """Read a log again from its start; does nothing on a bus."""
        if isinstance(self._observer, LogObserver):
            self._observer.rewind()

    def receive(self, timeout: float) -> list[Packet]:
        """Return the messages that arrive within ``timeout`` seconds, learning the graph from them.

        Returns as soon as a message arrives; hidden channels are included.

        Raises:
            EOFError: The bus is a log, and it has ended.
        """
        if self._is_present:
            self._presence.attend()
        packets = self._observer.receive(timeout)
        self._tell_news()
        if not self.is_live:
            self._last_time = packets[-1].time
        for packet in self._builder.add_all(packets):
            if self._is_present:
                self._presence.answer(packet.channel, packet.payload)
        return packets

    def _tell_news(self) -> None:
        if self._builder.forgotten and not self._has_told:
            self._has_told = True
            self._on_outage(
                f"more than {MOST_FLOWS} channels or {MOST_NODES} nodes were on the bus, or many "
                "are silent: those that were silent longest are no longer listed"
            )
        while self._news:
            self._on_outage(self._news.popleft())

    def packets(self, duration: float | None = None) -> Iterator[Packet]:
        """Yield every packet as it comes, for ``duration`` [s]; None for without end.

        Ends at the end of a log; ``duration`` does not apply to one that is read at once.
        """
        deadline = math.inf if duration is None or not self.is_live else time.monotonic() + duration
        with contextlib.suppress(EOFError):
            while (left := deadline - time.monotonic()) > 0:
                yield from self.receive(min(PERIOD, left))

    def probe(self, target: str = "", nonce: int = 0) -> None:
        """Request a node, or all, to announce itself."""
        self._observer.send(PROBE_CHANNEL, encode_probe(Probe(target, nonce)))

    def ask(self) -> None:
        """Request all nodes to announce themselves, ahead of ``settle``, which waits for them."""
        self.probe()
        self._asked = time.monotonic()

    def ask_to_end(self, node: NodeInfo, nonce: int) -> None:
        """Request a node's program to end, as SIGTERM does; it answers with the nonce first."""
        requester = f"{' '.join(sys.argv)} (pid {os.getpid()} on {socket.gethostname()})"
        request = Shutdown(node.id, nonce, requester)
        self._observer.send(SHUTDOWN_CHANNEL, encode_shutdown(request))

    def discover(self) -> Graph:
        """Return the graph with all nodes that answer; at once for a log, where none can."""
        return self.graph() if self.is_log else self.settle(foreign=False)

    def settle(
        self,
        *,
        foreign: bool = True,
        wait: float | None = None,
        count: Callable[[Packet], None] = lambda _: None,
    ) -> Graph:
        """Request all nodes to announce themselves and wait until the graph is complete.

        A log that is read at once is read to its end.

        Args:
            foreign: Wait longer if programs that are not nodes publish or, on this computer, may be
                about to: these do not answer.
            wait: The time to listen for such programs, instead of ``foreign`` [s].
            count: Called with each packet that arrives during ``wait``, or in a log.
        """
        if self.is_live:
            self._await_nodes(foreign=foreign and wait is None)
        if wait is not None or not self.is_live:
            for packet in self.packets(wait):
                count(packet)
        return self.graph()

    def _request(self) -> float:
        """Request all nodes to announce themselves, unless ``ask`` did; return the time of that."""
        asked, self._asked = self._asked, 0.0
        if not asked:
            self.probe()
        now = time.monotonic()
        start = max(asked, now - _AHEAD) if asked else now
        if self._is_between_computers:
            # the request or an answer may be lost, but seldom both of two
            deque(self.packets(start + _AGAIN - now), maxlen=0)
            self.probe()
            start = time.monotonic()
        return start

    def _await_nodes(self, *, foreign: bool) -> None:
        start = changed = self._request()
        soonest = start + (_AT_LEAST_AFAR if self._is_between_computers else _AT_LEAST)
        with contextlib.suppress(EOFError):  # the graph of a log that has ended is complete
            # if this process itself was delayed, messages that came meanwhile still count
            while (
                time.monotonic() <= min(max(soonest, changed + QUIET), soonest + _AT_MOST)
                or self._observer.is_awaiting
                or self._receives_talk(0.0)
                or self._awaits_knthis_process()
            ):
                if time.monotonic() - start > _FOREIGN:
                    self._recall()
                    break
                if self._receives_talk(QUIET / 2):
                    changed = time.monotonic()
        # programs of another computer are known only by their messages, or told of by a relay
        if foreign and self.url.is_multicast and not self._is_between_computers:
            self._await_foreign(start + _FOREIGN)
        elif foreign and (self._observer.has_strangers or self._is_between_computers):
            deque(self.packets(start + _FOREIGN - time.monotonic()), maxlen=0)

    def graph(self) -> Graph:
        """Return the graph as known now; for a log that is read at once, at its last message."""
        return self._builder.snapshot(time.time_ns() if self.is_live else self._last_time)

    @property
    def send_trouble(self) -> str:
        """The reason why the last announcement was not sent; "" for none."""
        return self._presence.trouble

    @property
    def _is_between_computers(self) -> bool:
        return self.url.is_multicast and self.url.ttl > 0

    @property
    def _is_present(self) -> bool:
        """True once it listens to topics, and is thus visible to others."""
        return bool(self._presence.node.endpoints)

    @property
    def tap(self) -> Tap | None:
        """The tap, which knows the senders' datagrams; None if the bus is not multicast."""
        return self._observer if isinstance(self._observer, Tap) else None

    @property
    def knows_losses(self) -> bool:
        """False on a bus that does not number messages, as tcpq."""
        return self.url.provider in _NUMBERED

    @property
    def logs(self) -> "Logs | None":
        """The logs that are read at once; None if the source is a bus."""
        return self._observer.logs if isinstance(self._observer, LogObserver) else None

    def losses(self, since: Losses | None = None) -> Losses:
        """Return the loss of each sender, since an earlier count; empty if none is known."""
        if self.logs:
            return self.logs.losses()
        return losses(self._observer.numbered, since)

    def types_of(self, channel: str) -> tuple[str, ...]:
        """Return the types that nodes announce for a channel."""
        return self._builder.types_of(channel)

    def forget(self, node: NodeInfo) -> None:
        """Drop a stale node and its record."""
        self._builder.forget(node.id)
        self._records.remove(node.id)

    def _add_indexes(self, logs: "Logs") -> None:
        """Add the nodes and types that the indexes of logs have."""
        from lcmtools.packages import provide_recorded_types

        for packet in logs.announcements():
            self._builder.add(packet)
        provide_recorded_types(logs.types())

    def _note_outage(self, text: str, trouble: str) -> None:
        self.trouble = trouble
        if not trouble and self._is_present:
            self._presence.announce()
        self._on_outage(text)

    def _receives_talk(self, timeout: float) -> bool:
        return any(packet.channel in PROTOCOL_CHANNELS for packet in self.receive(timeout))

    def _recall(self) -> None:
        """Learn of the nodes of this computer that left a record and have not answered."""
        here, silent = socket.gethostname(), self._records.read(but=self._builder.heard())
        self._builder.recall(node for node in silent if node.host == here)

    def _awaits_knthis_process(self) -> bool:
        """True while a node of this computer that left a record and runs may answer late.

        A computer with many busy programs runs each only now and then.
        """
        self._recall()
        silent = (node for node in self.graph().nodes if node.stale is Staleness.HANGS)
        return any(not Process(node.pid).is_stopped for node in silent)

    def _await_foreign(self, deadline: float) -> None:
        """Listen while there may be programs that do not tell their channels.

        Listens to the deadline if one publishes, or if a node's details cannot be read.
        A program's channels show only in its messages, and the first shows only one of many.
        """
        while (left := deadline - time.monotonic()) > 0:
            ports = {s.port for s in self._builder.senders() if is_local(s.address)}
            ports.add(self._observer.port)
            graph = self.graph()
            is_foreign = any(not seen.observer for seen in graph.foreign())
            if is_foreign or graph.unexplained() or not sockets_are_known():
                deque(self.packets(left), maxlen=0)
                return
            known = {node.pid for node in graph.nodes if is_here(node)}
            if not SocketTable.read().silent_senders(self.url, ports, known):
                return
            self.receive(min(left, 0.1))
