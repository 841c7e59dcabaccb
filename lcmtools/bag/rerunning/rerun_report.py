"""The result of a rerun: as lines, as values for JSON, as JUnit's XML, as a log and a picture."""

import heapq
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from statistics import median

from lcmtools.bag.rerunning.comparison import Compared, TopicComparison
from lcmtools.bag.rerunning.session import Run
from lcmtools.bag.surgery import write_log
from lcmtools.errors import LcmtoolsError
from lcmtools.formats.junit import Case, Suite
from lcmtools.formats.junit import junit as xml_of
from lcmtools.messages.path import parse_path
from lcmtools.messages.registry import Message
from lcmtools.observe.measuring.curves import (
    Curve,
    check_suffix,
    draw_curves,
    empty_figure,
    numbers,
    write_figure,
)
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.text_table import plural, text_table
from lcmtools.wire.packet import Packet

_HEAD = ("TOPIC", "RECORDED", "NOW", "MATCHED", "MISSING", "EXTRA", "LATE", "DIFFER", "DELAY")
_MOST_DRAWN = 6  # fields in a picture
_MOST_NAMED = 4  # fields in a line
RECORDED = "/recorded"
"""The namespace of the recorded outputs in a saved log."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rerun:
    """The result of a rerun; it is true if the program says the same as in the recording."""

    log: str
    program: str
    run: Run
    topics: Sequence[TopicComparison]
    trouble: Sequence[str]  # sentences on what went wrong, beside the differences
    notes: Sequence[str]  # what could not be played or compared
    seconds: float  # of the log
    duration: float  # of the run [s]
    start: int  # [ns since 1970]
    recorded: Mapping[str, Sequence[Compared]]  # by topic
    now: Mapping[str, Sequence[Compared]]
    read: Callable[[str, bytes], Message]

    def __bool__(self) -> bool:
        """Return whether nothing differs, and nothing went wrong."""
        return not self.trouble and all(topic.is_equal for topic in self.topics)

    def __str__(self) -> str:
        """Return the report as text."""
        return "\n".join(to_lines(self))

    def after(self, time: int) -> float:
        """Return the seconds from the start of what was played to a time of the log [ns]."""
        return (time - self.start) / 1e9


def to_lines(result: Rerun) -> list[str]:
    """Return the lines of a report."""
    run, topics = result.run, result.topics
    lasted = f"{result.seconds:.1f} s of the log in {result.duration:.1f} s"
    played = f"{plural(run.inputs, 'message')} on {plural(len(run.input_topics), 'topic')}"
    found = [f"{result.program}: {played}, {lasted}, {_manner(run)}"]
    if topics:
        found += ["", *text_table([_HEAD, *map(_cells, topics)])]
    found += [f"{topic.topic}: {line}" for topic in topics for line in _details(topic, result)]
    found += [f"note: {note}" for note in result.notes]
    found += [f"FAIL {line.splitlines()[0]}" for line in result.trouble]
    found += [f"  | {line}" for line in run.last_lines if result.trouble]
    return [*found, "equal" if result else "different"]


def to_json(result: Rerun) -> dict[str, object]:
    """Return the report for JSON; times are seconds after the start of what was played."""
    run = result.run
    topics = []
    for topic in result.topics:
        plain = {one.name: getattr(topic, one.name) for one in fields(topic)}
        plain |= {"equal": topic.is_equal, "trouble": topic.trouble or None}
        plain["missing"], plain["extra"] = (
            list(map(result.after, times)) for times in (topic.missing, topic.extra)
        )
        plain["late"] = [[result.after(time), by] for time, by in topic.late]
        for name, one in (("largest", topic.largest), ("first", topic.first)):
            named = one and {**one._asdict(), "time": result.after(one.time)}
            plain[name] = named
        del plain["pairs"]
        topics.append(plain)
    return {
        "log": result.log,
        "program": result.program,
        "equal": bool(result),
        "lockstep": not run.real_time,
        "real_time": run.real_time or None,
        "lateness": max(run.lateness) / 1e9 if run.lateness else None,
        "inputs": run.inputs,
        "input_topics": sorted(run.input_topics),
        "seconds": result.seconds,
        "duration": result.duration,
        "topics": topics,
        "trouble": list(result.trouble),
        "notes": list(result.notes),
        "last_lines": run.last_lines if result.trouble else [],
    }


def junit(result: Rerun) -> str:
    """Return JUnit's XML: a case for each topic, and one for the program."""
    cases = {"the program": [*result.trouble, *result.run.last_lines] if result.trouble else []}
    for topic in result.topics:
        cases[topic.topic] = [] if topic.is_equal else list(_details(topic, result))
    found = [
        Case(result.program, name, next(iter(lines), ""), lines) for name, lines in cases.items()
    ]
    return xml_of("lcmtools bag rerun", [Suite(result.log, found, result.duration)])


