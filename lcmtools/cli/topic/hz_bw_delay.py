"""``lcmtools hz``, ``bw`` and ``delay``: a report a second, as rostopic prints it."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from operator import attrgetter
from typing import Any, TypeAlias

from lcmtools.cli.bus import looking_names, notify, notify_damage, open_monitor
from lcmtools.cli.declare import (
    CommandT,
    argument,
    duration,
    examples,
    flag,
    option,
    subcommand,
    together,
    whole_number,
)
from lcmtools.cli.ending import end_with_reader
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import write_lines, write_note
from lcmtools.formats.strict_json import write_json
from lcmtools.messages.filter import Filter
from lcmtools.observe.measuring.measure import (
    Delays,
    ItemT,
    ListenOptions,
    Measurement,
    lossy_senders,
)
from lcmtools.observe.measuring.rate_report import BANDWIDTH, DELAY, RATE, ReportForm
from lcmtools.observe.measuring.rates import BandwidthWindow, DelayWindow, RateWindow, Window
from lcmtools.observe.reading.arrivals import SelectedPacket
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.monitor import BusMonitor

Windows: TypeAlias = defaultdict[str, Window[ItemT, Any]]
"""A window for each topic."""


def measured_topics(*, least: int, usual: int) -> Callable[[CommandT], CommandT]:
    """Return the argument for topics, and the option for the window's size."""
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


@subcommand("hz", measuring_options)
@examples(
    "hz /husky0/odometry",
    "hz EXAMPLE /chatter -w 100",
    "hz '/*/odometry'",
    "hz /chatter --filter \"m.data != ''\" -n 1 --timeout 5s",
)
@measured_topics(least=2, usual=50_000)
@option("--filter", "condition", metavar="EXPR", help="Count only messages for which this is true.")
@flag("--by-stamp", help="Use the times in the messages, instead of those of arrival.")
def hz(
    topics: tuple[str, ...],
    *,
    window: int,
    condition: str | None,
    by_stamp: bool,
    **ending: Any,  # noqa: ANN401 - of ``measure``
) -> None:
    """Measure the rate of topics; report once a second until Ctrl-C.

    Times of arrival are the kernel's, or simulated time if a simulator publishes /clock. The type
    need not be known. A log is read at once, with its recorded times. TOPIC may be a pattern.
    """
    wanted = Filter(condition) if condition is not None else None
    windows: Windows[int] = defaultdict(partial(RateWindow, window))
    with open_monitor("hz", whole=condition is not None or by_stamp) as monitor:
        stamps = Delays(Decoder(monitor.types_of), notify)
        time = stamps.time if by_stamp else attrgetter("time")
        try:
            measure(monitor, topics, windows, time, RATE, condition=wanted, **ending)
        finally:
            for sentence in lossy_senders(monitor, tuple(windows), looking_names()):
                notify(sentence)
    notify_single(windows, "rate")


@subcommand("bw", measuring_options)
@examples("bw /husky0/image", "bw EXAMPLE /chatter -w 1000")
@measured_topics(least=2, usual=100)
def bw(topics: tuple[str, ...], *, window: int, **ending: Any) -> None:  # noqa: ANN401 - of ``measure``
    """Measure the bandwidth of topics; report once a second until Ctrl-C.

    This counts the bytes of messages without network headers; 1 KB is 1000 bytes. Time is simulated
    if a simulator publishes /clock. A log is read at once. TOPIC may be a pattern.
    """
    windows: Windows[tuple[int, int]] = defaultdict(partial(BandwidthWindow, window))
    with open_monitor("bw") as monitor:
        measure(monitor, topics, windows, attrgetter("time", "packet.size"), BANDWIDTH, **ending)
    notify_single(windows, "bandwidth")


@subcommand("delay", measuring_options)
@examples("delay /husky0/odometry", "delay /husky0/odometry -w 100 --json")
@measured_topics(least=1, usual=50_000)
def delay(topics: tuple[str, ...], *, window: int, **ending: Any) -> None:  # noqa: ANN401 - of ``measure``
    """Measure the delay from header stamp to arrival; report once a second until Ctrl-C.

    For messages without a header, the field utime is used: microseconds since 1970, as usual in
    LCM; else timestamp, t, time_ms or the like, in the unit that makes it a time of this century,
    which is told. Between two computers the offset of their clocks adds to the delay. Both times
    are simulated if a simulator publishes /clock. A log is read at once. TOPIC may be a
    pattern.
    """
    windows: Windows[int] = defaultdict(partial(DelayWindow, window))
    with open_monitor("delay", whole=True) as monitor:
        delays = Delays(Decoder(monitor.types_of), notify)
        measure(monitor, topics, windows, delays, DELAY, log_time=False, **ending)


def measure(
    monitor: BusMonitor,
    topics: Sequence[str],
    windows: Windows[ItemT],
    item: Callable[[SelectedPacket], ItemT | None],
    form: ReportForm,
    *,
    as_json: bool,
    **options: Any,  # noqa: ANN401 - of ``ListenOptions``
) -> None:
    """Measure topics until the options, a log or Ctrl-C end it, and print each report."""
    end_with_reader()
    wanted = ListenOptions(names=looking_names(), **options)
    measurement = Measurement(monitor, topics, windows, item, wanted, notify)
    for channel in measurement.channels:
        write_note(f"subscribed to [{channel}]")
    if measurement.is_simulated:
        notify("times are simulated, from /clock; --wall-time for real time")
    for report in measurement.reports():
        if report.is_reset:
            write_note("time has reset, resetting counters")
        else:
            _print(report.found, form, as_json=as_json)
    if not options["count"]:
        notify_damage(monitor)


def _print(found: Mapping[str, Any], form: ReportForm, *, as_json: bool) -> None:
    records = (write_json(form.to_json(*one)) for one in found.items())
    write_lines(records if as_json else form.to_lines(found))


def notify_single(windows: Mapping[str, Window[Any, Any]], noun: str) -> None:
    """Write a note for topics with a single message, or a single time: too few to measure."""
    for topic, window in windows.items():
        if window.total == 1:
            notify(f"only one message came on {topic}: a {noun} needs two")
        elif window.is_timeless:
            notify(f"all messages on {topic} have the same time: a {noun} has no meaning")
