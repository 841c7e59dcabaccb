"""``lcmtools delay``."""

import json
from functools import partial

import click

from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_watch, whole_number
from lcmtools.cli.output import data
from lcmtools.cli.topic.turns import reported_when_interrupted, timeout_option, turns
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.rates import Delay, DelayWindow
from lcmtools.messages.codec import decode
from lcmtools.messages.header import stamp
from lcmtools.messages.registry import candidates, message_class
from lcmtools.wire.packet import Packet


@click.command("delay", context_settings=CONTEXT)
@click.argument("topic")
@click.option(
    "-w",
    "--window",
    metavar="N",
    type=whole_number(1),
    default=50_000,
    help="Messages to average over.",
)
@timeout_option
@json_option
@bus_options
def command(topic: str, *, window: int, timeout: float | None, as_json: bool) -> None:
    """Measure how long after its header's stamp a message arrives, once a second until Ctrl-C.

    Both times are clock time: between two computers, what their clocks differ by counts too.

    \b
    Examples:
      lcmtools delay /husky0/odometry
      lcmtools delay /husky0/odometry -w 100 --json
    """  # noqa: D301 - \b is click's mark
    delays = DelayWindow(window)

    def report(*, is_last: bool = False) -> None:
        delay = delays.take()
        if delay or not is_last:
            data(_json(topic, delay) if as_json else _text(delay))

    last_report = partial(report, is_last=True)
    with open_watch("delay") as watch, reported_when_interrupted(last_report):
        for turn in turns(watch, (topic,), timeout):
            for _, packet in turn.arrivals:
                delays.add(packet.time, _stamp(packet))
            if turn.is_due:
                report()


def _stamp(packet: Packet) -> int:
    """When a message was stamped, nanoseconds since 1970.

    Raises:
        LcmtoolsError: Its type is unknown or has no header.
        DecodeError: It is malformed.
    """
    # Types that share a fingerprint have the same fields: any of them will do.
    names = candidates(packet.fingerprint) if packet.fingerprint is not None else []
    if not names:
        raise LcmtoolsError(
            f"the type of the messages on {packet.channel} is not known",
            f"lcmtools echo {packet.channel} shows their bytes",
        )
    stamped = stamp(decode(message_class(names[0]), packet.payload))
    if stamped is None:
        raise LcmtoolsError(
            f"{names[0]}, which comes on {packet.channel}, has no header with a stamp",
            "lcmtools msg find-field header lists the types that have one",
        )
    return stamped


def _text(delay: Delay | None) -> str:
    """The lines of rostopic delay."""
    if delay is None:
        return "no new messages"
    return (
        f"average delay: {delay.mean:.3f}\n"
        f"\tmin: {delay.shortest:.3f}s max: {delay.longest:.3f}s"
        f" std dev: {delay.deviation:.5f}s window: {delay.window}"
    )


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
