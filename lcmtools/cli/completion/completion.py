"""``lcmtools completion``."""

import os
import sys

from lcmtools.cli.completion.install import install, plan, script, shell_named, uninstall
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.output import write_data, write_note
from lcmtools.errors import UsageError


@subcommand("completion")
@examples("completion --install", "completion zsh --install", "completion bash > lcmtools.bash")
@argument("shell", metavar="[bash|zsh|fish]", required=False, completer=("bash", "zsh", "fish"))
@flag("--install", "is_install", help="Install the completion script.")
@flag("--uninstall", "is_uninstall", help="Undo --install.")
def command(shell: str | None, *, is_install: bool, is_uninstall: bool) -> None:
    """Complete commands, topics, types, fields, messages and more with the TAB key.

    --install puts the completion script where the shell finds it; without it, the script is printed
    into a file or a pipe. Without an argument the shell is that in SHELL.
    """
    if is_install and is_uninstall:
        raise UsageError("--install and --uninstall exclude each other", "use one of them")
    name = shell_named(shell, os.environ)
    if is_uninstall:
        for done in uninstall(plan(name, os.environ)):
            write_note(done)
        return
    if is_install:
        wanted = plan(name, os.environ)
        for done in install(name, wanted):
            write_note(done)
        write_note(f"start a new shell, or type: {wanted.restart}")
    elif sys.stdout.isatty():
        write_note(f"nothing is installed yet; type: lcmtools completion {name} --install")
        write_note(f"or use the script in another place: lcmtools completion {name} > FILE")
    else:
        write_data(script(name).rstrip("\n"))
