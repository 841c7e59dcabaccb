"""Testing a program with a recording: what it publishes now, compared with what was recorded."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple, TypeAlias

from lcmtools.bag.contract import Contract, TopicTerms, read_contract
from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Choice, Played, Playlist
from lcmtools.bag.rerunning.comparison import (
    Compared,
    Tolerance,
    TopicComparison,
    compare,
    part_of,
)
from lcmtools.bag.rerunning.private_bus import PrivateBus
from lcmtools.bag.rerunning.programs import TestedPrograms, named, started, tested
from lcmtools.bag.rerunning.session import Run, Session, Stopped, Wishes
from lcmtools.bag.times import LogTime, parse_time, time_window
from lcmtools.bus.base import LOCKSTEP
from lcmtools.clock import CLOCK_TOPIC, join_stamp
from lcmtools.errors import DecodeError, explained
from lcmtools.graph.model import Role
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.filter import Filter
from lcmtools.messages.registry import Message
from lcmtools.messages.supply import has_supply
from lcmtools.names import Pattern, base_name_of, did_you_mean, is_hidden
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.packages import provide_user_types
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.wire.packet import Packet


class Input(NamedTuple):
    """A message of the log, as a function that changes the inputs gets and returns it."""

    time: int  # [ns since 1970]
    topic: str
    message: Message


Change: TypeAlias = Callable[[Input], Input | Iterable[Input] | None] | Mapping[str, str]
"""A function that returns an input as it is, changed, later, several times, or None for lost; or
conditions by topics, as of ``bag filter``: messages that do not meet them are lost."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """Options for running a program again."""

    arguments: Sequence[str] = ()  # of a node in this process: "__ns:=/husky0"
    rate: float | None = None  # seconds of the log per second; None for lock-step if possible
    start: LogTime | None = None
    end: LogTime | None = None
    inputs: Sequence[str] = ()  # the only topics that are played; none for all
    outputs: Sequence[str] = ()  # topics that are compared, beside those of the programs
    timeout: float = 10.0  # [s] without an answer after which the program hangs
    tolerance: Tolerance = field(default_factory=Tolerance)
    contract: Contract | None = None  # with tolerances of topics
    twice: bool = False  # run it twice, and compare both runs byte for byte
    change: Change | None = None  # of the inputs


@dataclass(frozen=True, slots=True)
class Rerun:
    """The result. ``bool`` of it is True if the program says the same as in the recording."""

    log: str
    program: str
    run: Run
    topics: tuple[TopicComparison, ...]
    trouble: tuple[str, ...]  # sentences on what went wrong, beside the differences
    notes: tuple[str, ...]  # what could not be played or compared
    seconds: float  # of the log
    duration: float  # of the run [s]
    start: int  # [ns since 1970]
    recorded: Mapping[str, Sequence[Compared]]  # by topic
    rerun: Mapping[str, Sequence[Compared]]
    read: Callable[[str, bytes], Message]

    @property
    def is_equal(self) -> bool:
        """True if nothing differs, and nothing went wrong."""
        return not self.trouble and all(topic.is_equal for topic in self.topics)

    def after(self, time: int) -> float:
        """Return the seconds from the start of what was played to a time of the log [ns]."""
        return (time - self.start) / 1e9

    def __bool__(self) -> bool:
        """Return whether the program says the same."""
        return self.is_equal

    def __str__(self) -> str:
        """Return the report as text."""
        from lcmtools.bag.rerunning.rerun_report import rows

        return "\n".join(rows(self))


def rerun_log(
    log: str | Path,
    program: TestedPrograms,
    manner: Manner,
    on_time: Callable[[float], None] = lambda _: None,
) -> Rerun:
    """Run a program with the messages of a log, and compare what it publishes with the log.

    ``on_time`` is called with the part of the log that was played, 0 to 1.

    Raises:
        BusError: The log cannot be read.
        UsageError: A topic or a time is wrong.
        LcmtoolsError: The log is empty, or the program cannot be started.
    """
    if not has_supply():
        provide_user_types()
    notes: list[str] = []
    with Playlist([log], Choice(), notes.append) as playlist:
        result = _Rerunner(playlist, manner, on_time).result(str(log), program)
    return replace(result, notes=(*notes, *result.notes))


@explained
def rerun(  # noqa: PLR0913 - each is a separate option
    log: str | Path,
    program: str | Sequence[str] | TestedPrograms,
    *,
    arguments: Sequence[str] = (),
    inputs: Change | None = None,
    outputs: Sequence[str] = (),
    start: str | None = None,
    end: str | None = None,
    tolerance: float = Tolerance().absolute,
    relative: float = Tolerance().relative,
    against: str | Path | None = None,
    rate: float | None = None,
    timeout: float = 10.0,
    twice: bool = False,
) -> Rerun:
    """Run a program with the messages of a log, and compare what it publishes with the log.

    As ``lcmtools bag rerun`` does. The result is true if nothing differs and nothing went wrong;
    ``str`` of it is the report:

        def test_my_controller():
            result = lcmtools.bag.rerun("drive.lcmlog", MyController, arguments=["__ns:=/husky0"])
            assert result, result

    Args:
        log: The log.
        program: A class of nodes, of which one is made in this process; or a command line.
        arguments: The command line of the node in this process.
        inputs: Changes the inputs: a function of each ``Input`` that returns it as it is, changed,
            at another time, several times, or None to lose it; or conditions as of ``bag filter``
            by topics.
        outputs: Topics to compare beside those that the program announces.
        start: Begin at this time of the log: "10s", "end-1m".
        end: End at this time.
        tolerance: The largest difference of numbers that counts as none.
        relative: The same as a part of their size.
        against: A file with tolerances of topics and fields, as of ``bag check``.
        rate: Play in real time at this rate; None for lock-step, if possible.
        timeout: Time without an answer after which the program hangs [s].
        twice: Run it twice, and compare both runs byte for byte.

    Raises:
        BusError: The log cannot be read.
        UsageError: An argument is wrong.
        LcmtoolsError: The log is empty, or the program cannot be started.
    """
    manner = Manner(
        arguments=arguments,
        change=inputs,
        outputs=outputs,
        start=None if start is None else parse_time(start),
        end=None if end is None else parse_time(end),
        tolerance=Tolerance(tolerance, relative),
        contract=None if against is None else read_contract(against),
        rate=rate,
        timeout=timeout,
        twice=twice,
    )
    return rerun_log(log, tested(program), manner)


class _Rerunner:
    """The runs of one call."""

    def __init__(
        self, playlist: Playlist, manner: Manner, on_time: Callable[[float], None]
    ) -> None:
        self._playlist, self._manner, self._on_time = playlist, manner, on_time
        self._window = time_window(playlist.span, manner.start, manner.end)
        announced = playlist.announced()
        self._decoder = Decoder(announced.types_of)
        self._tracks = {track.topic: track for track in playlist.tracks}
        for topic in (*manner.inputs, *manner.outputs):
            self._check_topic(topic)
        nodes = announced.snapshot(0).nodes
        self._latched = {end.topic for node in nodes for end in node.endpoints if end.latched}

    def result(self, log: str, program: TestedPrograms) -> Rerun:
        """Run the program, and compare."""
        began = time.monotonic()
        run = self._run(program)
        duration = time.monotonic() - began
        trouble = [run.trouble] if run.trouble else []
        trouble += run.errors
        outputs = run.published_topics() | set(self._manner.outputs)
        rerun = _by_topic(
            (one.topic, Compared(one.time, one.payload, one.is_by_timer, one.cause, one.delay))
            for one in run.outputs
            if one.topic in outputs
        )
        if self._manner.twice and not run.trouble:
            trouble += self._second(program, outputs, rerun)
        start, end = self._window
        recorded = _by_topic(
            (one.topic, Compared(one.time, bytes(one.payload)))
            for one in self._playlist.messages(start, end, outputs)
        )
        topics = tuple(
            self._compared(topic, recorded.get(topic, ()), rerun.get(topic, ()), run)
            for topic in sorted(outputs & (recorded.keys() | rerun.keys()))
        )
        if not run.trouble:
            trouble += self._idle(run, topics)
        seconds = (end - start) / 1e9
        notes = tuple(self._notes(run))
        return Rerun(
            log,
            named(program),
            run,
            topics,
            tuple(trouble),
            notes,
            seconds,
            duration,
            start,
            recorded,
            rerun,
            self._read,
        )

    def _run(self, program: TestedPrograms) -> Run:
        """Run the program once; a second time in real time if it is not one for lock-step."""
        why = f"--rate {self._manner.rate:g}" if self._manner.rate is not None else ""
        with PrivateBus() as bus:
            variables = {"LCM_DEFAULT_URL": bus.url}
            start = {} if why else {LOCKSTEP: str(self._start_of_clock())}
            run, reason = self._session(bus, program, {**variables, **start}, why)
        if reason:  # the nodes wait for simulated time that does not come by itself
            with PrivateBus() as bus:
                variables = {"LCM_DEFAULT_URL": bus.url}
                run, _ = self._session(bus, program, variables, reason)
        return run

    def _session(
        self, bus: PrivateBus, program: TestedPrograms, variables: Mapping[str, str], why: str
    ) -> tuple[Run, str]:
        """Return a run, and why it is to be done again in real time; ``why`` it is already."""
        start, end = self._window
        length = max(1, end - start)
        wishes = Wishes(
            start,
            self._manner.timeout,
            self._manner.inputs,
            self._manner.outputs,
            makes_clock=CLOCK_TOPIC not in self._tracks,
            on_time=lambda now: self._on_time((now - start) / length),
        )
        words = self._manner.arguments
        with started(program, variables, words) as programs:
            session = Session(bus, programs, wishes)
            try:
                reason = session.begin()
                if reason and session.has_nodes and not why:
                    return session.run, reason
                session.run.real_time = why or reason
                if session.run.real_time:
                    rate = 1.0 if self._manner.rate is None else self._manner.rate
                    now = time.monotonic_ns()
                    session.real_time(Player(self._messages, self._window, rate=rate, now=now))
                else:
                    session.lockstep(self._messages(start, end), end)
            except Stopped as stop:
                session.run.trouble = str(stop)
                session.run.last_lines = programs.last_lines()
            else:
                if session.run.errors:
                    session.run.last_lines = programs.last_lines()
            return session.run, ""

    def _messages(self, start: int, end: int) -> Iterator[Played]:
        """Return the messages to play: latched ones from before the start first."""
        before = self._playlist.latest(self._latched, start - 1) if self._latched else []
        earlier = (one._replace(time=start) for one in before)
        found = self._playlist.messages(start, end)
        if self._manner.change is not None:
            found = self._changed(found)
        yield from earlier
        yield from found

    def _changed(self, messages: Iterable[Played]) -> Iterator[Played]:
        change = self._manner.change
        if isinstance(change, Mapping):
            change = _conditions(change)
        assert change is not None
        found: list[Played] = []
        for one in messages:
            try:
                message = self._read(one.topic, one.payload)
            except DecodeError:
                found.append(one)
                continue
            answer = change(Input(one.time, one.topic, message))
            some = [answer] if isinstance(answer, Input) else list(answer or ())
            found += (Played(new.time, new.topic, encode(new.message)) for new in some)
        return iter(sorted(found, key=lambda one: one.time))

    def _start_of_clock(self) -> int:
        """Return the time at which nodes start: of the log, or of its own first ``/clock``."""
        start, end = self._window
        for one in self._playlist.messages(start, end, [CLOCK_TOPIC]):
            clock = decode(Clock, one.payload).clock
            return max(0, join_stamp(clock.sec, clock.nsec))
        return max(0, start)

    def _second(
        self,
        program: TestedPrograms,
        outputs: set[str],
        first: Mapping[str, Sequence[Compared]],
    ) -> list[str]:
        """Run the program a second time; return a sentence where the runs part."""
        run = self._run(program)
        if run.trouble:
            return [f"in the second run, {run.trouble}"]
        second = _by_topic(
            (one.topic, Compared(one.time, one.payload))
            for one in run.outputs
            if one.topic in outputs
        )
        for topic in sorted(outputs):
            one, other = first.get(topic, ()), second.get(topic, ())
            place = part_of(one, other)
            if place is not None:
                at = next(each[place].time for each in (one, other) if place < len(each))
                after = (at - self._window[0]) / 1e9
                return [f"two runs part at message {place + 1} of {topic}, {after:.3f} s"]
        return []

    def _compared(
        self, topic: str, recorded: Sequence[Compared], rerun: Sequence[Compared], run: Run
    ) -> TopicComparison:
        tolerance = self._tolerance(topic)
        found = compare(
            topic, recorded, rerun, self._read, tolerance, judges_delay=not run.real_time
        )
        found.is_judged = topic in self._tracks or topic in self._manner.outputs
        return found

    def _tolerance(self, topic: str) -> Tolerance:
        usual, contract = self._manner.tolerance, self._manner.contract
        if contract is None:
            return usual
        terms = next(
            (one for one in contract.topics if Pattern(one.pattern, hidden=True).matches(topic)),
            TopicTerms("", 0),
        )
        limits = {**contract.limits, **terms.limits}
        return Tolerance(
            limits.get("tolerance", usual.absolute),
            limits.get("relative", usual.relative),
            limits.get("delay", usual.delay),
            terms.match == "order",
            terms.fields,
        )

    def _idle(self, run: Run, topics: Sequence[TopicComparison]) -> Iterator[str]:
        """Yield sentences on a program that heard or said nothing."""
        if not run.inputs and not run.outputs:
            wanted = _subscriptions(run)
            hint = next(filter(None, map(self._near, wanted)), "")
            names = ", ".join(sorted(wanted)) or "nothing"
            more = f"; {hint}" if hint else ""
            yield f"no message of the log was for the program, which subscribes to {names}{more}"
        elif not any(topic.is_judged for topic in topics):
            names = ", ".join(topic.topic for topic in topics) or "nothing"
            yield f"there is nothing to compare: it published {names}, which the log does not have"

    def _notes(self, run: Run) -> Iterator[str]:
        """Yield sentences on subscriptions that the log does not serve."""
        ends = {
            end.topic: end.fingerprints
            for node in run.announced.values()
            for end in node.having(Role.SUBSCRIBER)
        }
        own = run.published_topics()
        for topic in sorted(_subscriptions(run) - own):
            track = self._tracks.get(topic)
            if track is None:
                hint = self._near(topic)
                yield f"the log has no {topic}{f'; {hint}' if hint else ''}"
            elif ends[topic] and track.fingerprint not in ends[topic]:
                kind = track.type or "an unknown type"
                yield f"{topic} has {kind} in the log, of another version than the program expects"

    def _near(self, topic: str) -> str:
        """Return the topic of the log that is likely to be meant, as a question; "" for none."""
        ends = (one for one in self._tracks if base_name_of(one) == base_name_of(topic))
        near = did_you_mean(topic, self._tracks)
        return near or next((f"did you mean {one}?" for one in ends), "")

    def _read(self, topic: str, payload: bytes) -> Message:
        return self._decoder.decode(Packet(topic, payload, 0))

    def _check_topic(self, topic: str) -> None:
        if topic in self._manner.inputs and topic not in self._tracks:
            from lcmtools.bag.edits import TopicChoice

            TopicChoice([topic]).check(self._tracks)


def _subscriptions(run: Run) -> set[str]:
    ends = (end for node in run.announced.values() for end in node.having(Role.SUBSCRIBER))
    return {end.topic for end in ends if end.topic != CLOCK_TOPIC and not is_hidden(end.topic)}


def _conditions(expressions: Mapping[str, str]) -> Callable[[Input], Input | None]:
    filters = {topic: Filter(text) for topic, text in expressions.items()}

    def keep(one: Input) -> Input | None:
        condition = filters.get(one.topic)
        return one if condition is None or condition.matches(one.message) else None

    return keep


def _by_topic(messages: Iterable[tuple[str, Compared]]) -> dict[str, list[Compared]]:
    found: dict[str, list[Compared]] = {}
    for topic, one in messages:
        found.setdefault(topic, []).append(one)
    return found
