"""``lcmtools delay``."""

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
from lcmtools.observe.decoding import Decoder
from lcmtools.observe.measure import DelayMeter, ListenOptions
from lcmtools.observe.rates import Delay

_KEYS = ("delay", "min", "max", "std_dev", "window")
_HEADER = ("topic", "delay", "min_delay", "max_delay", "std_dev", "window")


@subcommand("delay")
@argument("topics", metavar="TOPIC...", nargs=-1, required=True, completer="bus:topics")
@window_option(least=1, usual=50_000)
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
    """Measure the delay from header stamp to arrival; report once a second until Ctrl-C.

    Between two computers the offset of their clocks adds to the delay. Both times are simulated if
    a simulator publishes /clock. A log is read at once.

    \b
    Examples:
      lcmtools delay /husky0/odometry
      lcmtools delay /husky0/odometry -w 100 --json
    """
    options = ListenOptions(timeout, count, wall_time, names=looking_names())
    show = partial(
        print_report, keys=_KEYS, header=_HEADER, cells=_cells, text=_text, as_json=as_json
    )
    with open_monitor("delay", whole=True) as monitor:
        decoder = Decoder(monitor.types_of)
        meters = {topic: DelayMeter(window, decoder, notify) for topic in topics}
        measure(monitor, meters, options, show)


def _text(delay: Delay) -> str:
    """The lines of rostopic delay."""
    return (
        f"average delay: {delay.mean:.3f}\n"
        f"\tmin: {delay.shortest:.3f}s max: {delay.longest:.3f}s"
        f" std dev: {delay.deviation:.5f}s window: {delay.window}"
    )


def _cells(delay: Delay) -> list[str]:
    numbers = (delay.mean, delay.shortest, delay.longest, delay.deviation)
    return [*(f"{number:.4}" for number in numbers), str(delay.window)]
