"""From launch files to a plan: the meaning of every tag except node and param.

Belongs here: order and scope, arguments, groups, includes, and notes on parts that mean nothing on
LCM. Nothing is started here, and a file with a mistake gives no plan.
https://wiki.ros.org/roslaunch/XML
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_xml import DEEPEST, Element
from lcmtools.launch.arguments import (
    check_given,
    check_passed,
    declare,
    given_inside,
    names_in,
    passes_all,
)
from lcmtools.launch.executables import Executable
from lcmtools.launch.file import File, read_file
from lcmtools.launch.node_tag import find_node, node_name, plan_node
from lcmtools.launch.packages import LABS, path_from
from lcmtools.launch.parameter_tags import (
    note_on_lost,
    notes_on_values,
    own_parameters,
    param,
    rosparam,
)
from lcmtools.launch.plan import NodePlan, Plan
from lcmtools.launch.scope import Scope, located
from lcmtools.launch.tags import known_children, notes_on
from lcmtools.names import resolve
from lcmtools.packages.workspace import workspace

_MOST_ELEMENTS = 100_000  # tags of all files together, repeated includes counted each time
_MOST_INCLUDES = 1000  # files that include others twice, and these others, have no end
_COMMANDS = ("load", "dump", "delete")  # of a rosparam


def make_plan(
    files: Sequence[File],
    arguments: Mapping[str, str],
    namespace: str,
    environment: Mapping[str, str],
) -> Plan:
    """Return the plan of files, with their arguments and the namespace for everything.

    Raises:
        InvalidFile: Something in them is wrong.
        UsageError: An argument was given that no file accepts.
    """
    roots = [file.root for file in files]
    if not any(map(passes_all, roots)):
        check_given(roots, arguments)
    reading = _Reading()
    names: dict[str, str] = {}
    try:
        for file in files:
            taken = names_in(file.root)
            if passes_all(file.root):
                taken = set(arguments)
            own = {name: text for name, text in arguments.items() if name in taken}
            scope = Scope(file.folder, namespace, environment, names, passed=own)
            reading.read(file, scope)
        check_given(reading.roots, arguments)
        return reading.plan()
    except RecursionError:
        source = files[0].root.source
        raise InvalidFile(f"{source}: groups and includes are nested too deeply") from None


@dataclass(slots=True)
class _Reading:
    """The content of the files read so far."""

    nodes: list[tuple[Element, Scope, Executable]] = field(default_factory=list)
    parameters: dict[str, str] = field(default_factory=dict)
    files: list[str] = field(default_factory=list)
    roots: list[Element] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    _included: dict[Path, File] = field(default_factory=dict)  # those read so far
    depth: int = 0
    elements: int = 0

    def read(self, file: File, scope: Scope) -> None:
        root = file.root
        is_first_own = not any(Path(one).is_relative_to(LABS) for one in self.files)
        if file.folder.is_relative_to(LABS) and is_first_own:
            package = file.folder.relative_to(LABS).parts[0]
            note = f"this is lcmtools' own {Path(file.path).name}, of its package {package}"
            self.notes.append("; ".join([note, *map(str, workspace(Path.cwd()).problems)]))
        self.files.append(file.path)
        self.roots.append(root)
        if "deprecated" in root.attributes:
            self.notes.append(f"{root.place}: deprecated: {root.attributes['deprecated']}")
        self._children(root, scope)

    def plan(self) -> Plan:
        """Return the plan, now that all parameters are known."""
        plans: dict[str, NodePlan] = {}
        for element, scope, program in self.nodes:
            name = node_name(element, scope, program)
            own = {**scope.parameters, **own_parameters(name, self.parameters)}
            node = plan_node(element, scope, program, own)
            if other := plans.get(name):
                what = f"{node.place}: the node {name} is already defined by {other.place}"
                raise InvalidFile(what, "give it another name or namespace")
            plans[name] = node
        self.notes += note_on_lost(plans, self.parameters)
        return Plan(tuple(plans.values()), tuple(dict.fromkeys(self.files)), tuple(self.notes))

    def _children(self, element: Element, scope: Scope) -> Scope:
        """Read the elements in an element; return the scope after the last of them."""
        self.notes += notes_on(element)
        for child in known_children(element):
            self.elements += 1
            if self.elements > _MOST_ELEMENTS:
                raise child.error(f"more than {_MOST_ELEMENTS} tags in total")
            if scope.holds(child):
                scope = self._read_element(child, scope)
        return scope

    def _read_element(self, element: Element, scope: Scope) -> Scope:
        """Read an element; return the scope after it."""
        if element.tag not in ("group", "node"):  # these are checked with their children's
            self.notes += notes_on(element)
        changes: Mapping[str, Callable[[Element, Scope], Scope]] = {
            "arg": declare,
            "param": self._param,
            "rosparam": self._rosparam,
            "remap": lambda element, scope: scope.with_remap(element),
            "env": lambda element, scope: scope.with_variable(element),
        }
        if element.tag in changes:
            return changes[element.tag](element, scope)
        if element.tag == "group":
            self._children(element, scope.below(element))
        elif element.tag == "include":
            self._include(element, scope)
        elif element.tag == "node":
            self._node(element, scope.below(element))
        return scope  # a test is for rostest, and ignored as in roslaunch

    def _node(self, element: Element, scope: Scope) -> None:
        program = find_node(element, scope)
        is_noted = any(one.note == program.note for _, _, one in self.nodes)
        if program.note and not is_noted and not scope.folder.is_relative_to(LABS):
            self.notes.append(f"{element.place}: {program.note}")
        name = node_name(element, scope, program)
        # within a node, parameters that are not private get the node's name, as in roslaunch
        behind = self._children(element, replace(scope, namespace=name))
        self.nodes.append((element, replace(behind, namespace=scope.namespace), program))

    def _param(self, element: Element, scope: Scope) -> Scope:
        found = param(element, scope)
        if found is not None:
            return self._set(element, scope, found)
        what = f"{element.place}: a parameter cannot be set by a command or a binary file"
        self.notes.append(f"{what}; it is left out")
        return scope

    def _rosparam(self, element: Element, scope: Scope) -> Scope:
        command = scope.text(element, "command") or "load"
        if command not in _COMMANDS:
            raise element.error(f"'command' must be {' or '.join(_COMMANDS)}, not '{command}'")
        if command == "load":
            return self._set(element, scope, list(rosparam(element, scope, self.notes)))
        self.notes.append(f"{element.place}: rosparam {command} has no effect")
        return scope

    def _set(self, element: Element, scope: Scope, found: Sequence[tuple[str, str]]) -> Scope:
        """Set parameters: private ones for the nodes that follow, others by their full names."""
        self.notes += notes_on_values(found, element)
        private = {name[1:].lstrip("/"): text for name, text in found if name.startswith("~")}
        for name, text in found:
            if not name.startswith("~"):
                full = located(element, partial(resolve, name, scope.namespace))
                self.parameters[full] = text
        return replace(scope, parameters={**scope.parameters, **private})

    def _include(self, element: Element, scope: Scope) -> None:
        if self.depth == DEEPEST:
            raise element.error(f"files include each other more than {DEEPEST} levels deep")
        name = scope.required(element, "file")
        path = located(element, lambda: path_from(scope.folder, name))
        takes_all = scope.flag(element, "pass_all_args")
        inside, passed = given_inside(element, scope)
        if len(self.files) > _MOST_INCLUDES:
            raise element.error(f"more than {_MOST_INCLUDES} files are included")
        if path not in self._included:
            self._included[path] = read_file(path, element.place)
        file = self._included[path]
        if not takes_all:
            check_passed(element, passed, file.root)
        passed = {**({**scope.passed, **scope.arguments} if takes_all else {}), **passed}
        inside = replace(inside, folder=file.folder, is_included=True, takes_all=takes_all)
        inside = replace(inside, arguments={}, passed=passed)
        self.depth += 1
        self.read(file, inside)
        self.depth -= 1
