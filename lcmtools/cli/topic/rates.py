"""``lcmtools hz``, ``bw`` and ``delay``: a report a second, as rostopic prints it."""

import json
from collections.abc import Callable, Mapping
from typing import Any

from lcmtools.cli.bus import looking_names, notify, open_monitor
from lcmtools.cli.declare import (
    CommandT,
    argument,
    duration,
    examples,
    option,
    subcommand,
    together,
    whole_number,
)
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import data, lines, talk
from lcmtools.messages.filter import Filter
from lcmtools.observe.arrivals import SelectedPacket
from lcmtools.observe.decoding import Decoder
from lcmtools.observe.measure import Delays, ItemT, ListenOptions, Measurement, lossy_senders
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.rate_report import BANDWIDTH, DELAY, RATE, ReportForm
from lcmtools.observe.rates import BandwidthWindow, DelayWindow, RateWindow, Window


def _topics(*, least: int, usual: int) -> Callable[[CommandT], CommandT]:
    """The topics that are measured, and the window with its smallest and usual size."""
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


_ending_options = together(
    option("--timeout", type=duration, help="Exit with code 4 when none comes in time."),
    option("-n", "count", metavar="N", type=whole_number(1), help="Stop after N reports."),
    option("--wall-time", is_flag=True, help="Use real time even if a simulator publishes /clock."),
    json_option,
    looking_options,
)


@subcommand("hz", _ending_options)
@examples(
    "hz /husky0/odometry",
    "hz EXAMPLE /chatter -w 100",
    "hz /chatter --filter \"m.data != ''\" -n 1 --timeout 5s",
)
@_topics(least=2, usual=50_000)
@option("--filter", "condition", metavar="EXPR", help="Count only messages for which this is true.")
def hz(topics: tuple[str, ...], *, window: int, condition: str | None, **ending: Any) -> None:  # noqa: ANN401 - of _measure
    """Measure the rate of topics; report once a second until Ctrl-C.

    Times of arrival are the kernel's, or simulated time if a simulator publishes /clock. The type
    need not be known. A log is read at once, with its recorded times.
    """
    wanted = Filter(condition) if condition is not None else None
    windows = {topic: RateWindow(window) for topic in topics}
    with open_monitor("hz", whole=condition is not None) as monitor:
        try:
            _measure(monitor, windows, lambda found: found.time, RATE, wanted, **ending)
        finally:
            for sentence in lossy_senders(monitor, topics, looking_names()):
                notify(sentence)
    _tell_single(windows, "rate")


@subcommand("bw", _ending_options)
@examples("bw /husky0/image", "bw EXAMPLE /chatter -w 1000")
@_topics(least=2, usual=100)
def bw(topics: tuple[str, ...], *, window: int, **ending: Any) -> None:  # noqa: ANN401 - of _measure
    """Measure the bandwidth of topics; report once a second until Ctrl-C.

    This counts the bytes of messages without network headers; 1 KB is 1000 bytes. Time is simulated
    if a simulator publishes /clock. A log is read at once.
    """
    windows = {topic: BandwidthWindow(window) for topic in topics}
    with open_monitor("bw") as monitor:
        _measure(monitor, windows, lambda a: (a.time, a.packet.size), BANDWIDTH, **ending)
    _tell_single(windows, "bandwidth")


@subcommand("delay", _ending_options)
@examples("delay /husky0/odometry", "delay /husky0/odometry -w 100 --json")
@_topics(least=1, usual=50_000)
def delay(topics: tuple[str, ...], *, window: int, **ending: Any) -> None:  # noqa: ANN401 - of _measure
    """Measure the delay from header stamp to arrival; report once a second until Ctrl-C.

    Between two computers the offset of their clocks adds to the delay. Both times are simulated if
    a simulator publishes /clock. A log is read at once.
    """
    windows = {topic: DelayWindow(window) for topic in topics}
    with open_monitor("delay", whole=True) as monitor:
        _measure(monitor, windows, Delays(Decoder(monitor.types_of), notify), DELAY, **ending)


def _measure(
    monitor: BusMonitor,
    windows: Mapping[str, Window[ItemT, Any]],
    item: Callable[[SelectedPacket], ItemT | None],
    form: ReportForm,
    condition: Filter | None = None,
    *,
    timeout: float | None,
    count: int | None,
    wall_time: bool,
    as_json: bool,
) -> None:
    """Measure topics until the options, a log or Ctrl-C end it, and print each report."""
    options = ListenOptions(timeout, count, wall_time, condition, looking_names())
    measurement = Measurement(monitor, windows, item, options, notify)
    for channel in measurement.channels:
        talk(f"subscribed to [{channel}]")
    if measurement.is_simulated:
        notify("times are simulated, from /clock; --wall-time for real time")
    for report in measurement.reports():
        if report.is_reset:
            talk("time has reset, resetting counters")
        elif as_json:
            for record in form.records(report.found):
                data(json.dumps(record))
        else:
            lines(form.rows(report.found))


def _tell_single(windows: Mapping[str, Window[Any, Any]], noun: str) -> None:
    for topic, window in windows.items():
        if window.total == 1:
            notify(f"only one message came on {topic}: a {noun} takes two")
