"""``lcmtools lab start``."""

import click

from lcmtools.cli import run
from lcmtools.cli.declare import CONTEXT, argument
from lcmtools.cli.options import bus_options, open_monitor
from lcmtools.cli.output import talk
from lcmtools.errors import LcmtoolsError
from lcmtools.labs.catalogue import find_lab


@click.command("start", context_settings={**CONTEXT, "ignore_unknown_options": True})
@bus_options
@argument("name", completer="lcmtools.labs.commands.completion:labs")
@argument(
    "arguments",
    nargs=-1,
    type=click.UNPROCESSED,
    completer="lcmtools.labs.commands.completion:simulator_arguments",
)
@click.pass_context
def command(ctx: click.Context, name: str, arguments: tuple[str, ...]) -> int:
    """Run a lab's simulator until Ctrl-C, and show what to type next.

    ARGUMENTS are passed to the simulator: --rate 4, --gui; see lcmtools run sim --help.

    \b
    Examples:
      lcmtools lab start husky
      lcmtools lab start pioneer --gui
    """
    lab = find_lab(name)
    with open_monitor("lab_start") as monitor:
        nodes = {node.name for node in monitor.settle(foreign=False).nodes if not node.stale}
    if lab.simulator in nodes:
        raise LcmtoolsError(
            f"{lab.simulator} runs on this bus already",
            "end it with Ctrl-C where it runs, or take a bus of your own: --domain 3",
        )
    steps = "\n".join(f"  {step}" for step in lab.steps)
    talk(f"{lab.title}\nIn a second terminal, type:\n{steps}\nCtrl-C ends the simulator.")
    words = ("--world", lab.world, *arguments)
    return int(ctx.invoke(run.command, name="sim", arguments=words, show_list=False, as_json=False))
