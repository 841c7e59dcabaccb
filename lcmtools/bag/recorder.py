"""Recording messages from a bus into logs, with the facts for their index.

One thread reads the bus, so that reading never waits for a disk; another one writes.
"""

import bisect
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass

from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.index_notes import IndexNotes
from lcmtools.bag.ring import Ring, SnapshotPlan
from lcmtools.bag.series import LogSeries
from lcmtools.bag.writer import LogWriter
from lcmtools.bus.processes import buffer_overflows
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.clock import NANOSECONDS
from lcmtools.errors import BusError, LcmtoolsError
from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.observe.reading.arrivals import PATIENCE
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.processes.memory import keep_freed_memory
from lcmtools.wire.packet import Packet

_WRITE_PERIOD = 0.1  # [s]
_FRAME_PERIOD = 1.0  # [s] for a compressed log: larger frames compress better
_WRITE_BYTES = 4 << 20  # are written at a time
_MOST_WAITING = 256 << 20  # bytes, after which reading waits for the disk
_LOOK_PERIOD = 0.25  # [s] between updates of nodes, names and losses
_LONGEST_NAP = 0.004  # [s] that messages wait to be read together; buffers have room for more
_DRAIN = 0.5  # [s] at the end, for messages whose times of arrival the bus does not know


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a recording and of its files; None for no limit."""

    duration: float | None = None  # of the whole recording [s]
    messages: int | None = None  # of each topic
    bytes: int | None = None  # of all files together
    split_time: float | None = None  # of a file [s]
    split_bytes: int | None = None  # of a file


@dataclass(frozen=True, slots=True)
class Progress:
    """The state of a recording at one time."""

    messages: int
    bytes: int  # of all files
    files: int
    losses: Mapping[str, Loss]  # by the sender's name; only senders with losses
    overflows: int = 0  # datagrams that full receive buffers dropped, at most
    trouble: str = ""  # problem with the bus; "" for none
    is_paused: bool = False
    is_writing: bool = True  # False while messages are only kept for a snapshot
    kept_messages: int = 0  # number of messages kept for a snapshot
    kept_bytes: int = 0
    losses_are_known: bool = True  # False on a bus that does not number messages


_NO_LIMITS = Limits()


def open_bus(
    url: BusUrl,
    environment: Mapping[str, str],
    on_outage: Callable[[str], None] = lambda _: None,
    on_shutdown: Callable[[], None] | None = None,
) -> BusMonitor:
    """Return the monitor that a recorder needs: with all messages, assembled.

    Raises:
        BusError: The bus cannot be reached; the error says what to type.
    """
    keep_freed_memory()
    tap = Tap(url, whole=True, spread=True) if url.is_multicast else None
    if tap is not None:
        tap.longest_nap = _LONGEST_NAP
    return BusMonitor(
        url, "record", environment, tap, whole=True, on_outage=on_outage, on_shutdown=on_shutdown
    )


class BagRecorder(AbstractContextManager["BagRecorder"]):
    """A recording, which begins and ends with its context.

    The monitor, see ``open_bus``, is closed by its owner. With ``snapshot``, messages are kept in
    memory until ``save`` is called.

    Raises:
        LcmtoolsError: A file exists, or cannot be written; also at the end of the context.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        choice: RecordedTopics,
        series: LogSeries,
        limits: Limits = _NO_LIMITS,
        snapshot: SnapshotPlan | None = None,
        *,
        paused: bool = False,
    ) -> None:
        self._monitor, self._choice, self._series = monitor, choice, series
        self._limits, self._snapshot = limits, snapshot
        self._pauses = [(0, paused)]  # times of changes [ns since 1970], and whether paused then
        self._ring = Ring(snapshot) if snapshot else None
        self._is_requested = False
        self._saves_until = 0  # [ns since 1970]
        self._worker = ThreadPoolExecutor(1, "writer")
        self._notes = IndexNotes(monitor, self._worker)
        self._writer: LogWriter | None = None
        self._written: Future[None] | None = None
        self._counts: dict[str, int] = {}
        self._messages = self._closed_bytes = 0
        self._overflows = self._dropped = 0
        self._overflows_of_others = buffer_overflows()
        self._is_new_graph = True
        self._silence: list[str] | None = None
        self._began = self._file_began = self._next_look = self._next_write = 0.0
        self._stops, self._ended = threading.Event(), threading.Event()
        self._error: Exception | None = None
        self._reader = threading.Thread(target=self._run, name="recorder", daemon=True)

    def __enter__(self) -> "BagRecorder":
        """Begin."""
        self._began = time.monotonic()
        self._update_graph(self._began)
        if self._ring is None:
            self._open()
        with suppress(BusError):  # nodes will announce themselves soon anyway
            self._monitor.probe()
        try:
            self._reader.start()
        except KeyboardInterrupt:  # a signal during the start; ``__exit__`` is then not called
            self.stop()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """End; everything that has arrived is written."""
        self.stop()

    def stop(self) -> None:
        """End the recording, and wait until everything is written.

        Raises:
            LcmtoolsError: It could not be written.
        """
        self._stops.set()
        self._ended.wait()  # a thread whose start was interrupted cannot be joined yet
        self._reader.join()
        self._worker.shutdown()
        error, self._error = self._error, None
        if error is not None:
            raise error

    @property
    def has_ended(self) -> bool:
        """True once it has begun, and was stopped."""
        return self._stops.is_set()

    @property
    def is_paused(self) -> bool:
        """True if messages that arrive now are not recorded; may be set at any time."""
        return self._pauses[-1][1]

    @is_paused.setter
    def is_paused(self, paused: bool) -> None:
        self._pauses.append((time.time_ns(), paused))

    @property
    def is_of_snapshots(self) -> bool:
        """True if messages are kept in memory until a snapshot is requested."""
        return self._ring is not None

    def wait(self, timeout: float) -> bool:
        """Wait up to ``timeout`` [s] for the recording to end by itself; return whether it did."""
        return self._ended.wait(timeout)

    def save(self) -> None:
        """Write a snapshot, or extend the one that is being written."""
        self._is_requested = True

    def silence(self) -> list[str]:
        """Return sentences on named topics without messages and on unknown nodes, each once."""
        if told := self._silence or []:
            self._silence = []
        return told

    def progress(self) -> Progress:
        """Return the state of the recording."""
        ring = self._ring
        return Progress(
            self._messages,
            self._all_bytes,
            self._series.count,
            self._notes.losses,
            self._overflows,
            self._monitor.trouble or self._monitor.send_trouble,
            self.is_paused,
            self._writer is not None,
            len(ring.packets) if ring else 0,
            ring.bytes if ring else 0,
            self._monitor.knows_losses,
        )

    @property
    def _all_bytes(self) -> int:
        writer = self._writer
        return self._closed_bytes + (writer.size if writer else 0)

    def _run(self) -> None:
        try:
            self._read()
        except EOFError:  # the bus was a log, which has ended
            pass
        except Exception as error:  # noqa: BLE001 - raised again on the owner's thread
            self._error = error
        try:
            self._finish()
        except Exception as error:  # noqa: BLE001 - the first one is raised
            self._error = self._error or error
        self._ended.set()

    def _read(self) -> None:
        while not self._stops.is_set() and not self._is_complete():
            self._add_wanted(self._monitor.receive(_WRITE_PERIOD))
            self._do_due_work(time.monotonic())
        self._drain(time.time_ns())
        self._note_silence()

    def _drain(self, end: int) -> None:
        """Read the messages that have arrived by the end [ns since 1970]."""
        self._count_overflows()
        deadline, has_times = time.monotonic() + _DRAIN, self._monitor.tap is not None
        while packets := self._monitor.receive(0.0):
            self._add_wanted(packets)
            if packets[-1].time > end if has_times else time.monotonic() > deadline:
                break
        self._count_overflows()

    def _note_silence(self) -> None:
        if self._silence is None:
            self._silence = self._choice.silent(self._monitor.graph())

    def _is_complete(self) -> bool:
        limits = self._limits
        if limits.duration is not None and time.monotonic() - self._began >= limits.duration:
            return True
        if limits.bytes is not None and self._all_bytes >= limits.bytes:
            return True
        named = self._choice.named if limits.messages is not None else ()
        full = [channel for channel, count in self._counts.items() if count == limits.messages]
        spelled = self._choice.spelled
        return bool(named) and all(any(spelled(name, one) for one in full) for name in named)

    def _add_wanted(self, packets: Sequence[Packet]) -> None:
        includes = self._choice.includes
        wanted = [packet for packet in packets if includes(packet.channel)]
        if len(wanted) < len(packets):
            for packet in packets:
                if packet.channel == NODE_CHANNEL and self._notes.add_announcement(
                    packet, self._writer
                ):
                    self._is_new_graph = True
        if len(self._pauses) > 1 or self.is_paused:
            self._notes.miss([one for one in wanted if self._was_paused(one.time)])
            wanted = [packet for packet in wanted if not self._was_paused(packet.time)]
        if self._limits.messages is not None:
            wanted = [packet for packet in wanted if self._is_within(packet.channel)]
        if self._ring is not None and self._snapshot is not None:
            self._keep(wanted, self._ring, self._snapshot)
        elif wanted:
            self._add(wanted)

    def _was_paused(self, arrival: int) -> bool:
        """Return whether a message that arrived then is not recorded, however late it is read."""
        return self._pauses[bisect.bisect(self._pauses, (arrival, True)) - 1][1]

    def _is_within(self, channel: str) -> bool:
        """Count a message; return whether it is within the limit of its topic."""
        count = self._counts.get(channel, 0)
        if count == self._limits.messages:
            return False
        self._counts[channel] = count + 1
        return True

    def _add(self, packets: Sequence[Packet]) -> None:
        if self._writer is not None:
            self._notes.add(packets, self._writer)
            self._messages += len(packets)

    def _keep(self, packets: Sequence[Packet], ring: Ring, snapshot: SnapshotPlan) -> None:
        """Keep messages; while a snapshot is being written, also write them."""
        now = time.time_ns()
        self._notes.hold(ring.add(packets, now))
        is_wanted = snapshot.is_wanted
        wanted = [packet for packet in packets if is_wanted(packet)] if is_wanted else []
        if wanted or self._is_requested:
            self._is_requested = False
            self._saves_until = now + round(snapshot.after * NANOSECONDS)
            if self._writer is None:
                packets = list(ring.packets)
                self._open(packets[0].time if packets else now)
        self._add(packets)
        if self._writer is not None and now >= self._saves_until:
            self._close(self._writer)

    def _count_overflows(self, *, look_at_others: bool = False) -> None:
        """Count what full buffers dropped; at most that in all of this network meanwhile."""
        if (tap := self._monitor.tap) is None:
            return
        of_all = buffer_overflows() if look_at_others else 0  # ahead of those of the tap
        if (dropped := tap.overflows()) != self._dropped:
            is_exact = tap.drops() is not None
            most = dropped if is_exact else buffer_overflows() - self._overflows_of_others
            self._overflows, self._dropped = min(dropped, most), dropped
        elif look_at_others:
            self._overflows_of_others = of_all - self._overflows

    def _do_due_work(self, now: float) -> None:
        is_time = now >= self._next_look
        self._count_overflows(look_at_others=is_time)
        if is_time:
            self._update_graph(now)
        if now >= self._began + PATIENCE:
            self._note_silence()
        if self._ring is not None:  # time also passes without messages
            self._add_wanted([])
        writer = self._writer
        if writer is None:
            return
        if now >= self._next_write or writer.waiting_bytes > _WRITE_BYTES:
            self._next_write = now + (_FRAME_PERIOD if self._series.compression else _WRITE_PERIOD)
            self._write(writer)
        if self._is_full(writer, now):
            self._close(writer)
            self._open(is_split=True)

    def _update_graph(self, now: float) -> None:
        self._next_look = now + _LOOK_PERIOD
        if self._is_new_graph:
            self._is_new_graph = False
            graph = self._monitor.graph()
            self._notes.update(graph)
            self._monitor.listen_to(self._choice.update(graph))
        if self._writer is not None:
            self._notes.annotate(self._writer)

    def _is_full(self, writer: LogWriter, now: float) -> bool:
        most, longest = self._limits.split_bytes, self._limits.split_time
        is_large = most is not None and writer.size >= most
        return is_large or (longest is not None and now - self._file_began >= longest)

    def _write(self, writer: LogWriter) -> None:
        """Pass on waiting messages; not while the disk is busy, unless too many wait."""
        if self._written is not None:
            if not self._written.done() and writer.waiting_bytes < _MOST_WAITING:
                return
            self._written.result()
        self._written = self._worker.submit(writer.write, writer.pop_batch())

    def _open(self, begin: int = 0, *, is_split: bool = False) -> None:
        self._writer = self._series.next()
        self._file_began = time.monotonic()
        self._notes.begin(self._writer, is_split=is_split, time=begin or time.time_ns())

    def _close(self, writer: LogWriter) -> None:
        if self._written is not None:
            self._written.result()
        self._notes.annotate(writer, in_full=True)
        self._writer = None
        self._closed_bytes += writer.size
        self._written = self._worker.submit(writer.close)

    def _finish(self) -> None:
        writer = self._writer
        if writer is not None and self._error is not None:
            with suppress(LcmtoolsError):  # the disk is still full
                writer.close()
        elif writer is not None:
            self._close(writer)
        if self._written is not None and self._error is None:
            self._written.result()
