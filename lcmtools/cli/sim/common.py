"""Parts of the ``sim`` commands: their options, the call, and what is printed."""

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CommandT, bus_options, duration, json_option, open_monitor
from lcmtools.cli.output import data, document
from lcmtools.errors import UsageError
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message
from lcmtools.publish.simulator import call_simulator
from lcmtools.types.geometry_msgs import Pose

if TYPE_CHECKING:
    from lcmtools.node.service import ServiceType

_NUMBER = re.compile(r"(?P<number>.+?)\s*(?P<unit>deg)?")

RequestT = TypeVar("RequestT", bound=Message)
ResponseT = TypeVar("ResponseT", bound=Message)

_sim_option = click.option(
    "--sim",
    "name",
    metavar="NODE",
    help="The simulator's node, where several run.",
    shell_complete=complete("bus:nodes"),
)
_timeout_option = click.option(
    "--timeout", type=duration, default=5.0, help="Wait so long for an answer (else 5s)."
)


def sim_options(command: CommandT) -> CommandT:
    """Add ``--sim``, ``--timeout`` and the options of the bus."""
    return _sim_option(_timeout_option(bus_options(command)))


def json_sim_options(command: CommandT) -> CommandT:
    """Add the same and ``--json``."""
    return _sim_option(_timeout_option(json_option(bus_options(command))))


def call(
    name: str | None,
    verb: str,
    service_type: "ServiceType[RequestT, ResponseT]",
    request: RequestT,
    timeout: float,
) -> ResponseT:
    """Call a service of the simulator that is meant; see ``call_simulator``."""
    with open_monitor(f"sim_{verb}") as monitor:
        return call_simulator(monitor, name, verb, service_type, request, timeout=timeout)


def show(response: Message, *, as_json: bool) -> None:
    """Print what the simulator has done."""
    if as_json:
        document(to_plain(response))
    else:
        data(response.message)  # type: ignore[attr-defined] # all responses of sim_msgs have it


def read_pose(words: Sequence[str]) -> Pose:
    """Return a pose on the ground from X, Y [m] and YAW ([rad], or "90deg"); the default is 0.

    Raises:
        UsageError: There are too many, or X without Y, or one is no number.
    """
    if len(words) > 3:  # noqa: PLR2004 - x, y, yaw
        raise UsageError(f"too many values: {' '.join(words)}", "write X Y YAW")
    if len(words) == 1:
        raise UsageError(f"'{words[0]}' alone is no place", "write X Y YAW, for example 1 -2 90deg")
    x, y, yaw = (*map(_number, words), *[0.0] * (3 - len(words)))
    pose = Pose()
    pose.position.x, pose.position.y = x, y
    pose.orientation.z, pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return pose


def _number(word: str) -> float:
    form = _NUMBER.fullmatch(word)
    try:
        value = float(form["number"]) if form else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UsageError(f"'{word}' is not a number", "write X Y YAW, for example 1 -2 90deg")
    return math.radians(value) if form and form["unit"] else value
