"""Playing logs on a bus, as ``lcmtools bag play`` does.

Belongs here: the checks before the first message, the loop that sends, and messages and actions
about commands at a pause and at the end. The meaning of keys is in ``keys``.
"""

import math
import os
import queue
import shlex
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from lcmtools.bag.commands import Conflict, LastCommands, conflicts, reasons, way_out
from lcmtools.bag.player import Player, Position, press
from lcmtools.bag.playlist import Choice, Played, Playlist, Track
from lcmtools.bag.summary_report import span_text
from lcmtools.bag.times import LogTime, time_window
from lcmtools.bus.url import BusUrl
from lcmtools.clock import CLOCK_TOPIC, NANOSECONDS, split_stamp
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph
from lcmtools.node.node import Node
from lcmtools.node.publisher import PayloadPublisher
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.publish.subscriber_wait import wait_until
from lcmtools.publish.temporary_node import temporary_node
from lcmtools.terminal import open_keys
from lcmtools.types.rosgraph_msgs import Clock

Notify = Callable[[str], None]
OnPosition = Callable[[Position], None]

_CLOCK_PERIOD = NANOSECONDS // 100
_SHOW_PERIOD = NANOSECONDS // 10
_WATCH_PERIOD = 2.0  # [s] between two checks for new publishers
_WATCH_TIME = 0.3  # [s] of a check, for programs that are not nodes
_ASLEEP = NANOSECONDS  # [ns] without a turn means that the computer slept, or Ctrl-Z
_ANSWERED = 0.3  # [s] after which existing nodes have announced themselves
_LONG_GAP = 5.0  # [s] until the next message, of which the user is told
_STOPS = 3  # times that a stop is sent, because each may be lost
_STOP_GAP = 0.01  # [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """Options for playing logs."""

    rate: float = 1.0  # seconds of the log per second; 0 for as fast as possible
    start: LogTime | None = None
    end: LogTime | None = None
    duration: float | None = None  # at most this part of the log [s]
    loops: bool = False
    is_paused: bool = False  # at the start
    clock: bool = False  # publish /clock
    waits: bool = False  # wait for a subscriber of each topic
    most_gap: float = math.inf  # a longer time without messages is skipped [s]
    typed: Sequence[str] = ()  # the logs as the user named them; () for the paths themselves
    force: bool = False  # play even if others publish or obey


class Result(NamedTuple):
    """The result of playing logs."""

    messages: int
    seconds: float


def play(
    paths: Sequence[str | Path],
    url: BusUrl,
    choice: Choice,
    manner: Manner,
    *,
    notify: Notify = lambda _: None,
    on_position: OnPosition = lambda _: None,
) -> Result:
    """Play logs on a bus, merged by their times; ``on_position`` is called ten times a second.

    Raises:
        BusError: A log cannot be read, or the bus cannot be reached.
        UsageError: There is no such topic, or the log has nothing in these times.
        LcmtoolsError: Topics are in use on the bus, and nothing was played.
    """
    choice = replace(choice, only_utf_8=not (url.is_multicast or url.provider == "zenoh"))
    with Playlist(paths, choice, notify) as playlist:
        window = time_window(playlist.span, manner.start, manner.end, duration=manner.duration)
        now = time.monotonic_ns()
        player = Player(
            playlist.played,
            window,
            rate=manner.rate,
            loops=manner.loops,
            is_paused=manner.is_paused,
            now=now,
        )
        if player.is_over:
            raise LcmtoolsError(
                "the log has no messages between these times", "leave out --start or --end"
            )
        for line in playlist.untold() if window[0] > playlist.span[0] else ():
            notify(line)
        named = manner.typed or [*map(str, paths)]
        known, graph = _check(named, url, playlist.tracks, notify, force=manner.force)
        with (
            temporary_node("play", url, in_order=True) as node,
            _Watch(url, playlist.tracks, node.name, known) as watch,
        ):
            session = _Session(node, playlist, manner, notify, watch)
            session.find(graph)
            if manner.waits:
                session.wait_for_subscribers()
            return session.run(player, on_position)


