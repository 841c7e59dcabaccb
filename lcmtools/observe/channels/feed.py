"""Threads that read a bus for a live view, which draws their latest snapshot."""

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import count

from lcmtools.bounded import BoundedDict
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.tap import LONG_NAP
from lcmtools.errors import BusError, LcmtoolsError
from lcmtools.graph.model import Graph
from lcmtools.graph.protocol import PROTOCOL_CHANNELS
from lcmtools.observe.channels.activity import Activity
from lcmtools.observe.channels.rows import (
    ChannelRow,
    ChannelRows,
    ChannelSelection,
    plain_listeners,
)
from lcmtools.observe.reading.following import Following
from lcmtools.observe.reading.losses import Losses
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.observe.reports.describe import all_callback_errors
from lcmtools.wire.packet import Packet

_PERIOD = 0.4  # [s] between two snapshots, unless another time is given
_WINDOW = 2.0  # [s] over which rates are measured
_SOON = 0.1  # [s] between the first few, and the longest wait for the bus
_FIRST = 10  # snapshots without losses: while the screen is set up, this process may miss messages
_MOST_KEPT_BYTES = 256_000_000  # last messages of channels
_LOG = "/rosout"
_MOST_LINES, _MOST_LINES_BYTES = 400, 4_000_000  # last messages of the nodes' log
_MOST_ROWS = 1000  # of the table
_SHARE = 100  # a snapshot takes at most this part (1/100) of the time ...
_LONGEST_PERIOD = 2.0  # ... unless there is so much that it would be older than this [s]
_MANY, _QUIET_PERIOD = 300, 10.0
"""So many rows that are all silent are renewed this often [s]: only their ages change."""
_SELDOM = 3.0  # [s] between two checks of who listens
_AGAIN = 0.5  # [s] before a failed network is tried again


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a bus at one time."""

    rows: tuple[ChannelRow, ...] = ()  # its channels, sorted by name; not all if there are many
    # The programs that listen but are not nodes; their channels are unknown.
    plain_listeners: tuple[str, ...] = ()
    callback_errors: tuple[str, ...] = ()  # errors of nodes' callbacks, a sentence each
    trouble: str = ""  # the reason why no message arrives; "" if all is well
    is_over: bool = False  # True if no more messages will arrive
    left_out: int = 0  # number of channels without a row
    graph: Graph = field(default_factory=Graph, repr=False)

    @property
    def rate(self) -> float:
        """Message rate of all channels [Hz]."""
        return sum(row.rate or 0.0 for row in self.rows)

    @property
    def bandwidth(self) -> float:
        """Bytes per second of all channels."""
        return sum(row.bandwidth or 0.0 for row in self.rows)

    def row(self, channel: str) -> ChannelRow:
        """Return a channel's row; an empty one if it is unknown."""
        return next((row for row in self.rows if row.channel == channel), ChannelRow(channel))


