"""``lcmtools sim pause``."""

import click

from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.types.std_srvs import Trigger


@click.command("pause", context_settings=CONTEXT)
@json_sim_options
def command(*, name: str | None, timeout: float, as_json: bool) -> None:
    """Let simulated time stand still.

    \b
    Examples:
      lcmtools sim pause
      lcmtools sim pause --sim /morse
    """  # noqa: D301 - \b is click's mark
    show(call(name, "pause", Trigger, Trigger.Request(), timeout), as_json=as_json)
