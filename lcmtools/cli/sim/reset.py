"""``lcmtools sim reset``."""

import click

from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.types.std_srvs import Trigger


@click.command("reset", context_settings=CONTEXT)
@json_sim_options
def command(*, name: str | None, timeout: float, as_json: bool) -> None:
    """Begin anew: time 0, and every robot where it started.

    \b
    Examples:
      lcmtools sim reset
      lcmtools sim reset --timeout 10s
    """  # noqa: D301 - \b is click's mark
    show(call(name, "reset", Trigger, Trigger.Request(), timeout), as_json=as_json)
