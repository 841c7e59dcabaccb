"""``lcmtools sim delete``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.types.sim_msgs import Delete


@click.command("delete", context_settings=CONTEXT)
@click.argument("robot", shell_complete=complete("bus:robots"))
@json_sim_options
def command(robot: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Take a robot away.

    \b
    Examples:
      lcmtools sim delete husky1
      lcmtools sim delete /dolly
    """  # noqa: D301 - \b is click's mark
    request = Delete.Request()
    request.robot = robot
    show(call(name, "delete", Delete, request, timeout), as_json=as_json)
