"""``lcmtools bw``."""

import json
from collections.abc import Mapping

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.output import data, lines, talk
from lcmtools.cli.topic.measuring import measure, measuring_options, window_option
from lcmtools.cli.topic.table import table
from lcmtools.observe.arrival import Arrival
from lcmtools.observe.batches import ListenOptions, batches
from lcmtools.observe.rates import Bandwidth, BandwidthWindow

_HEADER = ("topic", "average", "mean", "min", "max", "window")


@click.command("bw", context_settings=CONTEXT)
@click.argument(
    "topics", metavar="TOPIC...", nargs=-1, required=True, shell_complete=complete("bus:topics")
)
@window_option(least=2, usual=100)
@measuring_options
@json_option
@looking_options
def command(
    topics: tuple[str, ...],
    *,
    window: int,
    timeout: float | None,
    count: int | None,
    wall_time: bool,
    as_json: bool,
) -> None:
    """Measure the bandwidth of topics, once a second until Ctrl-C.

    Counted are the bytes of the messages, without what the network adds; a KB is 1000 of them.
    Seconds are simulated ones where a simulator publishes /clock. A log is read at once.

    \b
    Examples:
      lcmtools bw /husky0/image
      lcmtools bw EXAMPLE /chatter -w 1000
    """  # noqa: D301 - \b is click's mark
    meters = {topic: _Meter(window) for topic in topics}

    def report(found: Mapping[str, Bandwidth | None]) -> None:
        _report(found, as_json=as_json)

    with open_monitor("bw") as monitor:
        how = ListenOptions(timeout, count, wall_time, names=looking_names())
        measure(batches(monitor, tuple(meters), how), meters, report, count)
        for topic, meter in meters.items():
            if meter.messages == 1:
                talk(f"lcmtools bw: only one message came on {topic}: a bandwidth takes two")


class _Meter:
    """The bandwidth of a topic."""

    def __init__(self, window: int) -> None:
        self.messages = 0
        self._sizes = BandwidthWindow(window)

    def add(self, arrival: Arrival) -> None:
        self.messages += 1
        self._sizes.add(arrival.time, arrival.packet.size)

    def take(self, now: int) -> Bandwidth | None:
        return self._sizes.take(now)

    def clear(self) -> None:
        self._sizes.clear()


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
