"""A ``<node>`` as a process: its names, its program and its command line.

Belongs here: what one node tag means in its scope. Parameters that have full names come later,
when the whole file is known.
"""

import os
import shlex
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from lcmtools.formats.strict_xml import Element
from lcmtools.launch.executables import (
    RUN,
    find_executable,
    find_program,
    find_script,
    find_typed,
)
from lcmtools.launch.packages import path_from
from lcmtools.launch.plan import NodePlan, Output
from lcmtools.launch.scope import Scope, located
from lcmtools.names import check_base_name, resolve

_OUTPUTS = tuple(output.value for output in Output)
_HOMES = ("ROS_HOME", "node")  # of cwd; what else roslaunch knows
NAMESPACE = "LCMTOOLS_NAMESPACE"


@dataclass(frozen=True, slots=True)
class Program:
    """What runs a node.

    Attributes:
        command: What starts it.
        arguments: What was written behind that.
        takes_names: Whether it reads ``__ns:=`` and the like, as nodes do.
        directory: Where it must be run; "" for anywhere.
    """

    command: tuple[str, ...]
    arguments: tuple[str, ...] = ()
    takes_names: bool = True
    directory: str = ""


def node_name(element: Element, scope: Scope, program: Program | None = None) -> str:
    """A node's full name.

    Raises:
        InvalidFile: It is missing, or not legal.
    """
    name = scope.text(element, "name")
    if not name and program and {"run", "exec"} & set(element.attributes):
        name = _name_of(program)
    name = name or scope.required(element, "name")
    located(element, lambda: check_base_name(name))
    return resolve(name, scope.namespace)


def find_node(element: Element, scope: Scope) -> Program:
    """A node's program, which is there.

    Raises:
        InvalidFile: It is not said which, or there is none.
    """
    ways = [name for name in ("pkg", "run", "exec") if name in element.attributes]
    if len(ways) > 1:
        raise element.error(f"a node has only one of {' and '.join(ways)}")
    if ways == ["exec"]:
        first, *rest = _program_words(element, scope, "exec")
        path = located(element, lambda: find_program(first, scope.folder))
        return Program((path,), tuple(rest), takes_names=False)
    if ways == ["run"]:
        return _run(element, scope)
    package, name = scope.required(element, "pkg"), scope.required(element, "type")
    found = located(element, lambda: find_executable(package, name, scope.folder))
    return Program(found.command, directory=found.directory)


def plan_node(
    element: Element, scope: Scope, program: Program, parameters: Mapping[str, str]
) -> NodePlan:
    """A node as a process.

    Args:
        element: The tag.
        scope: What holds in it.
        program: What runs it.
        parameters: All that it gets, name to YAML text.

    Raises:
        InvalidFile: An attribute is wrong.
    """
    name = node_name(element, scope, program)
    respawn, is_required = scope.flag(element, "respawn"), scope.flag(element, "required")
    if respawn and is_required:
        raise element.error("a node is not both required and respawned", "leave one of them out")
    takes_terminal = scope.flag(element, "stdin")
    prefix = _words(element, scope.text(element, "launch-prefix"))
    command = (*prefix, *_command(element, scope, program, name, parameters))
    environment = _environment(scope, program)
    _check_texts(element, (*command, *environment.values()))
    return NodePlan(
        name=name,
        command=command,
        place=element.place,
        environment=environment,
        directory=_directory(element, scope) or program.directory,
        output=_output(element, scope),
        respawn=respawn,
        respawn_delay=scope.number(element, "respawn_delay"),
        is_required=is_required,
        takes_input=bool(prefix),
        takes_terminal=takes_terminal,
    )


def _name_of(program: Program) -> str:
    """The name of a node that is given none: its program's."""
    first, *rest = program.command
    is_run = (first, *rest[:1]) == RUN
    word = rest[-1] if is_run else rest[0] if first == sys.executable else first
    return word.rpartition("/")[2].partition(".")[0].replace("-", "_")


def _run(element: Element, scope: Scope) -> Program:
    """What ``run:`` says: NODE or PACKAGE NODE as after ``lcmtools run``, or a script's path."""
    words = _program_words(element, scope, "run")
    if "/" in words[0] or words[0].endswith(".py"):
        script = located(element, lambda: find_script(words[0], scope.folder))
        return Program(script, arguments=tuple(words[1:]))
    found, rest = located(element, lambda: find_typed(words, scope.folder))
    return Program(found.command, tuple(rest), directory=found.directory)


def _program_words(element: Element, scope: Scope, name: str) -> list[str]:
    words = _words(element, scope.required(element, name))
    if not words:
        raise element.error(f"'{name}' is empty in node")
    return words


def _words(element: Element, text: str) -> list[str]:
    """A text as the shell takes it apart."""
    try:
        return shlex.split(text)
    except ValueError:
        raise element.error(f"a quote is not closed in '{' '.join(text.split())}'") from None


def _command(
    element: Element,
    scope: Scope,
    program: Program,
    name: str,
    parameters: Mapping[str, str],
) -> list[str]:
    namespace, _, base = name.rpartition("/")
    words = [*program.command, *program.arguments, *_words(element, scope.text(element, "args"))]
    if not program.takes_names:
        if _asks(element):
            raise element.error("what exec starts takes no remaps or parameters", "use run")
        return words
    names = [
        f"__ns:={namespace or '/'}",
        f"__name:={base}",
        *(f"{source}:={target}" for source, target in scope.remaps),
        *(f"_{name}:={text}" for name, text in parameters.items()),
    ]
    end = words.index("--") if "--" in words else len(words)  # nodes take no names behind it
    return [*words[:end], *names, *words[end:]]


def _asks(element: Element) -> bool:
    """Whether a node has remaps or parameters of its own."""
    return any(child.tag in ("remap", "param", "rosparam") for child in element.children)


def _environment(scope: Scope, program: Program) -> dict[str, str]:
    """The variables that files set; a program that takes no names may still ask for this one."""
    is_told = program.takes_names or scope.namespace == "/"
    return {**({} if is_told else {NAMESPACE: scope.namespace}), **scope.set_variables}


def _check_texts(element: Element, texts: Iterable[str]) -> None:
    """Refuse what the system cannot hand to a process; YAML can write any character."""
    for text in texts:
        if "\0" in text or not _is_encodable(text):
            raise element.error(f"{text!a} has a character that no command line can have")


def _is_encodable(text: str) -> bool:
    try:
        os.fsencode(text)
    except UnicodeEncodeError:  # half a character
        return False
    return True


def _directory(element: Element, scope: Scope) -> str:
    text = scope.text(element, "cwd")
    if not text or text in _HOMES:
        return ""
    path = located(element, lambda: path_from(scope.folder, text))
    if not os.path.isdir(path):  # noqa: PTH112 - pathlib's raises for a name that is too long
        raise element.error(f"there is no folder {path}")
    return str(path)


def _output(element: Element, scope: Scope) -> Output:
    text = scope.text(element, "output", Output.LOG.value)
    if text not in _OUTPUTS:
        raise element.error(f"'output' must be one of {', '.join(_OUTPUTS)}, not '{text}'")
    return Output(text)
