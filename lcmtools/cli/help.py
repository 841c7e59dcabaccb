"""``lcmtools help``."""

import click

from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.lazy import COMMAND
from lcmtools.cli.output import write_data


@subcommand("help")
@examples("help echo", "help node info")
@argument("words", metavar="[COMMAND...]", nargs=-1, completer="runnables:commands")
@click.pass_context
def command(ctx: click.Context, words: tuple[str, ...]) -> None:
    """Show the help of a command, as COMMAND --help does."""
    context = ctx.find_root()
    for word in words:
        group = context.command
        if not isinstance(group, click.Group):
            ctx.fail(f"{context.command_path} has no commands below it")
        name, below, _ = group.resolve_command(context, [word])
        if below is None:
            ctx.fail(f"no such command '{word}'")
        context = below.make_context(name, [], parent=context, resilient_parsing=True)
    context.meta[COMMAND] = ctx.command_path  # not the command that is looked up
    write_data(context.get_help())
