"""The options of hz, bw and delay, and the reports that they print."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple
from typing import TYPE_CHECKING, Any, TypeVar

import click

from lcmtools.cli.declare import duration, option, whole_number
from lcmtools.cli.output import data, lines, talk

if TYPE_CHECKING:
    from lcmtools.observe.measure import ListenOptions, Meter
    from lcmtools.observe.monitor import BusMonitor

CommandT = TypeVar("CommandT", bound=Callable[..., object])
FoundT = TypeVar("FoundT")

_GAP = "   "


def measuring_options(command: CommandT) -> CommandT:
    """Add ``--timeout``, ``-n`` and ``--wall-time``, which are ``ListenOptions``."""
    timeout = option("--timeout", type=duration, help="Exit with code 4 when none comes in time.")
    count = option("-n", "count", metavar="N", type=whole_number(1), help="Stop after N reports.")
    wall_time = option(
        "--wall-time", is_flag=True, help="Use real time even if a simulator publishes /clock."
    )
    return timeout(count(wall_time(command)))


def window_option(*, least: int, usual: int) -> Callable[[CommandT], CommandT]:
    """Add ``--window``, with the smallest window and the usual one in messages."""
    return option(
        "-w",
        "--window",
        metavar="N",
        type=whole_number(least),
        default=usual,
        show_default=True,
        help="The number of messages to average over.",
    )


def notify(text: str) -> None:
    """Say something in the name of the command that runs."""
    talk(f"{click.get_current_context().command_path}: {text}")


def measure(
    monitor: "BusMonitor",
    meters: "Mapping[str, Meter[FoundT]]",
    options: "ListenOptions",
    show: Callable[[Mapping[str, FoundT | None]], None],
) -> None:
    """Measure topics until the options, a log or Ctrl-C end it, and show each report."""
    from lcmtools.observe.measure import Measurement

    measurement = Measurement(monitor, meters, options, notify)
    for channel in measurement.channels:
        talk(f"subscribed to [{channel}]")
    if measurement.is_simulated:
        notify("times are simulated, as /clock says; --wall-time for real ones")
    for report in measurement.reports():
        if report.is_reset:
            talk("time has reset, resetting counters")
        else:
            show(report.found)


def print_report(
    found: Mapping[str, Any],
    *,
    keys: Sequence[str],
    header: Sequence[str],
    cells: Callable[[Any], Sequence[str]],
    text: Callable[[Any], str],
    as_json: bool,
    nothing: str = "no new messages",
) -> None:
    """Print what was found of each topic: JSON, a table, or of one topic the lines of rostopic.

    Args:
        found: A value by topic; None for nothing new.
        keys: The names of a value's fields in JSON.
        header: The columns of the table.
        cells: The row of a value, behind its topic.
        text: The lines of a value.
        as_json: Print JSON.
        nothing: The line where there is nothing new; "" for none.
    """
    if as_json:
        for topic, value in found.items():
            known = dict(zip(keys, astuple(value), strict=True)) if value else {keys[0]: None}
            data(json.dumps({"topic": topic, **known}))
    elif not any(found.values()):
        lines([nothing] * bool(nothing))
    elif len(found) > 1:
        rows = [[topic, *(cells(value) if value else "-----")] for topic, value in found.items()]
        lines(table(header, rows))
    else:
        data("\n".join(text(value) for value in found.values() if value))


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table as rostopic hz prints it: centred header, a rule, rows, an empty line."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    head = (f"{name:^{width}}" for name, width in zip(header, widths, strict=True))
    rule = "=" * (sum(widths) + len(_GAP) * (len(widths) - 1))
    return [_GAP.join(head).rstrip(), rule, *(_row(row, widths) for row in rows), ""]


def _row(cells: Sequence[str], widths: Sequence[int]) -> str:
    pairs = zip(cells, widths, strict=True)
    return _GAP.join(f"{cell:<{width}}" for cell, width in pairs).rstrip()
