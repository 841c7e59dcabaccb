"""``lcmtools sim state``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT
from lcmtools.cli.output import data
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.messages.plain import to_plain
from lcmtools.messages.plain_text import Writer
from lcmtools.types.sim_msgs import GetState

_OUTCOME = ("success", "message")


@click.command("state", context_settings=CONTEXT)
@click.argument("robot", shell_complete=complete("bus:robots"))
@json_sim_options
def command(robot: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Show where a robot truly is and how it moves.

    \b
    Examples:
      lcmtools sim state husky0
      lcmtools sim state /husky0 --json
    """  # noqa: D301 - \b is click's mark
    request = GetState.Request()
    request.robot = robot
    response = call(name, "get_state", GetState, request, timeout)
    if as_json:
        show(response, as_json=True)
    else:
        told = {name: value for name, value in to_plain(response).items() if name not in _OUTCOME}
        data(Writer().block(told))
