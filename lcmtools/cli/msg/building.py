"""What ``msg build`` and ``pkg build`` share: folders of .lcm files compiled, and that said."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import click

from lcmtools.cli.lazy import COMMAND
from lcmtools.cli.output import complain, document, lines
from lcmtools.messages.type_source import Problem, TypeSource, shown
from lcmtools.packages.user_types import compile_folders


def build_folders(folders: Sequence[Path], *, as_json: bool) -> int:
    """Compile the types of folders, print them, and complain of the others; the exit code."""
    source = compile_folders(folders)
    made = {name: file for name, file in source.files.items() if _is_in(file, folders)}
    problems = [one for one in source.problems if _is_in(one.file, folders)]
    if as_json:
        document(_record(source, made, problems))
    else:
        lines(f"{name}  {shown(file)}" for name, file in sorted(made.items()))
    command = click.get_current_context().meta.get(COMMAND, "lcmtools")
    for problem in problems:
        complain(str(command), problem.error())
    return 1 if problems else 0


def _record(
    source: TypeSource, made: dict[str, str], problems: Sequence[Problem]
) -> dict[str, object]:
    return {
        "types": [
            {"type": name, "fingerprint": f"{source.fingerprints[name]:#018x}", "file": file}
            for name, file in sorted(made.items())
        ],
        "problems": [asdict(problem) for problem in problems],
    }


def _is_in(file: str, folders: Sequence[Path]) -> bool:
    return any(Path(file).is_relative_to(folder) for folder in folders)
