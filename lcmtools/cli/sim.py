"""``lcmtools sim``: controlling a running simulator.

Any node that offers the services of lcm_types/sim_msgs is a simulator here.
"""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lcmtools.cli.bus import open_monitor
from lcmtools.cli.declare import (
    argument,
    examples,
    flag,
    option,
    subcommand,
    together,
    whole_number,
    with_examples,
)
from lcmtools.cli.negative_numbers import CommandWithWords
from lcmtools.cli.options import bus_options, json_option, timeout_option
from lcmtools.cli.output import write_data, write_document, write_lines, write_note
from lcmtools.errors import UsageError
from lcmtools.folders import write_whole
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message
from lcmtools.messages.text import Writer
from lcmtools.publish.simulator import RequestT, ResponseT, call_simulator
from lcmtools.types.geometry_msgs import Pose
from lcmtools.types.sim_msgs import Delete, GetState, SetPose, SetRate, Snapshot, Spawn, Step
from lcmtools.types.std_srvs import Trigger

if TYPE_CHECKING:
    from lcmtools.node.service import ServiceType

_simulator = "The simulator's node, if there are several."
_sim_option = option("--sim", "name", metavar="NODE", help=_simulator, completer="bus:nodes")

sim_options = together(_sim_option, timeout_option(5.0), bus_options)
json_sim_options = together(_sim_option, timeout_option(5.0), json_option, bus_options)


def call(
    verb: str,
    service_type: "ServiceType[RequestT, ResponseT]",
    name: str | None,
    timeout: float,
    **fields: object,
) -> ResponseT:
    """Call a service of the simulator with these fields; see ``call_simulator``."""
    with open_monitor(f"sim_{verb}") as monitor:
        return call_simulator(monitor, name, verb, service_type, timeout=timeout, **fields)


def write_response(response: Message, *, as_json: bool) -> None:
    """Print the simulator's response."""
    if as_json:
        write_document(to_plain(response))
    else:
        write_lines([response.message])  # type: ignore[attr-defined] # responses of sim_msgs have it


def _trigger(verb: str, about: str, example: str) -> click.Command:

    @subcommand(verb, json_sim_options)
    def command(*, name: str | None, timeout: float, as_json: bool) -> None:
        write_response(call(verb, Trigger, name, timeout), as_json=as_json)

    command.help = with_examples(about, (f"sim {verb}", f"sim {verb} {example}"))
    return command


pause = _trigger("pause", "Pause simulated time.", "--sim /morse")
resume = _trigger("resume", "Resume simulated time.", "--sim /morse")
reset = _trigger("reset", "Start again: time 0, every robot at its first pose.", "--timeout 10s")


@subcommand("step", json_sim_options)
@examples("sim step", "sim step 240 --timeout 20s")
@argument("steps", type=whole_number(1), default=1)
def step(steps: int, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Advance a paused simulator by STEPS steps (else one), as fast as possible."""
    write_response(call("step", Step, name, timeout, steps=steps), as_json=as_json)


@subcommand("set-rate", json_sim_options, cls=CommandWithWords)
@examples("sim set-rate 4", "sim set-rate 0")
@argument("rate")
def set_rate(rate: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Run at RATE times real time; 0: as fast as possible."""
    write_response(call("set_rate", SetRate, name, timeout, rate=_read_rate(rate)), as_json=as_json)


def _read_rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 0 <= rate < math.inf:  # refuses NaN too
        raise UsageError(f"the rate must be a number, 0 or more, not '{text}'", "1 is real time")
    return rate


_NUMBER = re.compile(r"(?P<number>.+?)\s*(?P<unit>deg)?")
_OUTCOME = ("success", "message")

_robot = argument("robot", completer="bus:robots")


@subcommand("spawn", json_sim_options, cls=CommandWithWords)
@examples("sim spawn husky /husky1 0 3", "sim spawn dolly dolly -2 1 180deg")
@argument("model", completer=("dolly", "husky", "pioneer"))
@argument("robot")
@argument("words", metavar="[X Y [YAW]]", nargs=-1)
def spawn(
    model: str,
    robot: str,
    words: tuple[str, ...],
    name: str | None,
    *,
    timeout: float,
    as_json: bool,
) -> None:
    """Add a robot of a MODEL (husky, pioneer, dolly) with the namespace ROBOT."""
    pose = _read_pose(words)
    write_response(
        call("spawn", Spawn, name, timeout, model=model, robot=robot, pose=pose), as_json=as_json
    )


@subcommand("delete", json_sim_options)
@examples("sim delete husky1", "sim delete /dolly")
@_robot
def delete(robot: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Remove a robot."""
    write_response(call("delete", Delete, name, timeout, robot=robot), as_json=as_json)


@subcommand("set-pose", json_sim_options, cls=CommandWithWords)
@examples("sim set-pose husky0 1 -2", "sim set-pose /husky0 0 0 90deg")
@_robot
@argument("words", metavar="X Y [YAW]", nargs=-1, required=True)
def set_pose(
    robot: str, words: tuple[str, ...], name: str | None, *, timeout: float, as_json: bool
) -> None:
    """Place a robot at a pose, at rest: X and Y in metres, YAW in radians or as 90deg."""
    pose = _read_pose(words)
    write_response(
        call("set_pose", SetPose, name, timeout, robot=robot, pose=pose), as_json=as_json
    )


@subcommand("state", json_sim_options)
@examples("sim state husky0", "sim state /husky0 --json")
@_robot
def state(robot: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Show the true pose and velocity of a robot."""
    response = call("get_state", GetState, name, timeout, robot=robot)
    if as_json:
        write_response(response, as_json=True)
    else:
        parts = {name: value for name, value in to_plain(response).items() if name not in _OUTCOME}
        write_data(Writer().block({**parts, "time": response.time / 1e9}))


def _read_pose(words: Sequence[str]) -> Pose:
    """Return a pose on the ground from X, Y [m] and YAW ([rad], or "90deg"); the default is 0."""
    if len(words) > 3:  # noqa: PLR2004 - x, y, yaw
        raise UsageError(f"too many values: {' '.join(words)}", "write X Y YAW")
    if len(words) == 1:
        raise UsageError(
            f"'{words[0]}' alone is not a place", "write X Y YAW, for example 1 -2 90deg"
        )
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


@subcommand("snapshot", sim_options)
@examples("sim snapshot world.png", "sim snapshot --robot husky0 --force husky.png")
@argument("file", type=click.Path())
@option(
    "--robot",
    metavar="ROBOT",
    default="",
    help="View from behind this robot, not from above.",
    completer="bus:robots",
)
@option("--width", type=whole_number(1), metavar="N", default=800, help="Pixels (else 800).")
@option("--height", type=whole_number(1), metavar="N", default=600, help="Pixels (else 600).")
@flag("--force", help="Overwrite an existing file.")
def snapshot(
    file: str, *, robot: str, width: int, height: int, force: bool, name: str | None, timeout: float
) -> None:
    """Write an image of the world to a PNG FILE ('-': standard output)."""
    path = Path(file)
    if path.is_file() and not force:
        raise UsageError(f"{file} already exists", "--force overwrites it")
    size = {"width": width, "height": height}
    response = call("snapshot", Snapshot, name, timeout, robot=robot, **size)
    picture = bytes(response.image.data)
    write_whole(path, picture)
    write_note(f"wrote {file}: {len(picture)} bytes")
