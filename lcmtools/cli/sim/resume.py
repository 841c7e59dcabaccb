"""``lcmtools sim resume``."""

import click

from lcmtools.cli.options import CONTEXT, bus_options, json_option
from lcmtools.cli.sim.simulator import ask, sim_option, tell, timeout_option
from lcmtools.types.std_srvs import Trigger


@click.command("resume", context_settings=CONTEXT)
@sim_option
@timeout_option
@json_option
@bus_options
def command(*, name: str | None, timeout: float, as_json: bool) -> None:
    """Let simulated time go on.

    \b
    Examples:
      lcmtools sim resume
      lcmtools sim resume --sim /morse
    """  # noqa: D301 - \b is click's mark
    tell(ask(name, "resume", Trigger, Trigger.Request(), timeout), as_json=as_json)
