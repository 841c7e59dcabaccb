"""A log as a source: it is played, with one position for all pages.

One thread owns the player and executes pages' requests between two messages.
"""

import threading
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Literal

from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Choice, Played, Playlist
from lcmtools.clock import NANOSECONDS
from lcmtools.gui.page_publisher import Publishers
from lcmtools.gui.protocol import Json
from lcmtools.gui.recording import Recordings
from lcmtools.gui.source import End
from lcmtools.gui.steering import Steering
from lcmtools.messages.registry import Message
from lcmtools.observe.channels.activity import Activity
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow, ChannelRows, ChannelSelection
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.following import Receiver
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.wire.packet import Packet

_WINDOW = 2.0  # [s] of the log over which rates are measured
_PERIOD = 0.2  # [s] between two snapshots
_MOST = 2000  # messages between two checks for pages' requests
_BINS = 300  # intervals of the time line
_MOST_MARKS = 1000
_MOST_READ = 100_000  # most messages that a plot of the whole log uses


class LogSource:
    """A log that is played, or several as one; it begins at its start.

    Raises:
        BusError: The file cannot be read, or is not a log.
        LcmtoolsError: It has no message.
    """

    kind: Literal["bus", "log"] = "log"
    publishers: Publishers | None = None
    steering: Steering | None = None
    recordings: Recordings | None = None

    def __init__(self, *paths: str, notify: Callable[[str], None] = lambda _: None) -> None:
        self.name = ", ".join(paths)
        self._playlist = Playlist(paths, Choice(), notify)
        self._player = Player(self._playlist.messages, self._playlist.span, now=time.monotonic_ns())
        builder = self._playlist.announced()
        self._decoder = Decoder(builder.types_of)
        self._types = {track.topic: track.type for track in self._playlist.tracks}
        for track in self._playlist.tracks:  # so that topics are known before their first message
            if track.fingerprint is not None:
                head = track.fingerprint.to_bytes(8, "big")
                builder.add(Packet(track.topic, head, self._playlist.span[0]))
        self._graph = builder.snapshot(self._playlist.span[1])
        self._rows = ChannelRows(ChannelSelection(), SenderNames())
        self._activity = Activity(_WINDOW)
        self._receivers: dict[str, tuple[Receiver, ...]] = {}
        self._wishes: SimpleQueue[Callable[[], object]] = SimpleQueue()
        self._new: list[tuple[str, Receiver]] = []  # new followers since the last turn
        self._wakes, self._ends = threading.Event(), threading.Event()
        self._fault = ""
        self.latest = self._snapshot()
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    # For pages; called on any thread

    def follow(self, channel: str, receive: Receiver) -> End:
        """Pass a channel's messages on, its latest one at once; return a call to end it."""
        self._wish(lambda: self._add(channel, receive))
        return partial(self._wish, lambda: self._remove(channel, receive))

    def read(self, topics: Collection[str]) -> tuple[int, Iterator[Packet]]:
        """Return n, 1 unless there are many, and every n-th message of topics in the log."""
        count = sum(track.messages for track in self._playlist.tracks if track.topic in topics)
        every = -(-count // _MOST_READ) or 1
        counts: Counter[str] = Counter()

        def is_wanted(one: Played) -> bool:
            counts[one.topic] += 1
            return (counts[one.topic] - 1) % every == 0

        messages = self._playlist.messages(*self._playlist.span, topics)
        return every, map(_packet, filter(is_wanted, messages))

    @property
    def start(self) -> float:
        """The time of the first message [s since 1970]."""
        return self._playlist.span[0] / NANOSECONDS

    def listen_to_all(self) -> End:
        """Do nothing: a log has no listeners."""
        return lambda: None

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises errors as ``Decoder.decode``."""
        return self._decoder.decode(packet)

    def state(self) -> Mapping[str, Json]:
        """Return the problem, and the position in the log."""
        seconds, length, rate, is_paused = self._player.position(time.monotonic_ns())
        about = {"time": round(seconds, 3), "length": length, "rate": rate, "isPaused": is_paused}
        return {"trouble": self._fault, "log": {**about, "isOver": self._player.is_over}}

    def timeline(self) -> Mapping[str, Json]:
        """Return the data of a time line: messages over time, and the times of losses."""
        start, end = self._playlist.span
        lost = [(one - start) / NANOSECONDS for one in islice(self._playlist.losses(), _MOST_MARKS)]
        return {
            "start": start / NANOSECONDS,
            "length": (end - start) / NANOSECONDS,
            "histogram": self._playlist.histogram(_BINS),
            "losses": lost,
        }

    def pause(self) -> None:
        """Pause the log."""
        self._wish(lambda: self._player.pause(time.monotonic_ns()))

    def resume(self) -> None:
        """Continue; at its end, from its start."""
        self._wish(self._resume)

    def seek(self, seconds: float) -> None:
        """Go to a time since the start, and pass on each topic's latest message then."""
        self._wish(lambda: self._seek(seconds))

    def set_rate(self, rate: float) -> None:
        """Play faster or slower."""
        self._wish(lambda: self._player.set_rate(rate, time.monotonic_ns()))

    def step(self) -> None:
        """Pause, and pass on the next message."""
        self._wish(self._step)

    def close(self) -> None:
        """Stop reading."""
        self._ends.set()
        self._wakes.set()
        self._thread.join(5.0)
        self._playlist.close()

    def _wish(self, wish: Callable[[], object]) -> None:
        self._wishes.put(wish)
        self._wakes.set()

    # Called on the thread that owns the player

    def _run(self) -> None:
        next_snapshot = 0.0
        try:
            while not self._ends.is_set():
                self._handle_requests()
                due = self._due()
                self._pass_on(due)
                if time.monotonic() >= next_snapshot:
                    next_snapshot = time.monotonic() + _PERIOD
                    self.latest = self._snapshot()
                if not due:
                    left = max(0.0, next_snapshot - time.monotonic())
                    self._wakes.wait(min(self._player.wait(time.monotonic_ns()), left))
        except Exception as error:  # noqa: BLE001 - shown on the pages
            self._fault = f"a fault of lcmtools ({type(error).__name__}: {error})"

    def _handle_requests(self) -> None:
        """Execute pages' requests; new followers get the latest messages, in order of time."""
        self._wakes.clear()
        with suppress(Empty):
            while True:
                self._wishes.get_nowait()()
        if self._new:
            new, self._new = self._new, []
            now = self._player.time(time.monotonic_ns())
            for played in self._playlist.latest({topic for topic, _ in new}, now):
                for topic, receive in new:
                    if topic == played.topic:
                        receive(_packet(played))

    def _due(self) -> list[Played]:
        due: list[Played] = []
        while len(due) < _MOST and (one := self._player.pop_due(time.monotonic_ns())) is not None:
            due.append(one)
        return due

    def _pass_on(self, messages: Iterable[Played]) -> None:
        for one in messages:
            packet = _packet(one)
            self._activity.add(packet)
            self._give(packet)

    def _give(self, packet: Packet) -> None:
        for receive in self._receivers.get(packet.channel, ()):
            receive(packet)

    def _add(self, channel: str, receive: Receiver) -> None:
        self._receivers[channel] = (*self._receivers.get(channel, ()), receive)
        self._new.append((channel, receive))

    def _remove(self, channel: str, receive: Receiver) -> None:
        left = [one for one in self._receivers.get(channel, ()) if one is not receive]
        self._receivers[channel] = tuple(left)
        self._new = [one for one in self._new if one[1] is not receive]

    def _resume(self) -> None:
        now = time.monotonic_ns()
        if self._player.is_over:
            self._player.seek(self._playlist.span[0], now)
        self._player.resume(now)

    def _step(self) -> None:
        one = self._player.step(time.monotonic_ns())
        if one is not None:
            self._pass_on([one])
            self.latest = self._snapshot()

    def _seek(self, seconds: float) -> None:
        """Go there; forward, only newer messages are passed on, so that curves continue."""
        now, start = time.monotonic_ns(), self._playlist.span[0]
        before, there = self._player.time(now), start + round(seconds * NANOSECONDS)
        self._player.seek(there + 1, now)
        there = max(start, min(there, self._playlist.span[1]))
        latest = self._playlist.latest(self._types.keys(), there)
        # count the messages before that time, so that rates and ages are known there
        self._activity.clear()
        window = there - round(_WINDOW * NANOSECONDS)
        older = [one for one in latest if one.time < window]
        for one in (*older, *self._playlist.messages(window, there)):
            self._activity.add(_packet(one))
        for one in latest:
            if there < before or one.time > before:
                self._give(_packet(one))
        self.latest = self._snapshot()

    def _snapshot(self) -> Snapshot:
        now = self._player.time(time.monotonic_ns())
        graph = self._graph._replace(time=now)
        rows = self._rows.make(graph, self._activity, {}, now)
        return Snapshot(tuple(map(self._typed, rows)), trouble=self._fault, graph=graph)

    def _typed(self, row: ChannelRow) -> ChannelRow:
        """Return a row with its type, even if no message has shown it yet."""
        known = self._types.get(row.channel)
        return replace(row, types=(known,)) if known and not row.types else row


def _packet(one: Played) -> Packet:
    return Packet(one.topic, one.payload, one.time)
