"""``lcmtools hz``."""

import json
from collections.abc import Mapping, Sequence

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.output import data, lines, talk
from lcmtools.cli.topic.measuring import measure, measuring_options, window_option
from lcmtools.cli.topic.table import table
from lcmtools.messages.filter import Filter
from lcmtools.observe.arrival import Arrival
from lcmtools.observe.batches import ListenOptions, batches
from lcmtools.observe.losses import losses, total
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.rates import Rate, RateWindow

_HEADER = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


@click.command("hz", context_settings=CONTEXT)
@click.argument(
    "topics", metavar="TOPIC...", nargs=-1, required=True, shell_complete=complete("bus:topics")
)
@window_option(least=2, usual=50_000)
@click.option(
    "--filter", "condition", metavar="EXPR", help="Count messages for which this is true."
)
@measuring_options
@json_option
@looking_options
def command(  # noqa: PLR0913 - one parameter an option
    topics: tuple[str, ...],
    *,
    window: int,
    condition: str | None,
    timeout: float | None,
    count: int | None,
    wall_time: bool,
    as_json: bool,
) -> None:
    """Measure how often messages come on topics, once a second until Ctrl-C.

    Times are the kernel's, or, where a simulator publishes /clock, simulated ones. A message need
    not be of a known type. A log is read at once, by its own times.

    \b
    Examples:
      lcmtools hz /husky0/odometry
      lcmtools hz EXAMPLE /chatter -w 100
      lcmtools hz /chatter --filter "m.data != ''" -n 1 --timeout 5s
    """  # noqa: D301 - \b is click's mark
    how = ListenOptions(
        timeout,
        count,
        wall_time,
        Filter(condition) if condition is not None else None,
        looking_names(),
    )
    meters = {topic: _Meter(window) for topic in topics}

    def report(found: Mapping[str, Rate | None]) -> None:
        _report(found, as_json=as_json)

    with open_monitor("hz", whole=condition is not None) as monitor:
        try:
            measure(batches(monitor, tuple(meters), how), meters, report, count)
        finally:
            _tell_loss(monitor, tuple(meters))
        for topic, meter in meters.items():
            if meter.arrivals.total == 1:
                talk(f"lcmtools hz: only one message came on {topic}: a rate takes two")


def _tell_loss(monitor: BusMonitor, topics: Sequence[str]) -> None:
    """Say whose messages did not all come: the rates are those of what came."""
    graph, known = monitor.graph(), losses(monitor.numbered)
    for topic in topics:
        for spelling in looking_names().spellings(topic):
            for seen in graph.topic(spelling).traffic:
                loss = total([seen.sender], known)
                if loss and loss.lost:
                    what = f"of {seen.sender}, which sends {spelling}, {loss} messages did not"
                    talk(f"lcmtools hz: {what} arrive here; lcmtools wtf looks closer")


class _Meter:
    """The rate of a topic."""

    def __init__(self, window: int) -> None:
        self.arrivals = RateWindow(window)

    def add(self, arrival: Arrival) -> None:
        self.arrivals.extend([arrival.time])

    def take(self, _now: int) -> Rate | None:
        return self.arrivals.take()

    def clear(self) -> None:
        self.arrivals.clear()


def _report(rates: Mapping[str, Rate | None], *, as_json: bool) -> None:
    if as_json:
        for topic, rate in rates.items():
            data(_json(topic, rate))
    elif not any(rates.values()):
        data("no new messages")
    elif len(rates) > 1:
        lines(table(_HEADER, [_cells(topic, rate) for topic, rate in rates.items()]))
    else:
        data("\n".join(_text(rate) for rate in rates.values() if rate))


def _text(rate: Rate) -> str:
    """The lines of rostopic hz."""
    return (
        f"average rate: {rate.mean:.3f}\n"
        f"\tmin: {rate.shortest:.3f}s max: {rate.longest:.3f}s"
        f" std dev: {rate.deviation:.5f}s window: {rate.window}"
    )


def _cells(topic: str, rate: Rate | None) -> list[str]:
    """A row of the table; dashes for a topic on which nothing new has come."""
    if rate is None:
        return [topic, *"-----"]
    numbers = (rate.mean, rate.shortest, rate.longest, rate.deviation)
    return [topic, *(f"{number:.4}" for number in numbers), str(rate.window)]


def _json(topic: str, rate: Rate | None) -> str:
    if rate is None:
        return json.dumps({"topic": topic, "rate": None})
    return json.dumps(
        {
            "topic": topic,
            "rate": rate.mean,
            "min": rate.shortest,
            "max": rate.longest,
            "std_dev": rate.deviation,
            "window": rate.window,
        }
    )
