"""``lcmtools hz``, ``bw`` and ``delay``: a report a second, as rostopic prints it."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass
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
from lcmtools.observe.rates import (
    Bandwidth,
    BandwidthWindow,
    DelayWindow,
    RateWindow,
    Statistics,
    Window,
)

_GAP = "   "
_KILO = 1e3


@dataclass(frozen=True, slots=True)
class _Form:
    """The printed form of a measurement."""

    keys: Sequence[str]  # of its fields in JSON
    columns: Sequence[str]  # of the table, behind the topic
    text: str  # of its cells or fields, in the lines of rostopic
    cells: Callable[[Any], list[str]]
    fields: Callable[[Any], Sequence[object]] = astuple  # that text has
    nothing: str = "no new messages"


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


def _seconds(value: Statistics) -> list[str]:
    numbers = (value.mean, value.shortest, value.longest, value.deviation)
    return [*(f"{number:.4}" for number in numbers), str(value.window)]


def _bytes(value: Bandwidth) -> list[str]:
    """Average, mean, smallest and largest, all in the unit that suits the average."""
    sizes = ((1.0, "B"), (_KILO, "KB"), (_KILO**2, "MB"))
    factor, unit = sizes[(value.average >= _KILO) + (value.average >= _KILO**2)]
    numbers = (value.average, value.mean, value.smallest, value.largest)
    average, *others = [f"{number / factor:.2f}{unit}" for number in numbers]
    return [f"{average}/s", *others, str(value.window)]


_SPREAD = "\n\tmin: {:.3f}s max: {:.3f}s std dev: {:.5f}s window: {}"


def _statistics_form(name: str, of: str) -> _Form:
    return _Form(
        (name, "min", "max", "std_dev", "window"),
        (name, f"min_{of}", f"max_{of}", "std_dev", "window"),
        f"average {name}: {{:.3f}}{_SPREAD}",
        _seconds,
    )


_RATE = _statistics_form("rate", "delta")
_DELAY = _statistics_form("delay", "delay")
_BANDWIDTH = _Form(
    ("bytes_per_second", "mean_bytes", "min_bytes", "max_bytes", "window"),
    ("average", "mean", "min", "max", "window"),
    "average: {}\n\tmean: {} min: {} max: {} window: {}",
    _bytes,
    _bytes,
    nothing="",
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
            _measure(monitor, windows, lambda found: found.time, _RATE, wanted, **ending)
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
        _measure(monitor, windows, lambda a: (a.time, a.packet.size), _BANDWIDTH, **ending)
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
        _measure(monitor, windows, Delays(Decoder(monitor.types_of), notify), _DELAY, **ending)


def _measure(
    monitor: BusMonitor,
    windows: Mapping[str, Window[ItemT, Any]],
    item: Callable[[SelectedPacket], ItemT | None],
    form: _Form,
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
        else:
            _print(report.found, form, as_json=as_json)


def _print(found: Mapping[str, Any], form: _Form, *, as_json: bool) -> None:
    """Print values by topic, None for nothing new: JSON, a table, or one topic's lines."""
    if as_json:
        for topic, value in found.items():
            pairs = zip(form.keys, astuple(value), strict=True) if value else [(form.keys[0], None)]
            data(json.dumps({"topic": topic, **dict(pairs)}))
    elif not any(found.values()):
        lines([form.nothing] * bool(form.nothing))
    elif len(found) > 1:
        rows = [[topic, *(form.cells(one) if one else "-----")] for topic, one in found.items()]
        lines(table(("topic", *form.columns), rows))
    else:
        data("\n".join(form.text.format(*form.fields(one)) for one in found.values() if one))


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table as rostopic hz prints it: centred header, a rule, rows, an empty line."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    rule = "=" * (sum(widths) + len(_GAP) * (len(widths) - 1))
    head, *body = (
        _GAP.join(f"{cell:{side}{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for side, row in (("^", header), *(("<", row) for row in rows))
    )
    return [head, rule, *body, ""]


def _tell_single(windows: Mapping[str, Window[Any, Any]], noun: str) -> None:
    for topic, window in windows.items():
        if window.total == 1:
            notify(f"only one message came on {topic}: a {noun} takes two")
