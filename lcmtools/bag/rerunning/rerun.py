"""Testing a program with a recording: what it publishes now, compared with what was recorded."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from lcmtools.bag.contract import TopicTerms, read_contract
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Choice, Played, Playlist
from lcmtools.bag.rerunning.comparison import Compared, Tolerance, compare, part_of
from lcmtools.bag.rerunning.private_bus import PrivateBus
from lcmtools.bag.rerunning.programs import Tested, started, tested
from lcmtools.bag.rerunning.rerun_report import Rerun
from lcmtools.bag.rerunning.session import Input, Manner, Run, Session, Stopped
from lcmtools.bag.times import parse_time, time_window
from lcmtools.bus.base import LOCKSTEP
from lcmtools.clock import CLOCK_TOPIC, join_stamp
from lcmtools.errors import explained
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.filter import Filter
from lcmtools.messages.registry import Message
from lcmtools.messages.supply import has_supply
from lcmtools.names import Pattern, base_name_of, did_you_mean
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.packages import provide_user_types
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.wire.packet import Packet


@explained
def rerun(
    log: str | Path,
    program: str | Sequence[str] | Tested,
    on_time: Callable[[float], None] = lambda _: None,
    **options: Any,  # noqa: ANN401 - of Manner
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
        on_time: Called with the part of the log that was played, 0 to 1.
        **options: The fields of ``Manner``.

    Raises:
        BusError: The log cannot be read.
        UsageError: An option is wrong.
        LcmtoolsError: The log is empty, or the program cannot be started.
    """
    if not has_supply():
        provide_user_types()
    notes: list[str] = []
    with Playlist([log], Choice(), notes.append) as playlist:
        rerunner = _Rerunner(playlist, Manner(**options), on_time)
        return rerunner.result(str(log), tested(program), notes)


