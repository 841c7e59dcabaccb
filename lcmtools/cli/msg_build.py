"""``lcmtools msg build`` and ``generate``."""

from collections.abc import Sequence
from pathlib import Path

import click

from lcmtools.cli.declare import argument, examples, option, subcommand
from lcmtools.cli.lazy import COMMAND
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_error, write_note, write_result
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.messages.type_source import shown
from lcmtools.packages import lcm_gen
from lcmtools.packages.lcm_gen import LANGUAGES
from lcmtools.packages.user_types import sources_of, user_types


@subcommand("build", json_option)
@examples("msg build", "msg build air_lab0/msg")
@argument("folder", metavar="[DIR]", required=False, type=click.Path())
def build(folder: str | None, *, as_json: bool) -> int:
    """Check and compile the types in DIR, or in LCMTOOLS_TYPE_PATH and the workspace.

    Types are in .lcm files, and in ROS's .msg, .srv and .action files.

    This step is optional, because types are compiled when they are first used. The exit code is 1
    if there are errors.
    """
    chosen = [Path(folder).absolute()] if folder else user_types().workspace_folders()
    if folder and not chosen[0].is_dir():
        raise UsageError(f"there is no folder {folder}")
    if not chosen:
        raise LcmtoolsError(
            "there are no folders with .lcm files", "name one, or set LCMTOOLS_TYPE_PATH"
        )
    return build_folders(chosen, as_json=as_json, summary=True)


def build_folders(folders: Sequence[Path], *, as_json: bool, summary: bool = False) -> int:
    """Compile the types of folders, print them and their problems, and return the exit code.

    ``summary`` adds a note of how many there were, and where.
    """
    source = user_types().compiled(folders)
    made = {n: f for n, f in sorted(source.files.items()) if _is_in(f, folders)}
    problems = [one for one in source.problems if _is_in(one.file, folders)]
    types = [
        {"type": name, "fingerprint": f"{source.fingerprints[name]:#018x}", "file": file}
        for name, file in made.items()
    ]
    record = {"types": types, "problems": [problem._asdict() for problem in problems]}
    write_result(record, (f"{name}  {shown(file)}" for name, file in made.items()), as_json=as_json)
    if summary and not as_json:
        write_note(f"{_counted(len(made))} in {', '.join(shown(str(one)) for one in folders)}")
    build = click.get_current_context().meta.get(COMMAND, "lcmtools")
    for problem in problems:
        write_error(str(build), problem.error())
    return 1 if problems else 0


def _counted(number: int) -> str:
    if not number:
        return "no .lcm, .msg, .srv or .action files that define types"
    return f"{number} type{'s'[: number != 1]} compiled"


def _is_in(file: str, folders: Sequence[Path]) -> bool:
    return any(Path(file).is_relative_to(folder) for folder in folders)


@subcommand("generate", json_option)
@examples(
    "msg generate --lang cpp generated geometry_msgs/Twist std_msgs/String",
    "msg generate --lang c generated air_lab0",
)
@option("--lang", required=True, type=click.Choice(LANGUAGES), help="The language.")
@argument("folder", metavar="DIR", type=click.Path())
@argument("types", nargs=-1, completer="messages:types")
def generate_code(*, lang: str, folder: str, types: tuple[str, ...], as_json: bool) -> None:
    """Generate code for message types into DIR with lcm-gen, for plain LCM programs.

    TYPES are types or packages, supplied or your own; none means all your own. Nested types are
    included.
    """
    written = list(
        map(str, lcm_gen.generate_code(sources_of(types), lang, Path(folder).expanduser()))
    )
    write_result(written, written, as_json=as_json)
    if not as_json:
        write_note(f"{len(written)} file{'s'[: len(written) != 1]} in {folder}")