def save(result: Rerun, target: str, *, force: bool) -> None:
    """Write a log with the inputs, the new outputs, and the recorded ones below ``/recorded``."""
    moved = {one: f"{RECORDED}/{one.lstrip('/')}" for one in {*result.now, *result.recorded}}
    with LogFile(result.log) as log:
        was = (
            one._replace(channel=moved.get(one.channel, one.channel))
            for one in log.packets()
            if one.channel not in moved.values()  # of an earlier saving
        )
        now = (
            Packet(topic, one.payload, one.time)
            for topic, messages in result.now.items()
            for one in messages
        )
        ordered = sorted(now, key=lambda one: one.time)
        write_log(target, heapq.merge(was, ordered, key=lambda one: one.time), [log], force=force)


def draw(result: Rerun, path: Path) -> None:
    """Draw the fields that differ most, recorded and now, and below each the difference.

    Raises:
        MissingExtra: matplotlib is missing.
        UsageError: The file's suffix is not one of a picture.
        LcmtoolsError: Nothing differs that can be drawn, or the file cannot be written.
    """
    check_suffix(path)
    drawn = list(_curves(result))[:_MOST_DRAWN]
    if not drawn:
        raise LcmtoolsError("no field of numbers differs", "leave out --plot")
    figure = empty_figure(10, 4.5 * len(drawn))
    axes = figure.subplots(2 * len(drawn), squeeze=False, height_ratios=[2, 1] * len(drawn))[:, 0]
    for place, (*both, difference) in enumerate(drawn):
        draw_curves(axes[2 * place], both, start=0.0)
        draw_curves(axes[2 * place + 1], [difference], start=0.0)
    write_figure(figure, path)


def _curves(result: Rerun) -> Iterator[list[Curve]]:
    for topic in result.topics:
        for name, _ in topic.fields.most_common():
            label, recorded = f"{topic.topic}/{name}", result.recorded[topic.topic]
            was = _values(result, topic.topic, name, recorded)
            now = _values(result, topic.topic, name, result.now[topic.topic])
            pairs = [(one, other) for one, other in topic.pairs if one in was and other in now]
            times = [result.after(recorded[one].time) for one, _ in pairs]
            first, second = [was[one] for one, _ in pairs], [now[other] for _, other in pairs]
            both = zip(first, second, strict=True)
            values = {"recorded": first, "now": second, "difference": [b - a for a, b in both]}
            if pairs:
                yield [Curve(f"{label} {what}", times, some) for what, some in values.items()]


def _values(result: Rerun, topic: str, name: str, messages: Sequence[Compared]) -> dict[int, float]:
    path, found = parse_path(name), dict[int, float]()
    for number, one in enumerate(messages):
        with suppress(LcmtoolsError, ValueError):  # text, or an element that this message lacks
            ((_, found[number]),) = numbers(result.read(topic, one.payload), path)
    return found


def _manner(run: Run) -> str:
    if not run.real_time:
        return "in lock-step" if run.inputs or not run.trouble else "it did not begin"
    late = [one / 1e6 for one in run.lateness] or [0.0]
    kept = f"inputs were late by {median(late):.1f} ms, at most {max(late):.1f} ms"
    return f"in real time ({run.real_time}); {kept}"


def _cells(topic: TopicComparison) -> tuple[str, ...]:
    lost = len(topic.missing), len(topic.extra), len(topic.late)
    counts = (topic.recorded, topic.now, topic.matched, *lost, topic.differing)
    delays = (topic.delay_recorded, topic.delay_now)
    delay = " -> ".join("-" if one is None else f"{1000 * one:.1f} ms" for one in delays)
    return topic.topic, *map(str, counts), delay


def _details(topic: TopicComparison, result: Rerun) -> Iterator[str]:
    if not topic.is_judged:
        yield "the log does not have it, so it is not compared"
        return
    if topic.trouble:
        yield topic.trouble
    for what, one in (("largest", topic.largest), ("first", topic.first)):
        if one:
            within = " (within the tolerance)" if one.is_allowed else ""
            yield f"{what} difference: {one} at {result.after(one.time):.3f} s{within}"
    if topic.fields:
        names = ", ".join(name for name, _ in topic.fields.most_common(_MOST_NAMED))
        more = len(topic.fields) - _MOST_NAMED
        yield f"differing fields: {names}{f' and {more} more' if more > 0 else ''}"
    late = [time for time, _ in topic.late]
    for what, times in (("missing", topic.missing), ("extra", topic.extra), ("late", late)):
        if times:
            by = f", by {topic.late[0][1]:.3f} s" if what == "late" else ""
            yield f"first {what}: at {result.after(times[0]):.3f} s{by}"
