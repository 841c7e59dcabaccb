"""The submissions of a class: programs in a folder, which run in copies."""

import os
import re
import shlex
import shutil
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from lcmtools.errors import UsageError, os_errors_as
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.packages.cpp_nodes import SUFFIXES, has_cpp_main

PROGRAM = "{program}"  # the placeholder in a command line for a submission's path
_LARGEST = 200_000_000  # bytes of a submission, which is copied
_PROGRAMS = (".py", ".sh", *SUFFIXES, "", ".bin", ".out")
"""The suffixes of programs; of two with the same name, the first of these is taken."""
_MOST_BYTES = 1 << 20  # of a source that is searched for names of topics


def submissions_in(folder: Path) -> list[Path]:
    """Return the submissions in a folder: its files and folders.

    Raises:
        UsageError: There is none, or something else, as a pipe, or it is too large.
    """
    with os_errors_as(f"{folder}", "--programs takes a folder", UsageError):
        found = sorted(path for path in folder.iterdir() if path.name[0] not in "._")
    if not found:
        raise UsageError(f"{folder} is empty", "put each submission into it, a file or a folder")
    for path in found:
        if not (path.is_file() or path.is_dir()):
            raise UsageError(f"{path} is neither a file nor a folder", f"move it out of {folder}")
        files = [path] if path.is_file() else [*_files(path)]
        if sum(one.stat().st_size for one in files) > _LARGEST:
            raise UsageError(f"{path} has more than {_LARGEST} bytes", "submit only the programs")
    return found


def copy_submission(submission: Path, folder: Path) -> None:
    """Copy a submission (a file, or the content of a folder) into its own folder.

    Devices, pipes and sockets are left out, and folders that CMake has built, where it would insist
    on the original's path.
    """
    if submission.is_dir():
        shutil.copytree(submission, folder, symlinks=True, ignore=_left_out, dirs_exist_ok=True)
    else:
        shutil.copy2(submission, folder)


def _left_out(folder: str, names: list[str]) -> list[str]:
    paths = [Path(folder, name) for name in names]
    return [
        one.name
        for one in paths
        if (one / "CMakeCache.txt").is_file()
        or not (one.is_symlink() or one.is_file() or one.is_dir())
    ]


def programs_of(lab: Lab, folder: Path, commands: Mapping[str, str]) -> dict[str, str]:
    """Return the command lines of a submission's programs by option, to run in its folder.

    In given command lines, {program} becomes the only file, else the folder. Otherwise programs are
    found by name (simple_controller.py) or, if no name fits, by the lab's topics in a source.
    """
    files = list(_files(folder))
    if commands:
        path = shlex.quote(str(files[0].relative_to(folder)) if len(files) == 1 else ".")
        return {option: text.replace(PROGRAM, path) for option, text in commands.items()}
    files = [path for path in files if path.suffix in _PROGRAMS]
    files.sort(key=lambda path: _PROGRAMS.index(path.suffix))
    programs = {path: text for path in files if (text := command_of_file(path, folder))}
    chosen = {program.option: _best(lab, program, list(programs)) for program in lab.programs}
    return {option: programs[path] for option, path in chosen.items() if path}


def _files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")):
        inside = path.relative_to(folder).parts
        if path.is_file() and not any(part[0] in "._" for part in inside):
            yield path


def programs_named(lab: Lab, folder: Path) -> dict[str, list[Path]]:
    """Return the programs in a folder that are named after a lab's programs, by option.

    A file with only a part of such a name, as my_controller.py, must also have the topics of that
    program. Names are relative to the folder; the first one of each program is the likeliest.
    """
    found = dict[str, list[Path]]()
    files = [one for one in folder.iterdir() if one.suffix in _PROGRAMS and one.is_file()]
    for path in sorted(files, key=lambda one: (len(one.stem), _PROGRAMS.index(one.suffix))):
        program = _named(lab, path)
        if program is None or not command_of_file(path, folder):
            continue
        if program.node in path.stem or _likeliest(lab, path) is program:
            found.setdefault(program.option, []).append(path.relative_to(folder))
    return found


def program_of(lab: Lab, path: Path) -> LabProgram | None:
    """Return the lab's program that a file is, by its name or the topics in it; else None."""
    return _named(lab, path) or _likeliest(lab, path)


def command_of_file(path: Path, folder: Path) -> str:
    """Return the command line of a program, to run in a folder; "" for another file."""
    name = os.path.relpath(path, folder)
    if path.suffix == ".py":
        return shlex.join((Path(sys.executable).name, name))
    if path.suffix in SUFFIXES:
        return shlex.quote(name) if has_cpp_main(path) else ""
    return shlex.quote(f"./{name}") if path.stat().st_mode & 0o111 else ""


def _best(lab: Lab, program: LabProgram, files: list[Path]) -> Path | None:
    """Find the program's file: by its name, else by the topics in its source."""
    if named := [path for path in files if _named(lab, path) is program]:
        return min(named, key=lambda path: program.node not in path.stem.lower())
    unnamed = [path for path in files if _named(lab, path) is None]
    return next((path for path in unnamed if _likeliest(lab, path) is program), None)


def _named(lab: Lab, path: Path) -> LabProgram | None:
    """Return the program that a file is named after: evaluate_controller is no controller."""
    name = path.stem.lower()
    by_node = [program for program in lab.programs if program.node in name]
    fitting = by_node or [program for program in lab.programs if program.option in name]
    return fitting[0] if len(fitting) == 1 else None


def _likeliest(lab: Lab, path: Path) -> LabProgram | None:
    """Return the program whose topics and types occur most in a source; None if none occur."""
    with path.open("rb") as stream:
        text = stream.read(_MOST_BYTES).decode(errors="replace")

    def score(program: LabProgram) -> int:
        topics = [topic.rpartition("/")[2] for topic in program.publishes + program.subscribes]
        words = {*topics, *(name.rpartition("/")[2] for name in program.types)}
        return sum(re.search(rf"\b{word}\b", text) is not None for word in words)

    best = max(lab.programs, key=score)
    return best if score(best) else None
