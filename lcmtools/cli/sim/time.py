"""``lcmtools sim pause``, ``resume`` and ``reset``."""

import click

from lcmtools.cli.options import CONTEXT
from lcmtools.cli.sim.common import call, json_sim_options, show
from lcmtools.types.std_srvs import Trigger


def _trigger(verb: str, about: str, example: str) -> click.Command:
    """Make a command that calls a service without arguments."""

    @click.command(verb, context_settings=CONTEXT)
    @json_sim_options
    def command(*, name: str | None, timeout: float, as_json: bool) -> None:
        show(call(name, verb, Trigger, Trigger.Request(), timeout), as_json=as_json)

    examples = f"  lcmtools sim {verb}\n  lcmtools sim {verb} {example}"
    command.help = f"{about}\n\n\b\nExamples:\n{examples}\n"
    return command


pause = _trigger("pause", "Let simulated time stand still.", "--sim /morse")
resume = _trigger("resume", "Let simulated time go on.", "--sim /morse")
reset = _trigger("reset", "Start again: time 0, and every robot where it started.", "--timeout 10s")
