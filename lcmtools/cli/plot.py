"""``lcmtools plot`` and ``lcmtools bag plot``."""

import os
import shutil
import sys
from collections import deque
from contextlib import suppress
from pathlib import Path

from lcmtools.cli.bus import looking_names, notify, notify_damage, open_monitor
from lcmtools.cli.declare import argument, duration, examples, option, subcommand
from lcmtools.cli.options import looking_options, part_options
from lcmtools.cli.output import clearing, write_data, write_note
from lcmtools.color import stream_wants_color
from lcmtools.errors import UsageError
from lcmtools.escapes import escape_but_colors
from lcmtools.observe.measuring.curves import Curves, draw_picture, draw_text

_PERIOD = 0.2  # [s] between two drawings
_WIDE = (80, 24)  # columns and rows without a terminal

_fields = argument(
    "fields",
    metavar="TOPIC/FIELD...",
    nargs=-1,
    required=True,
    completer="messages:topics_and_fields",
)
_output = option(
    "-o", "--output", metavar="FILE", completer="files", help="Write a picture: .png, .svg or .pdf."
)


@subcommand("plot", looking_options)
@examples(
    "plot /husky0/odometry/twist.twist.linear.x /husky0/desired_velocity/linear.x",
    "plot /imu/angular_velocity.z --window 30s",
    "plot /joint_states/position --duration 10s -o joints.png",
)
@_fields
@_output
@option("--window", type=duration, default=10.0, help="The time shown (else 10s).")
@option("--duration", type=duration, help="Stop after this long.")
@option("--timeout", type=duration, help="Exit with code 4 if no message comes in time.")
def command(
    fields: tuple[str, ...],
    *,
    output: str | None,
    window: float,
    duration: float | None,
    timeout: float | None,
) -> None:
    """Draw fields of messages over time, as they come, until Ctrl-C.

    An array gives a curve for each element. With -o nothing is drawn on the terminal; the picture
    shows everything received.
    """
    if output is None and not clearing():
        raise UsageError("plot draws on a terminal", "or into a picture: -o FILE.png")
    with open_monitor("plot", whole=True) as monitor:
        curves = Curves(monitor, fields, looking_names(), notify, None if output else window)
        with suppress(*([KeyboardInterrupt] if output else [])):  # the picture is written then
            for _ in curves.follow(_PERIOD, timeout, duration):
                if output is None:
                    write_data(f"{clearing()}{_text(curves)}")
        if duration is None:
            notify_damage(monitor)
    if output is not None:
        _write(curves, Path(output))


@subcommand("plot")
@examples(
    "bag plot ride.lcmlog /husky0/odometry/twist.twist.linear.x",
    "bag plot ride.lcmlog /imu/angular_velocity -o turning.png -s end-5s",
)
@argument("log", metavar="FILE", completer="files")
@_fields
@_output
@part_options()
def of_log(log: str, fields: tuple[str, ...], output: str | None) -> None:
    """Draw fields of a log's messages over time, on the terminal or into a picture."""
    with open_monitor("bag plot", logs=[log]) as monitor:
        curves = Curves(monitor, fields, looking_names(), notify)
        deque(curves.follow(), 0)
        notify_damage(monitor)
    if output is None:
        write_data(_text(curves))
    else:
        _write(curves, Path(output))


def _text(curves: Curves) -> str:
    width, height = shutil.get_terminal_size(_WIDE)
    colored = stream_wants_color(sys.stdout, os.environ)
    drawn = draw_text([*curves], width, height - 1, colored=colored)
    return "\n".join(map(escape_but_colors, drawn.split("\n")))  # topics are named in it


def _write(curves: Curves, path: Path) -> None:
    draw_picture([*curves], path)
    write_note(f"{path}: {', '.join(curve.label for curve in curves)}")
