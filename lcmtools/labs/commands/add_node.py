"""``lcmtools pkg add-node``: it is here because it knows the labs' skeletons."""

import re
from pathlib import Path

from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.labs.skeletons import skeleton_text
from lcmtools.messages.type_source import shown
from lcmtools.packages.add_node import add_node
from lcmtools.packages.finding import find_package


@subcommand("add-node", json_option)
@examples(
    "pkg add-node evaluate_controller --skeleton evaluate_controller",
    "pkg add-node driver --package air_lab0",
)
@argument("name")
@option(
    "--package",
    metavar="NAME",
    help="The package (else that of this folder).",
    completer="runnables:packages",
)
@option(
    "--skeleton",
    metavar="NAME",
    help="Begin with a lab's skeleton.",
    completer="lcmtools.labs.commands.completion:skeletons",
)
@flag("--force", help="Overwrite an existing file.")
def command(
    *, name: str, package: str | None, skeleton: str | None, force: bool, as_json: bool
) -> None:
    """Add a node to a package: its file, and the line that declares it in pyproject.toml.

    A file NAME.py that is in the package already is kept and only declared.
    """
    home = find_package(package, Path.cwd())
    text = None
    if skeleton is not None:
        text = skeleton_text(skeleton).replace(
            f"python {skeleton}.py", f"lcmtools run {home.name} {skeleton}"
        )
        text = re.sub(rf"\b{skeleton}\b", name, text)
    written = [shown(path) for path in add_node(home, name, text, replace=force)]
    write_result({"package": home.name, "files": written}, written, as_json=as_json)
    if not as_json:
        is_below = Path.cwd().is_relative_to(home.folder) or Path.cwd() == home.folder.parent
        where = "" if is_below else f"cd {home.folder}; "
        write_note(f"next: {where}lcmtools run {home.name} {name}")