class _Rerunner:
    """The runs of one call."""

    def __init__(
        self, playlist: Playlist, manner: Manner, on_time: Callable[[float], None]
    ) -> None:
        self._playlist, self._manner, self._on_time = playlist, manner, on_time
        start, end = (
            parse_time(one) if isinstance(one, str) else one for one in (manner.start, manner.end)
        )
        self._window = time_window(playlist.span, start, end)
        self._decoder = Decoder(playlist.announced().types_of)
        self._tracks = {track.topic: track for track in playlist.tracks}
        TopicChoice(manner.only).check(self._tracks)
        self._contract = None if manner.against is None else read_contract(manner.against)

    def result(self, log: str, program: Tested, notes: list[str]) -> Rerun:
        began = time.monotonic()
        run = self._run(program)
        duration = time.monotonic() - began
        outputs = run.outputs() | set(self._manner.outputs)
        now = run.by_topic(outputs)
        was: dict[str, list[Compared]] = {}
        for one in filter(run.is_own, self._playlist.messages(*self._window, outputs)):
            was.setdefault(one.topic, []).append(Compared(one.time, bytes(one.payload)))
        trouble = [run.trouble] if run.trouble else []
        if self._manner.twice and not trouble:
            trouble += self._second(program, outputs, now)
        topics = []
        for topic in sorted(outputs & (was.keys() | now.keys())):
            both, tolerance = (was.get(topic, []), now.get(topic, [])), self._tolerance(topic)
            is_timed = not run.real_time
            found = compare(topic, both, self._read, tolerance, judges_delay=is_timed)
            found.is_judged = topic in self._tracks or topic in self._manner.outputs
            topics.append(found)
        if not trouble and not any(topic.is_judged for topic in topics):
            trouble.append(self._idle(run))
        for topic in sorted(set(self._manner.outputs) - was.keys() - now.keys()):
            hint = self._near(topic)
            trouble.append(f"{topic} is neither in the log nor published{hint and f'; {hint}'}")
        notes += self._unserved(run)
        start, end = self._window
        return Rerun(
            log=log,
            program=program.name,
            run=run,
            topics=topics,
            trouble=[*trouble, *run.errors],
            notes=notes,
            seconds=(end - start) / 1e9,
            duration=duration,
            start=start,
            recorded=was,
            now=now,
            read=self._read,
        )

    def _run(self, program: Tested) -> Run:
        """Run the program once; a second time in real time if it is not one for lock-step."""
        rate = self._manner.rate
        run = self._session(program, "" if rate is None else f"--rate {rate:g}")
        # its nodes wait for simulated time, and get none in real time
        return self._session(program, run.not_in_step) if run.not_in_step else run

    def _session(self, program: Tested, real_time: str) -> Run:
        """Play the log to the program, in real time if there is a reason for that."""
        start, end = self._window
        with PrivateBus() as bus:
            lockstep = {} if real_time else {LOCKSTEP: str(self._start_of_clock())}
            variables = {"LCM_DEFAULT_URL": bus.url, **lockstep}
            with started(program, variables, self._manner.arguments) as programs:
                session = Session(
                    bus,
                    programs,
                    self._manner,
                    self._playlist,
                    start,
                    lambda now: self._on_time((now - start) / max(1, end - start)),
                )
                run = session.run
                try:
                    reason = session.begin()
                    run.real_time = real_time or reason
                    if reason and session.has_nodes and not real_time:
                        run.not_in_step = reason
                    elif run.real_time:
                        messages = self._messages(session.is_input)
                        now, rate = time.monotonic_ns(), self._manner.rate or 1.0
                        source = lambda *_: messages  # noqa: E731 - the player never seeks
                        session.real_time(Player(source, self._window, rate=rate, now=now))
                    else:
                        messages = self._messages(session.is_input)
                        run.not_in_step = session.lockstep(messages, end)
                except Stopped as stop:
                    run.trouble = str(stop)
                run.last_lines = programs.last_lines()
                return run

    def _messages(self, is_input: Callable[[Played], bool]) -> Iterator[Played]:
        """Return the messages to play, those that were latched at the start first."""
        found = self._playlist.played(*self._window)
        return found if self._manner.inputs is None else self._changed(found, is_input)

    def _changed(
        self, messages: Iterable[Played], is_input: Callable[[Played], bool]
    ) -> Iterator[Played]:
        change = self._manner.inputs
        change = _conditions(change) if isinstance(change, Mapping) else change
        assert change is not None
        found: list[Played] = []
        for one in messages:
            if not is_input(one):
                continue
            answer = change(Input(one.time, one.topic, self._read(one.topic, one.payload)))
            some = [answer] if isinstance(answer, Input) else list(answer or ())
            found += (Played(new.time, new.topic, encode(new.message)) for new in some)
        return iter(sorted(found, key=lambda one: one.time))

    def _start_of_clock(self) -> int:
        """Return the time at which nodes start: of the log, or of its own first ``/clock``."""
        for one in self._playlist.messages(*self._window, [CLOCK_TOPIC]):
            clock = decode(Clock, one.payload).clock
            return max(0, join_stamp(clock.sec, clock.nsec))
        return max(0, self._window[0])

    def _second(
        self, program: Tested, outputs: set[str], first: Mapping[str, list[Compared]]
    ) -> list[str]:
        """Run the program a second time; return a sentence where the runs part."""
        run = self._run(program)
        if run.trouble:
            return [f"in the second run, {run.trouble}"]
        second = run.by_topic(outputs)
        for topic in sorted(outputs):
            one, other = first.get(topic, []), second.get(topic, [])
            if (place := part_of(one, other)) is not None:
                moment = max(one, other, key=len)[place].time
                after = (moment - self._window[0]) / 1e9
                return [f"two runs part at message {place + 1} of {topic}, {after:.3f} s"]
        return []

    def _tolerance(self, topic: str) -> Tolerance:
        manner, contract = self._manner, self._contract
        usual = Tolerance(manner.tolerance, manner.relative, manner.delay)
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
            is_by_order=terms.match == "order",
            fields=terms.fields,
        )

    def _idle(self, run: Run) -> str:
        """Return a sentence on a program that heard or said nothing that the log has."""
        if run.published:
            names = ", ".join(sorted({topic for topic, _ in run.published}))
            return f"there is nothing to compare: it published {names}, which the log does not have"
        wanted = run.subscriptions()
        hint = "; ".join(filter(None, map(self._near, sorted(wanted))))
        names = ", ".join(sorted(wanted)) or "nothing that is announced"
        return f"it published nothing; it subscribes to {names}{hint and f'; {hint}'}"

    def _unserved(self, run: Run) -> Iterator[str]:
        """Yield sentences on subscriptions that the log does not serve."""
        own = run.outputs()
        for topic, numbers in sorted(run.subscriptions().items()):
            track, hint = self._tracks.get(topic), self._near(topic)
            if track is None and topic not in own:
                yield f"the log has no {topic}{hint and f'; {hint}'}"
            elif track and numbers and track.fingerprint not in numbers:
                kind = track.type or "an unknown type"
                yield f"{topic} has {kind} in the log, of another version than the program expects"

    def _near(self, topic: str) -> str:
        """Return which topic of the log is likely to be meant, as a question; "" for none."""
        ends = (one for one in self._tracks if base_name_of(one) == base_name_of(topic))
        near = did_you_mean(topic, self._tracks)
        return near or next((f"did you mean {one}?" for one in ends), "")

    def _read(self, topic: str, payload: bytes) -> Message:
        return self._decoder.decode(Packet(topic, payload, 0))


def _conditions(expressions: Mapping[str, str]) -> Callable[[Input], Input | None]:
    filters = {topic: Filter(text) for topic, text in expressions.items()}

    def keep(one: Input) -> Input | None:
        condition = filters.get(one.topic)
        return one if condition is None or condition.matches(one.message) else None

    return keep
