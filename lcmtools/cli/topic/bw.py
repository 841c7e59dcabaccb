"""``lcmtools bw``."""

from functools import partial

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.topic.measuring import (
    measure,
    measuring_options,
    notify,
    print_report,
    window_option,
)
from lcmtools.observe.measure import BandwidthMeter, ListenOptions
from lcmtools.observe.rates import Bandwidth

_KEYS = ("bytes_per_second", "mean_bytes", "min_bytes", "max_bytes", "window")
_HEADER = ("topic", "average", "mean", "min", "max", "window")


@subcommand("bw")
@argument("topics", metavar="TOPIC...", nargs=-1, required=True, completer="bus:topics")
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
    """Measure the bandwidth of topics; report once a second until Ctrl-C.

    This counts the bytes of messages without network headers; 1 KB is 1000 bytes. Time is simulated
    if a simulator publishes /clock. A log is read at once.

    \b
    Examples:
      lcmtools bw /husky0/image
      lcmtools bw EXAMPLE /chatter -w 1000
    """
    options = ListenOptions(timeout, count, wall_time, names=looking_names())
    meters = {topic: BandwidthMeter(window) for topic in topics}
    show = partial(
        print_report,
        keys=_KEYS,
        header=_HEADER,
        cells=_cells,
        text=_text,
        as_json=as_json,
        nothing="",
    )
    with open_monitor("bw") as monitor:
        measure(monitor, meters, options, show)
    for topic, meter in meters.items():
        if meter.total == 1:
            notify(f"only one message came on {topic}: a bandwidth takes two")


def _text(bandwidth: Bandwidth) -> str:
    """The lines of rostopic bw."""
    average, mean, smallest, largest, window = _cells(bandwidth)
    return f"average: {average}\n\tmean: {mean} min: {smallest} max: {largest} window: {window}"


def _cells(bandwidth: Bandwidth) -> list[str]:
    """Average, mean, smallest and largest, all in the unit that suits the average."""
    factor, unit = _unit(bandwidth.average)
    numbers = (bandwidth.average, bandwidth.mean, bandwidth.smallest, bandwidth.largest)
    average, *sizes = [f"{number / factor:.2f}{unit}" for number in numbers]
    return [f"{average}/s", *sizes, str(bandwidth.window)]


def _unit(average: float) -> tuple[float, str]:
    if average < 1e3:  # noqa: PLR2004 - a kilobyte
        return 1.0, "B"
    return (1e3, "KB") if average < 1e6 else (1e6, "MB")  # noqa: PLR2004 - a megabyte
