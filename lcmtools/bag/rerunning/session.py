"""Playing a recording to programs on their private bus, in lock-step or in real time.

In lock-step, a message is followed by a step for each program that gets it, and the next message by
the answers of all: what they published meanwhile has come by then. Messages of several programs are
put into the order of their nodes' names, and those that one of them subscribes to are passed on
before the next message of the log.
"""

import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, TypeAlias

from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Played, Playlist
from lcmtools.bag.rerunning.comparison import Compared
from lcmtools.bag.rerunning.private_bus import Client, PrivateBus, Published
from lcmtools.bag.rerunning.programs import Programs
from lcmtools.bag.times import LogTime
from lcmtools.bus.step_bus import DONE_CHANNEL, STEP_CHANNEL
from lcmtools.clock import CLOCK_TOPIC, NANOSECONDS, split_stamp
from lcmtools.graph.common_topics import OF_EVERY_NODE
from lcmtools.graph.model import NodeInfo, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Probe,
    decode_announcement,
    encode_probe,
)
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import Message
from lcmtools.names import is_hidden
from lcmtools.node.lockstep import DONE, STEP
from lcmtools.node.timer import NEVER
from lcmtools.types.rosgraph_msgs import Clock, Log
from lcmtools.wire.tcpq import publish_frame

QUIET = 0.3
"""[s] without any message after which programs are ready, and have answered the last message."""
_LONGEST_QUIET = 2.0  # [s] after the last message in real time
_TURN = 0.2  # [s] between two checks for programs that have ended
_OWN = 3  # messages that a program publishes on its own before it is played to in real time
_MOST_CHAINED = 10_000  # messages that programs exchange between two messages of the log
_MOST_ERRORS = 5
_NOTHING = Played(0, "", b"")


class Stopped(Exception):  # noqa: N818 - named for what happened
    """The programs have ended, hang, or do not begin; the argument is a sentence."""


class Input(NamedTuple):
    """A message of the log, as a function that changes the inputs gets and returns it."""

    time: int  # [ns since 1970]
    topic: str
    message: Message


Change: TypeAlias = Callable[[Input], Input | Iterable[Input] | None] | Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """The options of a rerun."""

    arguments: Sequence[str] = ()  # of a node in this process: "__ns:=/husky0"
    inputs: Change | None = None
    """A function that returns an input as it is, changed, at another time, several, or None to lose
    it; or conditions as of ``bag filter`` by topics: inputs that do not meet them are lost."""
    only: Sequence[str] = ()  # the only topics that are played; none for all
    outputs: Sequence[str] = ()  # topics that are compared, beside those of the program
    start: LogTime | str | None = None  # "10s", "end-1m"
    end: LogTime | str | None = None
    tolerance: float = 1e-9  # the largest difference of numbers that counts as none
    relative: float = 1e-9  # the same, as a part of their size
    delay: float = 0.1  # of stamps, and of messages against the others of their topic [s]
    against: str | Path | None = None  # a contract with tolerances of topics and fields
    rate: float | None = None  # in real time at this rate; None for lock-step, if possible
    timeout: float = 10.0  # [s] without an answer after which the program hangs
    twice: bool = False  # run it twice, and compare both runs byte for byte


