"""Threads that read a bus for a live view, which draws their latest snapshot."""

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

from lcmtools.bus.listeners import listening_sockets
from lcmtools.bus.tap import LONG_NAP
from lcmtools.errors import BusError, LcmtoolsError
from lcmtools.graph.model import Graph
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
_MOST_KEPT = 10_000  # channels, in case a program keeps inventing names
_SELDOM = 3.0  # [s] between two checks of who listens
_AGAIN = 0.5  # [s] before a failed network is tried again


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a bus at one time."""

    rows: tuple[ChannelRow, ...] = ()  # its channels, sorted by name
    # The programs that listen but are not nodes; their channels are unknown.
    plain_listeners: tuple[str, ...] = ()
    callback_errors: tuple[str, ...] = ()  # errors of nodes' callbacks, a sentence each
    trouble: str = ""  # the reason why no message arrives; "" if all is well
    is_over: bool = False  # True if no more messages will arrive
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
        keeps_last: Keep the last message of each channel, so that ``follow`` begins with a latched
            one: its publisher does not send it again to a node that has received it.
    """

    def __init__(
        self, monitor: BusMonitor, selection: ChannelSelection, period: float = _PERIOD
    ) -> None:
        self.latest = Snapshot()
        self.on_snapshot: Callable[[], object] = lambda: None
        self._period = period
        self._monitor = monitor
        if monitor.tap:
            monitor.tap.longest_nap = LONG_NAP
        self.listens_to_all = self.listens_to_large = True
        self.keeps_last = False
        self._last: dict[str, Packet] = {}
        self._following = Following(monitor.url)
        self._activity = Activity(_WINDOW)
        self._rows = ChannelRows(selection, SenderNames())
        self._before: Losses = {}
        self._subscribed: list[str] = []
        self._published: Sequence[str] = ()
        self._listeners: tuple[str, ...] = ()
        self._known: tuple[frozenset[int], set[str]] = frozenset(), set()
        self._next_look = self._next_snapshot = 0.0
        self._count = 0
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
        last = self._last.get(channel)
        if last is not None and self.latest.graph.topic(channel).is_latched:
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
                self._next_snapshot = now + (_SOON if is_soon else self._period)

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
        if len(self._activity) > known:
            self._next_snapshot = 0.0
        if self._following.channels:
            for packet in packets:
                self._following.pass_on(packet)
        if self.keeps_last:
            self._keep(packets)
        self._announce()
        return self._monitor.trouble

    def _keep(self, packets: Sequence[Packet]) -> None:
        if len(self._last) > _MOST_KEPT:
            self._last.clear()
        self._last.update((one.channel, one) for one in packets if one.whole_bytes is None)

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
        rows = self._rows.make(graph, self._activity, lost, graph.time)
        self._published = self._rows.published(graph, large=self.listens_to_large)
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + _SELDOM
            known = listening_sockets(self._monitor.url), {node.id for node in graph.nodes}
            if known != self._known:  # finding the processes means searching all
                self._known = known
                self._listeners = tuple(plain_listeners(graph, self._monitor.url))
        errors = tuple(all_callback_errors(graph))
        return Snapshot(rows, self._listeners, errors, graph=graph)