def _check(
    named: Sequence[str],
    url: BusUrl,
    tracks: Sequence[Track],
    notify: Notify,
    *,
    force: bool,
) -> tuple[frozenset[Conflict], Graph]:
    """Refuse topics that are in use on the bus; return overridden reasons, and the graph."""
    with BusMonitor(url, "play", os.environ) as monitor:
        graph = monitor.settle()
    found = conflicts(graph, tracks)
    for line in reasons(found):
        notify(line)
    if found and not force:
        typed = f"lcmtools bag play {shlex.join(named)} {way_out(found, tracks)}"
        raise LcmtoolsError("nothing is played", f"{typed} goes ahead, --force plays anyway")
    return frozenset(found), graph


class _Session:
    """Sending a log by a node."""

    def __init__(
        self, node: Node, playlist: Playlist, manner: Manner, notify: Notify, watch: "_Watch"
    ) -> None:
        tracks, self._recorded_time = playlist.tracks, playlist.recorded_time
        self._node, self._notify, self._watch = node, notify, watch
        self._forced, self._most_gap = manner.force, manner.most_gap
        self._commands = LastCommands(tracks)
        self._publishers: Mapping[str, PayloadPublisher] = {
            track.topic: node.create_payload_publisher(track.topic, track.type, track.fingerprint)
            for track in tracks
        }
        self._latched = {track.topic: frozenset[str]() for track in tracks if track.is_latched}
        self._playlist = playlist
        for topic in self._latched:
            self._publishers[topic].is_latched = True
        # a log's own clock belongs to its messages' stamps
        ticks = manner.clock and CLOCK_TOPIC not in self._publishers
        self._clock = node.create_publisher(Clock, CLOCK_TOPIC) if ticks else None
        self._count = 0
        self._is_gap_told = False

    def find(self, graph: Graph) -> None:
        """Learn the nodes of a graph, and follow them from now on."""
        there = {node.id for node in graph.nodes if not node.stale}
        wait_until(lambda: there <= {node.id for node in self._node.graph().nodes}, _ANSWERED)

    def wait_for_subscribers(self) -> None:
        def missing() -> list[str]:
            return [topic for topic, one in self._publishers.items() if not one.subscriber_count()]

        def report() -> None:
            others = "plain LCM programs do not count, as they do not tell what they subscribe to"
            self._notify(f"waiting for subscribers of {', '.join(missing())}; {others}")

        wait_until(lambda: not missing(), None, report)

    def run(self, player: Player, on_position: OnPosition) -> Result:
        """Play to the end; stop or report commands that are still in effect."""
        began = time.monotonic_ns()
        (player.pause if player.is_paused else player.resume)(began)
        try:
            with open_keys(lambda: self._settle("suspended")) as wait:
                self._send(player, on_position, wait)
        finally:
            on_position(player.position(time.monotonic_ns()))
            self._settle("over" if player.is_over else "ended")
        return Result(self._count, (time.monotonic_ns() - began) / NANOSECONDS)

    def _send(
        self, player: Player, on_position: OnPosition, wait: Callable[[float], Sequence[str]]
    ) -> None:
        period = _CLOCK_PERIOD if self._clock else _SHOW_PERIOD
        due = shown = 0
        self._latched = {topic: self._publishers[topic].subscriber_ids() for topic in self._latched}
        seen = time.monotonic_ns()
        while not player.is_over:
            now = time.monotonic_ns()
            if now - seen > _ASLEEP:
                player.postpone(now - seen)
            seen = now
            if message := None if now >= due else player.pop_due(now):
                self._publish(message)
                continue
            left = min(self._gap(player, now), max(0, due - now) / NANOSECONDS)
            if not all(self._press(player, key) for key in wait(left)):
                return
            if now >= due:
                due = now + period
                self._tick(self._recorded_time(player.time(now)))
            if now - shown >= _SHOW_PERIOD:
                shown = now
                on_position(player.position(now))
                self._serve_late(player.time(now))
                for conflict in self._watch.pop():
                    self._notify(f"{conflict.reason} while it is played")

    def _press(self, player: Player, key: str) -> bool:
        """Execute a key; return False for the end."""
        was_paused = player.is_paused
        goes_on, message = press(player, key, time.monotonic_ns())
        if message:
            self._publish(message)
        if message or (player.is_paused and not was_paused):
            self._settle("paused")
        return goes_on

    def _serve_late(self, log_time: int) -> None:
        """Send new subscribers of latched topics what was latched at a time of the log."""
        late = set()
        for topic, served in self._latched.items():
            present = self._publishers[topic].subscriber_ids()
            if present - served:
                late.add(topic)
            self._latched[topic] = present
        for one in self._playlist.latched(log_time + 1) if late else ():
            if one.topic in late:
                self._publishers[one.topic].publish_payload(one.payload)

    def _gap(self, player: Player, now: int) -> float:
        """Return the time until the next message [s], after skipping it if it is too long.

        A long one is told, once before each message; a pause waits without end.
        """
        seconds = player.wait(now)
        if self._most_gap < seconds < math.inf:
            self._notify(f"skipped {span_text(seconds)} without messages")
            player.skip(now)
            return 0.0
        if _LONG_GAP < seconds < math.inf and not self._is_gap_told:
            self._is_gap_told = True
            ways = "n skips to it, --max-gap all such waits, --end leaves it out"
            self._notify(f"the next message is due in {span_text(seconds)}; {ways}")
        return seconds

    def _publish(self, message: Played) -> None:
        self._is_gap_told = False
        self._publishers[message.topic].publish_payload(message.payload)
        self._commands.add(message.topic, message.payload)
        self._count += 1

    def _tick(self, log_time: int) -> None:
        if self._clock:
            clock = Clock()
            clock.clock.sec, clock.clock.nsec = split_stamp(log_time)
            self._clock.publish(clock)

    def _settle(self, situation: str) -> None:
        """Stop actuators that commands have set in motion, or report them."""
        graph = self._node.graph()
        heard = self._node.has_plain_listeners(at_once=True)
        for one in self._commands.pop(graph, heard=heard):
            if one.stop is not None and self._forced:
                for _ in range(_STOPS):
                    self._publishers[one.topic].publish_payload(one.stop)
                    time.sleep(_STOP_GAP)
                self._notify(f"{situation}: {one.said}; zero was sent after it")
            else:
                self._notify(f"{situation}: {one.lasting}")


class _Watch(AbstractContextManager["_Watch"]):
    """Checks, on a thread, for programs that begin to use topics while they are played."""

    def __init__(
        self, url: BusUrl, tracks: Sequence[Track], own: str, known: frozenset[Conflict]
    ) -> None:
        self._url, self._tracks, self._own = url, tracks, own
        self._known = set(known)
        self._found: queue.SimpleQueue[Conflict] = queue.SimpleQueue()
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watch", daemon=True)

    def __enter__(self) -> "_Watch":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._is_over.set()
        self._thread.join(timeout=1.0)

    def pop(self) -> list[Conflict]:
        """Return the conflicts found since the last call, each once."""
        return [self._found.get() for _ in range(self._found.qsize())]

    def _run(self) -> None:
        while not self._is_over.wait(_WATCH_PERIOD):
            with suppress(LcmtoolsError):  # a failed network may come back
                with BusMonitor(self._url, "play", os.environ) as monitor:
                    graph = monitor.settle(wait=_WATCH_TIME)
                if not any(node.name == self._own for node in graph.nodes):
                    continue  # its own messages would count as another program's
                for one in conflicts(graph, self._tracks, self._own):
                    if one not in self._known:
                        self._known.add(one)
                        self._found.put(one)
