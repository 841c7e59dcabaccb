"""``lcmtools sim set-pose``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, read_pose, show
from lcmtools.cli.words import CommandWithWords
from lcmtools.types.sim_msgs import SetPose


@click.command("set-pose", cls=CommandWithWords, context_settings=CONTEXT)
@click.argument("robot", shell_complete=complete("bus:robots"))
@click.argument("words", metavar="X Y [YAW]", nargs=-1, required=True)
@json_sim_options
def command(
    robot: str, words: tuple[str, ...], name: str | None, *, timeout: float, as_json: bool
) -> None:
    """Put a robot elsewhere, at rest: X and Y in metres, YAW in radians or as 90deg.

    \b
    Examples:
      lcmtools sim set-pose husky0 1 -2
      lcmtools sim set-pose /husky0 0 0 90deg
    """  # noqa: D301 - \b is click's mark
    request = SetPose.Request()
    request.robot, request.pose = robot, read_pose(words)
    show(call(name, "set_pose", SetPose, request, timeout), as_json=as_json)
