"""``lcmtools sim spawn``, ``delete``, ``set-pose`` and ``state``."""

import math
import re
from collections.abc import Sequence

from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.negative_numbers import CommandWithWords
from lcmtools.cli.output import write_data
from lcmtools.cli.sim.common import call, json_sim_options, write_response
from lcmtools.errors import UsageError
from lcmtools.messages.plain import to_plain
from lcmtools.messages.text import Writer
from lcmtools.types.geometry_msgs import Pose
from lcmtools.types.sim_msgs import Delete, GetState, SetPose, Spawn

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
