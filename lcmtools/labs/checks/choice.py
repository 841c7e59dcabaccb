"""The programs to check: those given, those of the current folder, or the model answers."""

import shlex
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks.checked_programs import check_startable, split_command
from lcmtools.labs.checks.submissions import command_of_file, program_of, programs_named
from lcmtools.names import did_you_mean
from lcmtools.packages.cpp_nodes import SUFFIXES, is_cpp
from lcmtools.packages.finding import find_node
from lcmtools.packages.programs import built_program, command_of, find_program
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.workspace import workspace

_IN_QUOTES = "a command line is one word, in quotes"


@dataclass(frozen=True, slots=True)
class Run:
    """A program to be checked."""

    program: LabProgram  # the lab's program that it implements
    command: Sequence[str]  # its command line
    is_answer: bool = False  # True for the model answer of lcmtools

    @property
    def source(self) -> Path | None:
        """The source in C++ that is built first, if it is one."""
        path = Path(self.command[0])
        return path if is_cpp(path) else None


def choose(
    lab: Lab, programs: Mapping[str, str], files: Sequence[str] = ()
) -> tuple[list[Run], str]:
    """Return the programs to check, and a sentence that says which were found in this folder.

    ``programs`` are the student's command lines by option, ``files`` their programs. Without any,
    the programs of the current folder with the names of the lab's are checked: those of its
    packages, or its files. If there are none, these are the model answers. The lab's names are
    added to commands without names.

    Raises:
        UsageError: A program belongs to another lab or does not exist, a command line is wrong,
            or a file of the workspace is not declared as a node, not built or not executable.
    """
    known = {program.option: program for program in lab.programs}
    if files and programs:
        option, command = next(iter(programs.items()))
        hint = f"{_IN_QUOTES}: {shlex.quote(f'{command} {files[0]}')}"
        raise UsageError(f"--{option} and {files[0]} are both given", hint)
    given = dict(programs)
    for file in files:
        option, command = _of_file(lab, file)
        if given.setdefault(option, command) != command:
            what = f"{given[option]} and {file} are both for --{option}"
            raise UsageError(what, "check one after the other")
    may_be_answer = any(text.startswith("lcmtools run") for text in given.values())
    nodes = _workspace_nodes(lab) if may_be_answer or not given else {}
    nodes = nodes if given else dict(_workspace_scripts(lab)) | nodes
    commands, found = (given, "") if given else _here(lab, nodes)
    chosen = []
    for option, text in commands.items():
        if option not in known:
            hint = ", ".join(f"--{name}" for name in known)
            raise UsageError(f"--{option} is not a program of the lab {lab.name}", f"it has {hint}")
        words = _runnable(split_command(text))
        check_startable(words)
        is_answer = tuple(words[:3]) == known[option].answer and option not in nodes
        if not any(":=" in word for word in words):
            words += known[option].arguments
        chosen.append(Run(known[option], words, is_answer))
    answers = [Run(p, [*p.answer, *p.arguments], is_answer=True) for p in lab.programs]
    return chosen or answers, found


def _runnable(words: list[str]) -> list[str]:
    """Return a command line that begins with a file for this Python as one that Python runs."""
    file = Path(words[0])
    if file.suffix == ".py" and file.is_file() and command_of(file) != (str(file),):
        return [Path(sys.executable).name, *words]
    return words


def _of_file(lab: Lab, text: str) -> tuple[str, str]:
    """Return the option and the command line of a program that was given as a file."""
    file, here = Path(text), Path.cwd()
    if file.is_dir():
        hint = f"its files are checked where it is the current folder: cd {shlex.quote(text)}"
        raise UsageError(f"'{text}' is a folder", hint)
    if not file.is_file():
        names = [path.name for path in here.iterdir() if path.is_file()]
        hint = did_you_mean(text, names) or f'{_IN_QUOTES}: --OPTION "python {text}"'
        raise UsageError(f"there is no file '{text}'", hint)
    program, command = program_of(lab, file), command_of_file(file, here)
    if not command:
        hint = f"chmod +x {shlex.quote(text)} makes it one"
        raise UsageError(
            f"{text} is not a program", "it has no function main" if is_cpp(file) else hint
        )
    if program is None:
        options = " or ".join(f"--{one.option} {shlex.quote(text)}" for one in lab.programs)
        what = f"{text} has neither the name of a program of this lab nor a topic of one"
        raise UsageError(what, f"say which it is: {options}")
    return program.option, command


def _here(lab: Lab, nodes: Mapping[str, str]) -> tuple[dict[str, str], str]:
    """Return the command lines of this folder's programs, and a sentence that names them.

    A file comes before a package's node of that name, except within a package.
    """
    here = Path.cwd()
    is_inside = any(here.is_relative_to(one.folder) for one in workspace(here).packages)
    files = {} if is_inside else programs_named(lab, here)
    commands, taken, others = dict[str, str](), list[str](), list[str]()
    for program in lab.programs:
        if paths := files.get(program.option):
            commands[program.option] = command_of_file(here / paths[0], here)
            taken.append(str(paths[0]))
            others += [str(path) for path in paths[1:] if path.suffix in (".py", *SUFFIXES)]
        elif node := nodes.get(program.option):
            commands[program.option] = f"lcmtools run {node}"
            taken.append("{1} of the package {0}".format(*node.split()))
    missing = " or ".join(one.node for one in lab.programs if one.option not in commands)
    if not commands:
        return {}, f"there is no {missing} in this folder (.py or .cpp): checks the model answers"
    text = f"takes {' and '.join(taken)}" + (f"; there is no {missing} here" if missing else "")
    other = others[0] if others else ""
    return commands, f"{text}; lab check {lab.name} {other} takes that one" if other else text


def _workspace_nodes(lab: Lab) -> dict[str, str]:
    """Return the workspace's nodes with the names of a lab's programs, by option."""
    known, here = runnables(Path.cwd()), Path.cwd()
    found = {}
    for program in lab.programs:
        node, _ = find_node([program.node], known, here)
        if node.source:
            built_program(node)  # or raise
        if node.folder:
            found[program.option] = f"{node.package} {node.name}"
    return found


def _workspace_scripts(lab: Lab) -> Iterator[tuple[str, str]]:
    """Yield the scripts of the workspace's packages with these names, likewise."""
    here = Path.cwd()
    near = [one.name for one in workspace(here).packages if not one.is_noted]
    for program in lab.programs:
        for package in near:
            if script := find_program([package, program.node], here):
                yield program.option, f"{package} {script.name}"