@dataclass(slots=True)
class Run:
    """The record of playing a log to programs."""

    senders: Mapping[str, Collection[str]]  # of the topics of the log
    published: list[tuple[str, Compared]] = field(default_factory=list)  # with the topics
    inputs: int = 0  # messages sent
    input_topics: set[str] = field(default_factory=set)
    announced: dict[str, NodeInfo] = field(default_factory=dict)  # nodes by their ids
    errors: list[str] = field(default_factory=list)  # what nodes logged as errors
    trouble: str = ""  # why it did not come to its end
    last_lines: list[str] = field(default_factory=list)
    real_time: str = ""  # why it was not in lock-step; "" if it was
    not_in_step: str = ""  # why nodes must start again without lock-step
    unprompted: str = ""  # the first topic published on while no step was being done
    lateness: list[int] = field(default_factory=list)  # of the inputs in real time [ns]

    def outputs(self) -> set[str]:
        """Return the topics that the programs announce as theirs, or have published."""
        ends = (end for node in self.announced.values() for end in node.having(Role.PUBLISHER))
        found = {end.topic for end in ends} | {topic for topic, _ in self.published}
        return {topic for topic in found - OF_EVERY_NODE if not is_hidden(topic)}

    def subscriptions(self) -> dict[str, Collection[int]]:
        """Return the announced subscriptions, each with the fingerprints that it accepts."""
        nodes = self.announced.values()
        ends = (end for node in nodes for end in node.having(Role.SUBSCRIBER))
        visible = (end for end in ends if end.topic != CLOCK_TOPIC and not is_hidden(end.topic))
        return {end.topic: end.fingerprints for end in visible}

    def is_own(self, message: Played) -> bool:
        """Return whether the programs published a message of their topics when it was recorded.

        If the log has several senders of the topic, and one of them is now tested, names tell.
        """
        senders = self.senders.get(message.topic, ())
        names = {node.name for node in self.announced.values()}
        is_shared = len(senders) > 1 and not names.isdisjoint(senders)
        return not is_shared or message.sender in names

    def by_topic(self, topics: Collection[str]) -> dict[str, list[Compared]]:
        """Return what was published on some topics."""
        found: dict[str, list[Compared]] = {}
        for topic, one in self.published:
            if topic in topics:
                found.setdefault(topic, []).append(one)
        return found


