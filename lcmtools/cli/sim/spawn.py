"""``lcmtools sim spawn``."""

import click

from lcmtools.cli.completion.completer import complete_words
from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, read_pose, show
from lcmtools.cli.words import CommandWithWords
from lcmtools.types.sim_msgs import Spawn


@click.command("spawn", cls=CommandWithWords, context_settings=CONTEXT)
@click.argument("model", shell_complete=complete_words("dolly", "husky", "pioneer"))
@click.argument("robot")
@click.argument("words", metavar="[X Y [YAW]]", nargs=-1)
@json_sim_options
def command(
    model: str,
    robot: str,
    words: tuple[str, ...],
    name: str | None,
    *,
    timeout: float,
    as_json: bool,
) -> None:
    """Put up one more robot of a MODEL (husky, pioneer, dolly) with the namespace ROBOT.

    \b
    Examples:
      lcmtools sim spawn husky /husky1 0 3
      lcmtools sim spawn dolly dolly -2 1 180deg
    """  # noqa: D301 - \b is click's mark
    request = Spawn.Request()
    request.model, request.robot, request.pose = model, robot, read_pose(words)
    show(call(name, "spawn", Spawn, request, timeout), as_json=as_json)
