"""``lcmtools bw``."""

import json
import time
from collections.abc import Mapping

import click

from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_watch, whole_number
from lcmtools.cli.output import data, lines
from lcmtools.cli.topic.table import table
from lcmtools.cli.topic.turns import reported_when_interrupted, timeout_option, turns
from lcmtools.graph.rates import Bandwidth, BandwidthWindow

_HEADER = ("topic", "average", "mean", "min", "max", "window")


@click.command("bw", context_settings=CONTEXT)
@click.argument("topics", metavar="TOPIC...", nargs=-1, required=True)
@click.option(
    "-w",
    "--window",
    metavar="N",
    type=whole_number(2),
    default=100,
    help="Messages to average over.",
)
@timeout_option
@json_option
@bus_options
def command(topics: tuple[str, ...], *, window: int, timeout: float | None, as_json: bool) -> None:
    """Measure the bandwidth of topics, once a second until Ctrl-C.

    Counted are the bytes of the messages, without what the network adds; a KB is 1000 of them.

    \b
    Examples:
      lcmtools bw /husky0/image
      lcmtools bw EXAMPLE /chatter -w 1000
    """  # noqa: D301 - \b is click's mark
    windows = {topic: BandwidthWindow(window) for topic in topics}

    def report() -> None:
        now = time.time_ns()
        _report({topic: sizes.take(now) for topic, sizes in windows.items()}, as_json=as_json)

    with open_watch("bw") as watch, reported_when_interrupted(report):
        for turn in turns(watch, tuple(windows), timeout):
            for topic, packet in turn.arrivals:
                windows[topic].add(packet.time, len(packet.payload))
            if turn.is_due:
                report()


def _report(found: Mapping[str, Bandwidth | None], *, as_json: bool) -> None:
    if as_json:
        for topic, bandwidth in found.items():
            data(_json(topic, bandwidth))
    elif any(found.values()) and len(found) > 1:
        lines(table(_HEADER, [_cells(topic, bandwidth) for topic, bandwidth in found.items()]))
    elif any(found.values()):
        data("\n".join(_text(bandwidth) for bandwidth in found.values() if bandwidth))


def _text(bandwidth: Bandwidth) -> str:
    """The lines of rostopic bw."""
    average, mean, smallest, largest = _in_units(bandwidth)
    return (
        f"average: {average}/s\n"
        f"\tmean: {mean} min: {smallest} max: {largest} window: {bandwidth.window}"
    )


def _cells(topic: str, bandwidth: Bandwidth | None) -> list[str]:
    """A row of the table; dashes for a topic on which less than two messages have come."""
    if bandwidth is None:
        return [topic, *"-----"]
    average, *sizes = _in_units(bandwidth)
    return [topic, f"{average}/s", *sizes, str(bandwidth.window)]


def _in_units(bandwidth: Bandwidth) -> list[str]:
    """Average, mean, smallest and largest, all in the unit that suits the average."""
    factor, unit = _unit(bandwidth.average)
    numbers = (bandwidth.average, bandwidth.mean, bandwidth.smallest, bandwidth.largest)
    return [f"{number / factor:.2f}{unit}" for number in numbers]


def _unit(average: float) -> tuple[float, str]:
    if average < 1e3:  # noqa: PLR2004 - a kilobyte
        return 1.0, "B"
    return (1e3, "KB") if average < 1e6 else (1e6, "MB")  # noqa: PLR2004 - a megabyte


def _json(topic: str, bandwidth: Bandwidth | None) -> str:
    if bandwidth is None:
        return json.dumps({"topic": topic, "bytes_per_second": None})
    return json.dumps(
        {
            "topic": topic,
            "bytes_per_second": bandwidth.average,
            "mean_bytes": bandwidth.mean,
            "min_bytes": bandwidth.smallest,
            "max_bytes": bandwidth.largest,
            "window": bandwidth.window,
        }
    )
