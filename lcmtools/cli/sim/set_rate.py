"""``lcmtools sim set-rate``."""

import math

import click

from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.errors import UsageError
from lcmtools.types.sim_msgs import SetRate


@click.command("set-rate", context_settings=CONTEXT)
@click.argument("rate")
@json_sim_options
def command(rate: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Let simulated time pass RATE times as fast as real time; 0: as fast as possible.

    \b
    Examples:
      lcmtools sim set-rate 4
      lcmtools sim set-rate 0
    """  # noqa: D301 - \b is click's mark
    request = SetRate.Request()
    request.rate = _read_rate(rate)
    show(call(name, "set_rate", SetRate, request, timeout), as_json=as_json)


def _read_rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 0 <= rate < math.inf:  # refuses NaN too
        raise UsageError(f"the rate must be a number, 0 or more, not '{text}'", "1 is real time")
    return rate