class Feed:
    """A thread that reads a bus, with its own monitor; it does not close the bus.

    A snapshot of the channels of ``selection`` is made every ``period`` [s], and at once for a new
    channel.

    Attributes:
        latest: The latest snapshot; a new object each time.
        on_snapshot: Called on this thread when there is a new snapshot.
        listens_to_all: Announce that it listens to all channels with a row, because some nodes
            publish only for a subscriber; if False, only to followed channels.
        listens_to_large: If it listens to all, include channels of images and clouds.
        keeps_last: It keeps the last message of each channel, whatever its size, so that
            ``follow`` begins with one that was latched or said once: its publisher does not send it
            again to a node that has received it. Of the nodes' log, it keeps some hundred lines.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        selection: ChannelSelection,
        period: float = _PERIOD,
        *,
        keeps_last: bool = False,
    ) -> None:
        self.latest = Snapshot()
        self.on_snapshot: Callable[[], object] = lambda: None
        self._period = period
        self._monitor = monitor
        if monitor.tap:
            monitor.tap.longest_nap = LONG_NAP
        self.listens_to_all = self.listens_to_large = True
        self.keeps_last = keeps_last
        self._last = BoundedDict[str, Packet](most_bytes=_MOST_KEPT_BYTES)
        self._lines = BoundedDict[int, Packet](_MOST_LINES, _MOST_LINES_BYTES)
        self._numbers = count()
        self._keeping = threading.Lock()
        self._following = Following(monitor.url, self._keep if keeps_last else None)
        self._activity = Activity(_WINDOW)
        self._rows = ChannelRows(selection, SenderNames())
        self._before: Losses = {}
        self._subscribed: list[str] = []
        self._published: Sequence[str] = ()
        self._listeners: tuple[str, ...] = ()
        self._known: tuple[frozenset[int], set[str]] = frozenset(), set()
        self._next_look = self._next_snapshot = 0.0
        self._count, self._cost = 0, 0.0  # of the snapshots so far; of the last one [s]
        self._is_quiet = False  # True if many channels have a row, and all were silent
        self._clears = threading.Event()
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="spy feed", daemon=True)

    def start(self) -> None:
        """Begin to read."""
        self._thread.start()

    def stop(self) -> None:
        """Stop reading."""
        self._ends.set()
        self._following.close()
        self._thread.join(2.0)

    def clear(self) -> None:
        """Restart counting from zero."""
        self._clears.set()

    def follow(self, channel: str, receive: Callable[[Packet], None]) -> Callable[[], None]:
        """Pass on a channel's whole messages, on another thread; return a call to end it.

        The feed itself reads only the heads of large messages: on a multicast bus, a second tap
        reads the whole messages of all followed channels.
        """
        if channel == _LOG:
            with self._keeping:
                lines = list(self._lines.values())
            for line in lines:
                receive(line)
            return self._following.add(channel, receive)
        last = self._last.get(channel)
        latest = self.latest
        topic = latest.graph.topic(channel)
        if last is not None and (
            topic.is_latched
            or not latest.row(channel).rate
            or all(last.time >= seen.last_time for seen in topic.traffic)  # no other may follow
        ):
            receive(last)
        return self._following.add(channel, receive)

    def _run(self) -> None:
        try:
            self._read()
        except EOFError:
            self._update(replace(self._snapshot(), trouble="the log has ended", is_over=True))
        except LcmtoolsError as error:
            self._update(replace(self.latest, trouble=str(error), is_over=True))
        except Exception as error:  # noqa: BLE001 - shown on the screen, not as a traceback
            what = f"a fault of lcmtools ({type(error).__name__}: {error})"
            self._update(replace(self.latest, trouble=what, is_over=True))

    def _update(self, snapshot: Snapshot) -> None:
        self.latest = snapshot
        self.on_snapshot()

    def _read(self) -> None:
        with suppress(BusError, OSError):  # a network that has failed may come back
            self._monitor.discover()
        while not self._ends.is_set():
            trouble = self._receive()
            now = time.monotonic()
            if now >= self._next_snapshot or trouble:
                self._update(replace(self._snapshot(), trouble=trouble))
                self._count += 1
                if self._count == _FIRST:
                    self._before = self._monitor.losses()
                is_soon = trouble or self._count <= _FIRST
                self._cost = time.monotonic() - now
                pause = max(_SOON if is_soon else self._period, _SHARE * self._cost)
                self._is_quiet = not is_soon and _are_many_and_silent(self.latest.rows)
                pause = min(pause, max(self._period, _LONGEST_PERIOD))
                self._next_snapshot = now + (_QUIET_PERIOD if self._is_quiet else pause)

    def _receive(self) -> str:
        """Count what has arrived; return the network's problem, "" for none."""
        try:
            packets = self._monitor.receive(_SOON)
        except (BusError, OSError) as error:
            self._ends.wait(_AGAIN)
            return getattr(error, "strerror", None) or str(error)
        if self._clears.is_set():
            self._clears.clear()
            self._activity.clear()
            self._before = self._monitor.losses()
            self._next_snapshot = 0.0
        known = len(self._activity)
        for packet in packets:
            self._activity.add(packet)
        is_new = len(self._activity) > known and self._cost < _SOON / _SHARE
        if is_new or (
            self._is_quiet and any(one.channel not in PROTOCOL_CHANNELS for one in packets)
        ):
            self._next_snapshot = 0.0
        if self._following.channels:
            for packet in packets:
                self._following.pass_on(packet)
        if self.keeps_last:
            self._keep_last(packets)
        self._announce()
        return self._monitor.trouble

    def _keep_last(self, packets: Sequence[Packet]) -> None:
        whole = [one for one in packets if one.whole_bytes is None]
        latest = {one.channel: one for one in whole if one.channel != _LOG}
        for packet in (*latest.values(), *(one for one in whole if one.channel == _LOG)):
            self._keep(packet)

    def _keep(self, packet: Packet) -> None:
        """Keep a whole message in place of its channel's previous one, unless it is a log line."""
        with self._keeping:  # on two threads
            if packet.channel == _LOG:
                self._lines.put(next(self._numbers), packet, len(packet.payload))
            else:
                self._last.put(packet.channel, packet, len(packet.payload))

    def _announce(self) -> None:
        wanted = sorted(
            {*self._following.channels, *(self._published if self.listens_to_all else ())}
        )
        if wanted != self._subscribed:
            self._subscribed = wanted
            self._monitor.listen_to(wanted)

    def _snapshot(self) -> Snapshot:
        graph = self._monitor.graph()
        lost = self._monitor.losses(self._before) if self._count >= _FIRST else {}
        rows, left_out = self._rows.make_most(_MOST_ROWS, graph, self._activity, lost)
        self._published = self._rows.published(graph, large=self.listens_to_large)
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + _SELDOM
            sockets = SocketTable.read().listening(self._monitor.url)
            known = sockets, {node.id for node in graph.nodes}
            if known != self._known:  # finding the processes means searching all
                self._known = known
                self._listeners = tuple(plain_listeners(graph, self._monitor.url))
        errors = tuple(all_callback_errors(graph))
        return Snapshot(rows, self._listeners, errors, left_out=left_out, graph=graph)


def _are_many_and_silent(rows: Sequence[ChannelRow]) -> bool:
    return len(rows) >= _MANY and all(row.is_silent for row in rows)
