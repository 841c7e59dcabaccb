"""``lcmtools hz``."""

from functools import partial

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.topic.measuring import (
    measure,
    measuring_options,
    notify,
    print_report,
    window_option,
)
from lcmtools.messages.filter import Filter
from lcmtools.observe.measure import ListenOptions, RateMeter, lossy_senders
from lcmtools.observe.rates import Rate

_KEYS = ("rate", "min", "max", "std_dev", "window")
_HEADER = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


@subcommand("hz")
@argument("topics", metavar="TOPIC...", nargs=-1, required=True, completer="bus:topics")
@window_option(least=2, usual=50_000)
@option("--filter", "condition", metavar="EXPR", help="Count only messages for which this is true.")
@measuring_options
@json_option
@looking_options
def command(
    topics: tuple[str, ...],
    *,
    window: int,
    condition: str | None,
    timeout: float | None,
    count: int | None,
    wall_time: bool,
    as_json: bool,
) -> None:
    """Measure the rate of topics; report once a second until Ctrl-C.

    Times of arrival are the kernel's, or simulated time if a simulator publishes /clock. The type
    need not be known. A log is read at once, with its recorded times.

    \b
    Examples:
      lcmtools hz /husky0/odometry
      lcmtools hz EXAMPLE /chatter -w 100
      lcmtools hz /chatter --filter "m.data != ''" -n 1 --timeout 5s
    """
    wanted = Filter(condition) if condition is not None else None
    options = ListenOptions(timeout, count, wall_time, wanted, looking_names())
    meters = {topic: RateMeter(window) for topic in topics}
    show = partial(
        print_report, keys=_KEYS, header=_HEADER, cells=_cells, text=_text, as_json=as_json
    )
    with open_monitor("hz", whole=condition is not None) as monitor:
        try:
            measure(monitor, meters, options, show)
        finally:
            for sentence in lossy_senders(monitor, tuple(meters), options.names):
                notify(sentence)
    for topic, meter in meters.items():
        if meter.total == 1:
            notify(f"only one message came on {topic}: a rate takes two")


def _text(rate: Rate) -> str:
    """The lines of rostopic hz."""
    return (
        f"average rate: {rate.mean:.3f}\n"
        f"\tmin: {rate.shortest:.3f}s max: {rate.longest:.3f}s"
        f" std dev: {rate.deviation:.5f}s window: {rate.window}"
    )


def _cells(rate: Rate) -> list[str]:
    numbers = (rate.mean, rate.shortest, rate.longest, rate.deviation)
    return [*(f"{number:.4}" for number in numbers), str(rate.window)]
