"""``lcmtools hz``."""

import json
from collections.abc import Mapping
from functools import partial

import click

from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_watch, whole_number
from lcmtools.cli.output import data, lines
from lcmtools.cli.topic.table import table
from lcmtools.cli.topic.turns import reported_when_interrupted, timeout_option, turns
from lcmtools.graph.rates import Rate, RateWindow

_HEADER = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


@click.command("hz", context_settings=CONTEXT)
@click.argument("topics", metavar="TOPIC...", nargs=-1, required=True)
@click.option(
    "-w",
    "--window",
    metavar="N",
    type=whole_number(2),
    default=50_000,
    help="Messages to average over.",
)
@timeout_option
@json_option
@bus_options
def command(topics: tuple[str, ...], *, window: int, timeout: float | None, as_json: bool) -> None:
    """Measure how often messages come on topics, once a second until Ctrl-C.

    The times are the kernel's; a message need not be of a known type.

    \b
    Examples:
      lcmtools hz /husky0/odometry
      lcmtools hz EXAMPLE /chatter -w 100
    """  # noqa: D301 - \b is click's mark
    windows = {topic: RateWindow(window) for topic in topics}

    def report(*, is_last: bool = False) -> None:
        rates = {topic: arrivals.take() for topic, arrivals in windows.items()}
        if any(rates.values()) or not is_last:
            _report(rates, as_json=as_json)

    last_report = partial(report, is_last=True)
    with open_watch("hz") as watch, reported_when_interrupted(last_report):
        for turn in turns(watch, tuple(windows), timeout):
            for topic, packet in turn.arrivals:
                windows[topic].extend([packet.time])
            if turn.is_due:
                report()


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
