"""``lcmtools sim reset``."""

import click

from lcmtools.cli.options import CONTEXT, bus_options, json_option
from lcmtools.cli.sim.simulator import ask, sim_option, tell, timeout_option
from lcmtools.types.std_srvs import Trigger


@click.command("reset", context_settings=CONTEXT)
@sim_option
@timeout_option
@json_option
@bus_options
def command(*, name: str | None, timeout: float, as_json: bool) -> None:
    """Begin anew: time 0, and every robot where it started.

    \b
    Examples:
      lcmtools sim reset
      lcmtools sim reset --timeout 10s
    """  # noqa: D301 - \b is click's mark
    tell(ask(name, "reset", Trigger, Trigger.Request(), timeout), as_json=as_json)
