"""``lcmtools delay``."""

import json
from collections.abc import Mapping

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.output import data, lines, talk
from lcmtools.cli.topic.measuring import measure, measuring_options, window_option
from lcmtools.cli.topic.table import table
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.header import stamp
from lcmtools.messages.registry import type_name
from lcmtools.observe.arrival import Arrival
from lcmtools.observe.batches import ListenOptions, batches
from lcmtools.observe.decoding import Decoder, UnknownFingerprint
from lcmtools.observe.rates import Delay, DelayWindow
from lcmtools.wire.packet import Packet

_HEADER = ("topic", "delay", "min_delay", "max_delay", "std_dev", "window")


@click.command("delay", context_settings=CONTEXT)
@click.argument(
    "topics", metavar="TOPIC...", nargs=-1, required=True, shell_complete=complete("bus:topics")
)
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
    """Measure how long after its header's stamp a message arrives, once a second until Ctrl-C.

    Both times are clock time: between two computers, what their clocks differ by counts too. Where
    a simulator publishes /clock, both are simulated. A log is read at once.

    \b
    Examples:
      lcmtools delay /husky0/odometry
      lcmtools delay /husky0/odometry -w 100 --json
    """  # noqa: D301 - \b is click's mark

    def report(found: Mapping[str, Delay | None]) -> None:
        _report(found, as_json=as_json)

    with open_monitor("delay", whole=True) as monitor:
        decoder = Decoder(monitor.types_of)
        meters = {topic: _Meter(window, decoder) for topic in topics}
        how = ListenOptions(timeout, count, wall_time, names=looking_names())
        measure(batches(monitor, tuple(meters), how), meters, report, count)


class _Meter:
    """The delay of a topic."""

    def __init__(self, window: int, decoder: Decoder) -> None:
        self._decoder = decoder
        self._delays = DelayWindow(window)
        self._has_told = False

    def add(self, arrival: Arrival) -> None:
        stamped = _stamp(arrival.packet, self._decoder)
        if stamped:
            self._delays.add(arrival.time, stamped)
        elif not self._has_told:
            self._has_told = True
            talk(
                f"lcmtools delay: the stamp of a message on {arrival.topic} is 0, which is no time"
            )

    def take(self, _now: int) -> Delay | None:
        return self._delays.take()

    def clear(self) -> None:
        self._delays.clear()


def _stamp(packet: Packet, decoder: Decoder) -> int:
    """When a message was stamped, nanoseconds since 1970.

    Raises:
        LcmtoolsError: Its type is unknown or has no header.
        DecodeError: It is malformed.
    """
    try:
        message = decoder.decode(packet)
    except UnknownFingerprint:
        raise LcmtoolsError(
            f"the type of the messages on {packet.channel} is not known",
            f"lcmtools echo {packet.channel} shows their bytes",
        ) from None
    stamped = stamp(message)
    if stamped is None:
        raise LcmtoolsError(
            f"{type_name(message)}, which comes on {packet.channel}, has no header with a stamp",
            "lcmtools msg find-field header lists the types that have one",
        )
    return stamped


def _report(delays: Mapping[str, Delay | None], *, as_json: bool) -> None:
    if as_json:
        for topic, delay in delays.items():
            data(_json(topic, delay))
    elif not any(delays.values()):
        data("no new messages")
    elif len(delays) > 1:
        lines(table(_HEADER, [_cells(topic, delay) for topic, delay in delays.items()]))
    else:
        data("\n".join(_text(delay) for delay in delays.values() if delay))


def _text(delay: Delay) -> str:
    """The lines of rostopic delay."""
    return (
        f"average delay: {delay.mean:.3f}\n"
        f"\tmin: {delay.shortest:.3f}s max: {delay.longest:.3f}s"
        f" std dev: {delay.deviation:.5f}s window: {delay.window}"
    )


def _cells(topic: str, delay: Delay | None) -> list[str]:
    """A row of the table; dashes for a topic on which nothing new has come."""
    if delay is None:
        return [topic, *"-----"]
    numbers = (delay.mean, delay.shortest, delay.longest, delay.deviation)
    return [topic, *(f"{number:.4}" for number in numbers), str(delay.window)]


def _json(topic: str, delay: Delay | None) -> str:
    if delay is None:
        return json.dumps({"topic": topic, "delay": None})
    return json.dumps(
        {
            "topic": topic,
            "delay": delay.mean,
            "min": delay.shortest,
            "max": delay.longest,
            "std_dev": delay.deviation,
            "window": delay.window,
        }
    )