class Session:
    """One run: ``begin``, then ``lockstep`` or ``real_time``; all add to ``run``.

    All raise Stopped.
    """

    def __init__(
        self,
        bus: PrivateBus,
        programs: Programs,
        manner: Manner,
        playlist: Playlist,
        start: int,
        on_time: Callable[[int], None],
    ) -> None:
        self.run = Run(playlist.senders())
        self._bus, self._programs, self._manner = bus, programs, manner
        self._start, self._on_time = start, on_time  # [ns since 1970]
        self._makes_clock = all(track.topic != CLOCK_TOPIC for track in playlist.tracks)
        self._number = 0  # of the step
        self._asked: dict[Client, int] = {}  # the last step of each
        self._answers: dict[Client, int] = {}  # the last answered one
        self._cause = start  # the time of the last input
        self._due: dict[Client, int] = {}  # when the next timer is due [ns]
        self._seen: set[str] = set(manner.outputs)  # topics that are not played

    def begin(self) -> str:
        """Wait until the programs are ready; return why lock-step is not possible, or "".

        Programs that answer steps need the other start if it is not possible.
        """
        begin = quiet = time.monotonic()
        known, own = 0, 0
        while not (self._is_ready() and time.monotonic() - quiet > QUIET):
            found = self._turn(0.05)
            self._keep(found, self._start)
            now = time.monotonic()
            if self.run.unprompted:
                return self._unprompted()
            own += len(found)
            for client in self._bus.clients:
                if STEP_CHANNEL in client.patterns and client not in self._asked:
                    self._ask([client])
            size = self._bus.count + sum(len(one.patterns) for one in self._bus.clients)
            size += len(self._answers)
            quiet, known = (now, size) if size != known else (quiet, known)
            if self._asked and own >= _OWN and now - begin > _LONGEST_QUIET:
                return "it publishes without waiting for messages (lcmtools.spin)"
            self._check_programs()
            if now - begin > self._manner.timeout:
                raise Stopped(self._not_ready())
        self._learn()
        is_plain = len(self._asked) < len(self._bus.clients)
        return "a plain LCM program does not say when it has handled a message" if is_plain else ""

    @property
    def has_nodes(self) -> bool:
        """True if programs are connected that answer steps."""
        return bool(self._answers)

    def lockstep(self, messages: Iterator[Played], end: int) -> str:
        """Play messages, each when the one before has been handled; timers run up to ``end``.

        Return why that was not lock-step, or "": a thread may begin to publish meanwhile.
        """
        for message in messages:
            if self.is_input(message):
                self._run_timers(message.time)
                self._count(message)
                self._pass(message)
        self._run_timers(end)
        quiet = time.monotonic() + QUIET
        while not self.run.unprompted and (left := quiet - time.monotonic()) > 0:
            self._turn(left)
        return self._unprompted()

    def real_time(self, player: Player) -> None:
        """Play messages when they are due by the computer's clock."""
        sent = time.monotonic_ns()
        while not player.is_over:
            now = time.monotonic_ns()
            late = player.time(now)
            message = player.pop_due(now)
            if message and self.is_input(message):
                self._count(message)
                self.run.lateness.append(max(0, late - message.time))
                sent = now
                for client in self._receivers(message.topic):
                    self._bus.send(client, self._frames(client, message))
            found = self._turn(0.0 if message else min(player.wait(now), _TURN))
            self._keep(found, player.time(time.monotonic_ns()), sent)
            if not message:
                self._check_programs()
        last = time.monotonic()
        while time.monotonic() - last < QUIET and time.monotonic_ns() - sent < _LONGEST_QUIET * 1e9:
            found = self._turn(QUIET)
            self._keep(found, player.time(time.monotonic_ns()), sent)
            last = time.monotonic() if found else last

    def _unprompted(self) -> str:
        topic = self.run.unprompted
        return f"it published {topic} without a message or a timer" if topic else ""

    def _is_ready(self) -> bool:
        is_complete = len(self._bus.clients) >= self._programs.count
        return is_complete and self._answers.keys() == self._asked.keys()

    def _ask(self, clients: Collection[Client], message: Played = _NOTHING) -> None:
        """Send a message, and the next step."""
        self._number += 1
        step = publish_frame(STEP_CHANNEL, STEP.pack(self._number))
        for client in clients:
            self._asked[client] = self._number
            self._bus.send(client, self._frames(client, message) + step)

    def _not_ready(self) -> str:
        within = f"within {self._manner.timeout:g} s"
        if len(self._bus.clients) < self._programs.count:
            how = "its own LCM URL instead of LCM_DEFAULT_URL, as lcm_create(NULL) does, may be why"
            return f"the program did not connect to the bus {within}; {how}"
        return f"the program did not begin to handle messages {within} (lcmtools.spin)"

    def _learn(self) -> None:
        """Learn the nodes and their topics by a probe."""
        probe = publish_frame(PROBE_CHANNEL, encode_probe(Probe("", 1)))
        for client in self._receivers(PROBE_CHANNEL):
            self._bus.send(client, probe)
        end = time.monotonic() + 1.0
        while time.monotonic() < end and any(not one.name for one in self._answers):
            self._keep(self._turn(0.05), self._start)

    def _run_timers(self, until: int) -> None:
        """Let the timers run that are due up to a time of the log."""
        while self._makes_clock and (due := min(self._due.values(), default=NEVER)) <= until:
            clients = [client for client, time_ in self._due.items() if time_ == due]
            for client in clients:
                del self._due[client]  # its answer has the next one
            for topic, payload in self._step(clients, Played(due, "", b""), is_by_timer=True):
                self._pass(Played(due, topic, payload), is_by_timer=True)

    def _pass(self, first: Played, *, is_by_timer: bool = False) -> None:
        """Send a message to the programs, and then those of one to another, until there is none."""
        waiting, count = deque([first]), 0
        while waiting:
            message = waiting.popleft()
            clients = self._receivers(message.topic)
            passed = self._step(clients, message, is_by_timer=is_by_timer)
            waiting += (Played(first.time, *one) for one in passed)
            count += len(passed)
            if count > _MOST_CHAINED:
                raise Stopped("the programs send each other messages without end")

    def _step(
        self, clients: Collection[Client], message: Played, *, is_by_timer: bool
    ) -> list[tuple[str, bytes]]:
        """Do a step of some clients; return what others of them subscribe to."""
        self._ask(clients, message)
        began, found = time.monotonic_ns(), list[Published]()
        deadline = time.monotonic() + self._manner.timeout
        pending = {client for client in clients if client in self._bus.clients}
        while pending:
            new = self._turn(_TURN)
            found += new
            pending = {
                one
                for one in pending
                if self._answers.get(one) != self._number and one in self._bus.clients
            }
            if not new and pending:
                self._check_programs()
                if time.monotonic() > deadline:
                    where = f"message {self.run.inputs} ({message.topic or 'a timer'})"
                    limit = self._manner.timeout
                    raise Stopped(f"the program hangs at {where}: no answer for {limit:g} s")
        if len(clients) > 1:
            found.sort(key=lambda one: one.client.order)
        self._keep(found, message.time, began, is_by_timer=is_by_timer)
        if not clients or any(one not in self._bus.clients for one in clients):
            self._check_programs(1.0)
        return [(one.channel, one.payload) for one in found if self._receivers(one.channel)]

    def _frames(self, client: Client, message: Played) -> bytes:
        frame = publish_frame(message.topic, message.payload) if message.topic else b""
        if self._makes_clock and message.time and client.wants(CLOCK_TOPIC):
            clock = Clock()
            clock.clock.sec, clock.clock.nsec = split_stamp(message.time)
            return publish_frame(CLOCK_TOPIC, encode(clock)) + frame
        return frame

    def _turn(self, timeout: float) -> list[Published]:
        """Wait for what programs publish; return it without what concerns only the protocol."""
        found = []
        for one in self._bus.turn(timeout):
            if one.channel == DONE_CHANNEL:
                number, due = DONE.unpack(one.payload)
                self._answers[one.client], self._due[one.client] = number, due
            elif is_hidden(one.channel):
                self._talk(one)
            else:
                found.append(one)
                is_answered = self._answers.get(one.client, -1) == self._asked.get(one.client)
                if is_answered and one.channel not in OF_EVERY_NODE:
                    self.run.unprompted = self.run.unprompted or one.channel
        return found

    def _talk(self, one: Published) -> None:
        """Read an announcement; pass it on at once, and requests and replies of services."""
        for client in self._receivers(one.channel):
            self._bus.send(client, publish_frame(one.channel, one.payload))
        said = decode_announcement(one.payload) if one.channel == NODE_CHANNEL else None
        if said:
            one.client.name = one.client.name or said.node.name
            self.run.announced[said.node.id] = said.node
            self._seen |= self.run.outputs()

    def _keep(
        self, found: Collection[Published], at: int, began: int = 0, *, is_by_timer: bool = False
    ) -> None:
        delay = time.monotonic_ns() - began if began else 0
        for one in found:
            made = Compared(at, one.payload, is_by_timer, self._cause, delay)
            self.run.published.append((one.channel, made))
            if one.channel not in OF_EVERY_NODE:
                self._seen.add(one.channel)
            elif one.channel != CLOCK_TOPIC and len(self.run.errors) < _MOST_ERRORS:
                line = decode(Log, one.payload)
                if line.level >= Log.ERROR:
                    after = (at - self._start) / NANOSECONDS
                    where = f"message {self.run.inputs}, at {after:.3f} s"
                    self.run.errors.append(f"{line.name}, {where}: {line.msg}")

    def _count(self, message: Played) -> None:
        self.run.inputs += 1
        self._cause = message.time
        self.run.input_topics.add(message.topic)
        self._on_time(message.time)

    def is_input(self, message: Played) -> bool:
        """Return whether a message of the log is played to the programs."""
        topic, wanted = message.topic, self._manner.only
        if (wanted and topic not in wanted) or not self._receivers(topic):
            return False
        return topic not in self._seen or not self.run.is_own(message)

    def _receivers(self, topic: str) -> list[Client]:
        return [client for client in self._bus.clients if client.wants(topic)]

    def _check_programs(self, timeout: float = 0.0) -> None:
        if end := self._programs.ended(timeout):
            raise Stopped(f"{end}, after {self.run.inputs} messages")
