"""``lcmtools sim pause``, ``resume``, ``reset``, ``step`` and ``set-rate``."""

import math

import click

from lcmtools.cli.declare import argument, examples, subcommand, whole_number, with_examples
from lcmtools.cli.negative_numbers import CommandWithWords
from lcmtools.cli.sim.common import call, json_sim_options, write_response
from lcmtools.errors import UsageError
from lcmtools.types.sim_msgs import SetRate, Step
from lcmtools.types.std_srvs import Trigger


def _trigger(verb: str, about: str, example: str) -> click.Command:

    @subcommand(verb, json_sim_options)
    def command(*, name: str | None, timeout: float, as_json: bool) -> None:
        write_response(call(verb, Trigger, name, timeout), as_json=as_json)

    command.help = with_examples(about, (f"sim {verb}", f"sim {verb} {example}"))
    return command


pause = _trigger("pause", "Pause simulated time.", "--sim /morse")
resume = _trigger("resume", "Resume simulated time.", "--sim /morse")
reset = _trigger("reset", "Start again: time 0, every robot at its first pose.", "--timeout 10s")


@subcommand("step", json_sim_options)
@examples("sim step", "sim step 240 --timeout 20s")
@argument("steps", type=whole_number(1), default=1)
def step(steps: int, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Advance a paused simulator by STEPS steps (else one), as fast as possible."""
    write_response(call("step", Step, name, timeout, steps=steps), as_json=as_json)


@subcommand("set-rate", json_sim_options, cls=CommandWithWords)
@examples("sim set-rate 4", "sim set-rate 0")
@argument("rate")
def set_rate(rate: str, *, name: str | None, timeout: float, as_json: bool) -> None:
    """Run at RATE times real time; 0: as fast as possible."""
    write_response(call("set_rate", SetRate, name, timeout, rate=_read_rate(rate)), as_json=as_json)


def _read_rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 0 <= rate < math.inf:  # refuses NaN too
        raise UsageError(f"the rate must be a number, 0 or more, not '{text}'", "1 is real time")
    return rate
