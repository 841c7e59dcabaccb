"""A ``<node>`` as a process: its names, its program and its command line.

Belongs here: the meaning of one node tag in its scope. Parameters with full names are added later,
when the whole file is known.
"""

import os
from collections.abc import Iterable, Mapping

from lcmtools.arguments import NodeArguments, split_arguments
from lcmtools.formats.strict_xml import Element
from lcmtools.launch import executables
from lcmtools.launch.executables import Executable
from lcmtools.launch.packages import path_from
from lcmtools.launch.plan import NodePlan, Output
from lcmtools.launch.scope import Scope, located
from lcmtools.names import base_name_of, check_base_name, namespace_of, resolve

_OUTPUTS = tuple(output.value for output in Output)
_HOMES = ("ros_home", "ros-root", "node")  # values of cwd that roslaunch knows, in any case


def node_name(element: Element, scope: Scope, program: Executable) -> str:
    """Return a node's full name."""
    name = scope.text(element, "name")
    if not name and {"run", "exec"} & set(element.attributes):  # then it has its program's
        name = program.command[-1].rpartition("/")[2].partition(".")[0].replace("-", "_")
    name = name or scope.required(element, "name")
    located(element, lambda: check_base_name(name, "the attribute ns"))
    return resolve(name, scope.namespace)


def find_node(element: Element, scope: Scope) -> Executable:
    """Return a node's program, which exists."""
    ways = [name for name in ("pkg", "run", "exec") if name in element.attributes]
    if len(ways) > 1:
        hint = "the program of pkg is named by type" if "pkg" in ways else ""
        raise element.error(f"a node has only one of {' and '.join(ways)}", hint)
    if ways in (["exec"], ["run"]):
        scope.required(element, ways[0])
        words = scope.words(element, ways[0])
        if not words:
            raise element.error(f"'{ways[0]}' is empty in node")
        return located(element, lambda: _of_words(words, scope, ways[0]))
    package, name = scope.required(element, "pkg"), scope.required(element, "type")
    return located(element, lambda: executables.find_executable(package, name, scope.folder))


def _of_words(words: list[str], scope: Scope, way: str) -> Executable:
    """Return the program of exec: or run:, given words as for ``lcmtools run`` or a path."""
    first, rest = words[0], tuple(words[1:])
    if way == "exec":
        program = executables.find_program(first, scope.folder)
        return Executable((program,), arguments=rest, takes_names=False)
    if "/" in first or first.endswith(".py"):
        return Executable(executables.find_script(first, scope.folder), arguments=rest)
    return executables.find_typed(words, scope.folder)


def plan_node(
    element: Element, scope: Scope, program: Executable, parameters: Mapping[str, str]
) -> NodePlan:
    """Return a node as a process, with all its parameters, name to YAML text."""
    name = node_name(element, scope, program)
    respawn, is_required = scope.flag(element, "respawn"), scope.flag(element, "required")
    if respawn and is_required:
        raise element.error("a node cannot be both required and respawned", "leave one of them out")
    prefix = scope.words(element, "launch-prefix")
    words = [*program.arguments, *scope.words(element, "args")]
    end = words.index("--") if "--" in words else len(words)  # nodes accept no names after it
    own = [word for word in words[:end] if word.startswith("_") and not word.startswith("__")]
    typed = split_arguments(own)[0].parameters
    if program.takes_names:
        remaps = tuple(scope.remaps.items())
        names = NodeArguments(namespace_of(name), base_name_of(name), remaps, dict(parameters))
        words[end:end] = names.words()
    elif any(child.tag in ("remap", "param", "rosparam") for child in element.children):
        raise element.error("a program started by exec takes no remaps or parameters", "use run")
    command = (*prefix, *program.command, *words)
    environment = _environment(scope, program)
    _check_texts(element, (*command, *environment.values()))
    return NodePlan(
        name=name,
        command=command,
        place=element.place,
        parameters={**typed, **(parameters if program.takes_names else {})},
        environment=environment,
        directory=_directory(element, scope) or program.directory,
        output=_output(element, scope),
        respawn=respawn,
        respawn_delay=scope.seconds(element, "respawn_delay"),
        is_required=is_required,
        takes_input=bool(prefix),
        takes_terminal=scope.flag(element, "stdin"),
    )


def _environment(scope: Scope, program: Executable) -> dict[str, str]:
    """Return the variables that files set; a program that accepts no names may read this one."""
    if program.takes_names or scope.namespace == "/":
        return dict(scope.set_variables)
    return {"LCMTOOLS_NAMESPACE": scope.namespace, **scope.set_variables}


def _check_texts(element: Element, texts: Iterable[str]) -> None:
    """Refuse characters that cannot be passed to a process; YAML allows any."""
    for text in texts:
        try:
            is_bad = b"\0" in os.fsencode(text)
        except UnicodeEncodeError:  # a lone surrogate
            is_bad = True
        if is_bad:
            raise element.error(f"{text!a} has a character that a command line cannot have")


def _directory(element: Element, scope: Scope) -> str:
    text = scope.text(element, "cwd")
    if not text or text.lower() in _HOMES:
        return ""
    path = located(element, lambda: path_from(scope.folder, text))
    if not os.path.isdir(path):  # noqa: PTH112 - pathlib raises for a name that is too long
        raise element.error(f"there is no folder {path}")
    return str(path)


def _output(element: Element, scope: Scope) -> Output:
    text = scope.text(element, "output", Output.LOG.value)
    if text not in _OUTPUTS:
        raise element.error(f"'output' must be one of {', '.join(_OUTPUTS)}, not '{text}'")
    return Output(text)
