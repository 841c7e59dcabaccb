"""``lcmtools hz``."""

import math
import time

import click

from lcmtools.bus.watch import Watch
from lcmtools.cli.find import ask_nodes, known_spelling, near_topic
from lcmtools.cli.options import (
    CONTEXT,
    bus_options,
    duration,
    json_option,
    open_watch,
    topic_spellings,
    whole_number,
)
from lcmtools.cli.output import data, talk
from lcmtools.errors import NothingReceived
from lcmtools.graph.rates import Rate, RateWindow

_REPORT_PERIOD = 1.0  # [s]
_PATIENCE = 2.0  # [s]


@click.command("hz", context_settings=CONTEXT)
@click.argument("topic")
@click.option(
    "-w",
    "--window",
    metavar="N",
    type=whole_number(2),
    default=50_000,
    help="Messages to average over.",
)
@click.option("--timeout", type=duration, help="Give up (exit code 4) when none comes so long.")
@json_option
@bus_options
def command(topic: str, *, window: int, timeout: float | None, as_json: bool) -> None:
    """Measure how often messages come on a topic, once a second until Ctrl-C.

    The times are the kernel's; a message need not be of a known type.

    \b
    Examples:
      lcmtools hz /husky0/odometry
      lcmtools hz EXAMPLE -w 100
    """  # noqa: D301 - \b is click's mark
    channels = set(topic_spellings(topic))
    rates = RateWindow(window)
    start = time.monotonic()
    report = start + _REPORT_PERIOD
    give_up = math.inf if timeout is None else start + timeout
    with open_watch("hz") as watch:
        known = known_spelling(ask_nodes(watch), topic)
        watch.listen_to(topic_spellings(topic))
        talk(f"subscribed to [{known or topic_spellings(topic)[-1]}]")
        while True:
            until = report if rates.total else min(report, give_up)
            try:
                rates.extend(_arrivals(watch, channels, until - time.monotonic()))
            except EOFError:  # the log has ended
                _report(rates, watch, topic, as_json=as_json, waited=0.0)
                return
            now = time.monotonic()
            if not rates.total and now >= give_up:
                raise NothingReceived(f"nothing came on {topic} within {timeout:g} s")
            if now >= report:
                _report(rates, watch, topic, as_json=as_json, waited=now - start)
                report += _REPORT_PERIOD


def _arrivals(watch: Watch, channels: set[str], timeout: float) -> list[int]:
    """When messages of the topic arrived, nanoseconds since 1970."""
    packets = watch.receive(max(0.0, timeout))
    return [packet.time for packet in packets if packet.channel in channels]


def _report(rates: RateWindow, watch: Watch, topic: str, *, as_json: bool, waited: float) -> None:
    rate = rates.take()
    if as_json:
        data(_json(topic, rate))
    elif rate is None:
        data("no new messages")
    else:
        data(_text(rate))
    if not rates.total and _PATIENCE <= waited < _PATIENCE + _REPORT_PERIOD:
        talk(f"lcmtools hz: no message on {topic} yet; {near_topic(watch.graph(), topic)}")


def _text(rate: Rate) -> str:
    """The lines of rostopic hz."""
    return (
        f"average rate: {rate.mean:.3f}\n"
        f"\tmin: {rate.shortest:.3f}s max: {rate.longest:.3f}s"
        f" std dev: {rate.deviation:.5f}s window: {rate.window}"
    )


def _json(topic: str, rate: Rate | None) -> str:
    import json

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
