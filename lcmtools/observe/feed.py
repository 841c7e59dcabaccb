"""What the live view is fed with: a thread that reads the bus and makes rows of it.

Must not know the screen: that takes the latest snapshot when it wants to draw.
"""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

from lcmtools.cli.spy.once import plain_listeners
from lcmtools.errors import BusError, LcmtoolsError
from lcmtools.graph.model import Graph
from lcmtools.observe.activity import Activity
from lcmtools.observe.channels import Losses, Row, Rows, Wanted, losses
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.senders import SenderNames
from lcmtools.wire.packet import Packet

PERIOD = 0.4
"""[s] between two snapshots."""
_WINDOW = 2.0  # [s] that rates are about
_SOON = 0.1  # [s] between the first few, and at most that the bus is waited for
_FIRST = 10  # snapshots; while the screen is being made, this process itself may miss messages
_SELDOM = 3.0  # [s] between two looks at who listens, which goes through all processes
_AGAIN = 0.5  # [s] before a network that fails is tried again


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What is known of a bus at one time.

    Attributes:
        rows: What is known of each channel, by its name.
        plain_listeners: The programs that listen as no nodes, to nobody knows what.
        trouble: Why nothing comes; "" where all is well.
        is_over: Nothing will come any more.
    """

    rows: tuple[Row, ...] = ()
    plain_listeners: tuple[str, ...] = ()
    trouble: str = ""
    is_over: bool = False

    @property
    def rate(self) -> float:
        """Messages a second on all channels [Hz]."""
        return sum(row.rate or 0.0 for row in self.rows)

    @property
    def bandwidth(self) -> float:
        """Bytes a second on all channels."""
        return sum(row.bandwidth or 0.0 for row in self.rows)

    def row(self, channel: str) -> Row:
        """A channel's row; an empty one where nothing is known of it."""
        return next((row for row in self.rows if row.channel == channel), Row(channel))


class Feed:
    """Reads a bus on a thread of its own.

    Args:
        watch: The bus; nobody else may use it from ``start`` to ``stop``.
        wanted: Which channels have a row.
    """

    def __init__(self, monitor: BusMonitor, wanted: Wanted) -> None:
        self.url = monitor.url
        self.latest = Snapshot()
        """The latest snapshot; another object each time."""
        self.follow: Callable[[Packet], None] | None = None
        """Is given every packet, on the feed's thread."""
        self._monitor = monitor
        self._activity = Activity(_WINDOW)
        self._rows = Rows(wanted, SenderNames())
        self._before: Losses = {}
        self._heard: list[str] = []
        self._listeners: tuple[str, ...] = ()
        self._next_look = 0.0
        self._count = 0
        self._clears = threading.Event()
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="spy feed", daemon=True)

    def start(self) -> None:
        """Begin to read."""
        self._thread.start()

    def stop(self) -> None:
        """Read no more."""
        self._ends.set()
        self._thread.join(2.0)

    def clear(self) -> None:
        """Count everything anew."""
        self._clears.set()

    def _run(self) -> None:
        try:
            self._read()
        except EOFError:
            self.latest = replace(self._snapshot(), trouble="the log has ended", is_over=True)
        except LcmtoolsError as error:
            self.latest = replace(self.latest, trouble=str(error), is_over=True)
        except Exception as error:  # noqa: BLE001 - told on the screen, not in a thread's last words
            what = f"a fault of lcmtools ({type(error).__name__}: {error})"
            self.latest = replace(self.latest, trouble=what, is_over=True)

    def _read(self) -> None:
        """Read until the end.

        Raises:
            EOFError: The bus is a log, and it has ended.
        """
        if self.url.provider != "file":
            with suppress(BusError, OSError):  # a network that fails now may come back
                self._monitor.settle(foreign=False)
        next_snapshot = 0.0
        while not self._ends.is_set():
            trouble = self._hear()
            now = time.monotonic()
            if now >= next_snapshot or trouble:
                self.latest = replace(self._snapshot(), trouble=trouble)
                self._count += 1
                if self._count == _FIRST:
                    self._before = self._losses() or {}
                next_snapshot = now + (PERIOD if self._count > _FIRST else _SOON)

    def _hear(self) -> str:
        """Take what has come into account; what is wrong with the network, if anything."""
        try:
            packets = self._monitor.receive(_SOON)
        except (BusError, OSError) as error:
            self._ends.wait(_AGAIN)
            return getattr(error, "strerror", None) or str(error)
        if self._clears.is_set():
            self._clear()
        follow = self.follow
        for packet in packets:
            self._activity.hear(packet)
            if follow is not None:
                follow(packet)
        return self._monitor.trouble

    def _clear(self) -> None:
        self._clears.clear()
        self._activity.clear()
        self._before = self._losses() or {}

    def _losses(self, since: Losses | None = None) -> Losses | None:
        """What was lost of each sender; None where the bus does not tell."""
        tap = self._monitor.tap
        return losses(tap.numbered, since) if tap else None

    def _snapshot(self) -> Snapshot:
        graph = self._monitor.graph()
        lost = self._losses(self._before) if self._count >= _FIRST else None
        found = self._rows.make(graph, self._activity, lost, graph.time)
        self._listen_to(self._rows.published(graph))
        return Snapshot(found, self._look(graph))

    def _listen_to(self, channels: list[str]) -> None:
        """Say what is listened to."""
        if channels != self._heard and self.url.provider != "file":
            self._heard = channels
            self._monitor.listen_to(channels)

    def _look(self, graph: Graph) -> tuple[str, ...]:
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + _SELDOM
            self._listeners = tuple(plain_listeners(graph, self.url))
        return self._listeners
