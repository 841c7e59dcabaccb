"""``lcmtools hz``, ``bw`` and ``delay``: a report a second, as rostopic prints it."""

from operator import attrgetter
from typing import Any

from lcmtools.cli.bus import looking_names, notify, open_monitor
from lcmtools.cli.declare import examples, option, subcommand
from lcmtools.cli.topic.measuring import measure, measured_topics, measuring_options, notify_single
from lcmtools.messages.filter import Filter
from lcmtools.observe.measuring.measure import Delays, lossy_senders
from lcmtools.observe.measuring.rate_report import BANDWIDTH, DELAY, RATE
from lcmtools.observe.measuring.rates import BandwidthWindow, DelayWindow, RateWindow
from lcmtools.observe.reading.decoding import Decoder


@subcommand("hz", measuring_options)
@examples(
    "hz /husky0/odometry",
    "hz EXAMPLE /chatter -w 100",
    "hz /chatter --filter \"m.data != ''\" -n 1 --timeout 5s",
)
@measured_topics(least=2, usual=50_000)
@option("--filter", "condition", metavar="EXPR", help="Count only messages for which this is true.")
def hz(topics: tuple[str, ...], *, window: int, condition: str | None, **ending: Any) -> None:  # noqa: ANN401 - of ``measure``
    """Measure the rate of topics; report once a second until Ctrl-C.

    Times of arrival are the kernel's, or simulated time if a simulator publishes /clock. The type
    need not be known. A log is read at once, with its recorded times.
    """
    wanted = Filter(condition) if condition is not None else None
    windows = {topic: RateWindow(window) for topic in topics}
    with open_monitor("hz", whole=condition is not None) as monitor:
        try:
            measure(monitor, windows, attrgetter("time"), RATE, condition=wanted, **ending)
        finally:
            for sentence in lossy_senders(monitor, topics, looking_names()):
                notify(sentence)
    notify_single(windows, "rate")


@subcommand("bw", measuring_options)
@examples("bw /husky0/image", "bw EXAMPLE /chatter -w 1000")
@measured_topics(least=2, usual=100)
def bw(topics: tuple[str, ...], *, window: int, **ending: Any) -> None:  # noqa: ANN401 - of ``measure``
    """Measure the bandwidth of topics; report once a second until Ctrl-C.

    This counts the bytes of messages without network headers; 1 KB is 1000 bytes. Time is simulated
    if a simulator publishes /clock. A log is read at once.
    """
    windows = {topic: BandwidthWindow(window) for topic in topics}
    with open_monitor("bw") as monitor:
        measure(monitor, windows, attrgetter("time", "packet.size"), BANDWIDTH, **ending)
    notify_single(windows, "bandwidth")


@subcommand("delay", measuring_options)
@examples("delay /husky0/odometry", "delay /husky0/odometry -w 100 --json")
@measured_topics(least=1, usual=50_000)
def delay(topics: tuple[str, ...], *, window: int, **ending: Any) -> None:  # noqa: ANN401 - of ``measure``
    """Measure the delay from header stamp to arrival; report once a second until Ctrl-C.

    For messages without a header, the field utime is used: microseconds since 1970, as usual in
    LCM. Between two computers the offset of their clocks adds to the delay. Both times are
    simulated if a simulator publishes /clock. A log is read at once.
    """
    windows = {topic: DelayWindow(window) for topic in topics}
    with open_monitor("delay", whole=True) as monitor:
        delays = Delays(Decoder(monitor.types_of), notify)
        measure(monitor, windows, delays, DELAY, log_time=False, **ending)
