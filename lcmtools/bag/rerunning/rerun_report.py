"""The report of a rerun: as lines, as values for JSON, as JUnit's XML, as a log and a picture."""

import heapq
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from statistics import median

from lcmtools.bag.rerunning.comparison import Compared, Difference, TopicComparison
from lcmtools.bag.rerunning.rerun import Rerun
from lcmtools.bag.surgery import write_log
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.path import parse_path
from lcmtools.observe.measuring.curves import (
    Curve,
    check_suffix,
    draw_curves,
    empty_figure,
    numbers,
    write_figure,
)
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.text_table import text_table
from lcmtools.wire.packet import Packet

_HEAD = ("TOPIC", "RECORDED", "RERUN", "MATCHED", "MISSING", "EXTRA", "LATE", "DIFFER", "DELAY")
_MOST_DRAWN = 6  # fields in a picture
RECORDED = "/recorded"
"""The namespace of the recorded outputs in a saved log."""


def rows(result: Rerun) -> list[str]:
    """Return the lines of a report."""
    run, topics = result.run, result.topics
    lasted = f"{result.seconds:.1f} s of the log in {result.duration:.1f} s"
    played = f"{run.inputs} messages on {len(run.input_topics)} topics"
    found = [f"{result.program}: {played}, {lasted}, {_manner(result)}"]
    if topics:
        found += ["", *text_table([_HEAD, *map(_cells, topics)])]
    found += [f"{topic.topic}: {line}" for topic in topics for line in _details(topic, result)]
    found += [f"note: {note}" for note in result.notes]
    found += [f"FAIL {line}" for line in result.trouble]
    found += [f"  | {line}" for line in run.last_lines]
    return [*found, "equal" if result.is_equal else "different"]


def record(result: Rerun) -> dict[str, object]:
    """Return the report for JSON; times are seconds after the start of what was played."""
    run = result.run
    return {
        "log": result.log,
        "program": result.program,
        "equal": result.is_equal,
        "lockstep": not run.real_time,
        "real_time": run.real_time or None,
        "inputs": run.inputs,
        "input_topics": sorted(run.input_topics),
        "seconds": result.seconds,
        "duration": result.duration,
        "lateness": max(run.lateness, default=0) / 1e9 if run.real_time else None,
        "topics": [
            {
                "topic": one.topic,
                "equal": one.is_equal,
                "recorded": one.recorded,
                "rerun": one.rerun,
                "matched": one.matched,
                "missing": [result.after(time) for time in one.missing],
                "extra": [result.after(time) for time in one.extra],
                "late": [[result.after(time), by] for time, by in one.late],
                "differing": one.differing,
                "fields": dict(one.fields),
                "largest": _difference(one.largest, result),
                "first": _difference(one.first, result),
                "delay_recorded": one.delay_recorded,
                "delay_rerun": one.delay_rerun,
                "trouble": one.trouble or None,
            }
            for one in result.topics
        ],
        "trouble": list(result.trouble),
        "notes": list(result.notes),
        "last_lines": list(run.last_lines),
    }


def junit(result: Rerun) -> str:
    """Return JUnit's XML: a case for each topic, and one for the program."""
    failures = {"the program": [*result.trouble, *result.run.last_lines] if result.trouble else []}
    for topic in result.topics:
        failures[topic.topic] = [] if topic.is_equal else list(_details(topic, result))
    root = ET.Element("testsuites", name="lcmtools bag rerun")
    failed = str(sum(map(bool, failures.values())))
    suite = ET.SubElement(
        root, "testsuite", name=result.log, tests=str(len(failures)), failures=failed
    )
    suite.set("time", f"{result.duration:.1f}")
    for name, lines in failures.items():
        case = ET.SubElement(suite, "testcase", classname=result.program, name=name)
        if lines:
            text = "\n".join(lines)
            legal = "".join(c if c.isprintable() or c in "\n\t" else "?" for c in text)
            ET.SubElement(case, "failure", message=legal.partition("\n")[0]).text = legal
    ET.indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{ET.tostring(root, "unicode")}\n'


