"""The options of commands that measure topics, and the printing of their reports."""

from collections.abc import Callable, Mapping
from typing import Any

from lcmtools.cli.bus import looking_names, notify
from lcmtools.cli.declare import CommandT, argument, duration, flag, option, together, whole_number
from lcmtools.cli.ending import end_with_reader
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import lines, talk
from lcmtools.formats.strict_json import write_json
from lcmtools.observe.measuring.measure import ItemT, ListenOptions, Measurement
from lcmtools.observe.measuring.rate_report import ReportForm
from lcmtools.observe.measuring.rates import Window
from lcmtools.observe.reading.arrivals import SelectedPacket
from lcmtools.observe.reading.monitor import BusMonitor


def measured_topics(*, least: int, usual: int) -> Callable[[CommandT], CommandT]:
    """Return the topics that are measured, and the window with its smallest and usual size."""
    window = option(
        "-w",
        "--window",
        metavar="N",
        type=whole_number(least),
        default=usual,
        show_default=True,
        help="The number of messages to average over.",
    )
    topics = argument("topics", metavar="TOPIC...", nargs=-1, required=True, completer="bus:topics")
    return together(topics, window)


measuring_options = together(
    option("--timeout", type=duration, help="Exit with code 4 if no message comes in time."),
    option("-n", "count", metavar="N", type=whole_number(1), help="Stop after N reports."),
    flag("--wall-time", help="Use real time even if a simulator publishes /clock."),
    json_option,
    looking_options,
)
"""The options whose values ``measure`` takes."""


def measure(
    monitor: BusMonitor,
    windows: Mapping[str, Window[ItemT, Any]],
    item: Callable[[SelectedPacket], ItemT | None],
    form: ReportForm,
    *,
    as_json: bool,
    **options: Any,  # noqa: ANN401 - of ``ListenOptions``
) -> None:
    """Measure topics until the options, a log or Ctrl-C end it, and print each report."""
    end_with_reader()
    wanted = ListenOptions(names=looking_names(), **options)
    measurement = Measurement(monitor, windows, item, wanted, notify)
    for channel in measurement.channels:
        talk(f"subscribed to [{channel}]")
    if measurement.is_simulated:
        notify("times are simulated, from /clock; --wall-time for real time")
    for report in measurement.reports():
        if report.is_reset:
            talk("time has reset, resetting counters")
        else:
            _print(report.found, form, as_json=as_json)


def _print(found: Mapping[str, Any], form: ReportForm, *, as_json: bool) -> None:
    records = (write_json(form.record(*one)) for one in found.items())
    lines(records if as_json else form.rows(found))


def notify_single(windows: Mapping[str, Window[Any, Any]], noun: str) -> None:
    """Say on which topics a single message came, of which nothing can be measured."""
    for topic, window in windows.items():
        if window.total == 1:
            notify(f"only one message came on {topic}: a {noun} needs two")
