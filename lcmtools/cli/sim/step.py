"""``lcmtools sim step``."""

import click

from lcmtools.cli.options import CONTEXT, whole_number
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.types.sim_msgs import Step


@click.command("step", context_settings=CONTEXT)
@click.argument("steps", type=whole_number(1), default=1)
@json_sim_options
def command(steps: int, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Let a paused simulator do STEPS steps (else one), as fast as it can.

    \b
    Examples:
      lcmtools sim step
      lcmtools sim step 240 --timeout 20s
    """  # noqa: D301 - \b is click's mark
    request = Step.Request()
    request.steps = steps
    show(call(name, "step", Step, request, timeout), as_json=as_json)