def save(result: Rerun, target: str, *, force: bool) -> None:
    """Write a log with the inputs, the new outputs, and the recorded ones below ``/recorded``."""
    outputs = result.rerun.keys() | result.recorded.keys()
    before = {f"{RECORDED}/{topic.lstrip('/')}" for topic in outputs}  # of an earlier saving
    with LogFile(result.log) as log:
        was = (
            one._replace(channel=f"{RECORDED}/{one.channel.lstrip('/')}")
            if one.channel in outputs
            else one
            for one in log.packets()
            if one.channel not in before
        )
        now = (
            Packet(topic, one.payload, one.time)
            for topic, messages in result.rerun.items()
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
    for place, (recorded, now, difference) in enumerate(drawn):
        draw_curves(axes[2 * place], [recorded, now], start=0.0)
        draw_curves(axes[2 * place + 1], [difference], start=0.0)
    write_figure(figure, path)


def _curves(result: Rerun) -> Iterator[tuple[Curve, Curve, Curve]]:
    for topic in result.topics:
        for name, _ in topic.fields.most_common():
            was, now = (
                _values(result, topic.topic, name, side[topic.topic])
                for side in (result.recorded, result.rerun)
            )
            curves = [
                Curve(f"{topic.topic}/{name} {what}") for what in ("recorded", "now", "difference")
            ]
            for one, other in topic.pairs:
                if one in was and other in now:
                    time = result.after(result.recorded[topic.topic][one].time)
                    for curve, value in zip(
                        curves, (was[one], now[other], now[other] - was[one]), strict=True
                    ):
                        curve.times.append(time)
                        curve.values.append(value)
            if curves[0].times:
                yield curves[0], curves[1], curves[2]


def _values(result: Rerun, topic: str, name: str, messages: Sequence[Compared]) -> dict[int, float]:
    path, found = parse_path(name), dict[int, float]()
    for number, one in enumerate(messages):
        with suppress(LcmtoolsError, ValueError):  # text, or an element that this message lacks
            ((_, found[number]),) = numbers(result.read(topic, one.payload), path)
    return found


def _manner(result: Rerun) -> str:
    run = result.run
    if not run.real_time:
        return "in lock-step" if run.inputs or not run.trouble else "it did not begin"
    late = [one / 1e6 for one in run.lateness] or [0.0]
    kept = f"inputs were late by {median(late):.1f} ms, at most {max(late):.1f} ms"
    return f"in real time ({run.real_time}); {kept}"


def _cells(topic: TopicComparison) -> tuple[str, ...]:
    lost = len(topic.missing), len(topic.extra), len(topic.late)
    counts = (topic.recorded, topic.rerun, topic.matched, *lost, topic.differing)
    delays = (topic.delay_recorded, topic.delay_rerun)
    delay = " -> ".join("-" if one is None else f"{1000 * one:.1f}" for one in delays) + " ms"
    return topic.topic, *map(str, counts), delay


def _details(topic: TopicComparison, result: Rerun) -> Iterator[str]:
    if not topic.is_judged:
        yield "the log does not have it, so it is not compared"
        return
    if topic.trouble:
        yield topic.trouble
    if topic.largest:
        within = " (within the tolerance)" if topic.largest.is_allowed else ""
        yield f"largest difference: {_at(topic.largest, result)}{within}"
    if topic.first:
        names = ", ".join(name for name, _ in topic.fields.most_common(4))
        more = len(topic.fields) - 4
        yield f"first difference: {_at(topic.first, result)}"
        yield f"differing fields: {names}{f' and {more} more' if more > 0 else ''}"
    for what, times in (("missing", topic.missing), ("extra", topic.extra)):
        if times:
            yield f"first {what}: at {result.after(times[0]):.3f} s"
    if topic.late:
        time, by = topic.late[0]
        what = "late" if by > 0 else "early"
        yield f"first {what}: at {result.after(time):.3f} s, by {abs(by):.3f} s"


def _at(one: Difference, result: Rerun) -> str:
    return f"{one} at {result.after(one.time):.3f} s"


def _difference(one: Difference | None, result: Rerun) -> dict[str, object] | None:
    if one is None:
        return None
    return {
        "field": one.field,
        "recorded": one.recorded,
        "rerun": one.rerun,
        "difference": one.size,
        "time": result.after(one.time),
    }
