"""From launch files to a plan: the meaning of every tag but node's and param's own.

Belongs here: order and scope, arguments, groups, includes, and what is said of things that mean
nothing on LCM. Nothing is started here, and nothing is left of a file with a mistake.
https://wiki.ros.org/roslaunch/XML
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_xml import DEEPEST, Element
from lcmtools.launch.arguments import (
    check_given,
    check_passed,
    declare,
    given_inside,
    names_in,
)
from lcmtools.launch.file import File, read_file
from lcmtools.launch.nodes import Program, find_node, node_name, plan_node
from lcmtools.launch.packages import path_from
from lcmtools.launch.parameters import full_name, own_parameters, param, rosparam
from lcmtools.launch.plan import NodePlan, Plan
from lcmtools.launch.scope import Scope, located
from lcmtools.launch.tags import known_children, unknown_parts

MOST_ELEMENTS = 100_000
"""Tags of all files together, repeated ones counted: a file may include one several times."""


@dataclass(frozen=True, slots=True)
class _Wanted:
    """A node as it was met, before all parameters are known."""

    element: Element
    scope: Scope
    program: Program


@dataclass(slots=True)
class Reading:
    """What has been found in the files so far."""

    wanted: list[_Wanted] = field(default_factory=list)
    parameters: dict[str, str] = field(default_factory=dict)
    files: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    depth: int = 0
    elements: int = 0

    def read(self, file: File, scope: Scope) -> None:
        """Take a file in.

        Raises:
            InvalidFile: Something in it is wrong.
        """
        root = file.root
        self.files.append(file.path)
        if "deprecated" in root.attributes:
            self.notes.append(f"{root.place}: deprecated: {root.attributes['deprecated']}")
        self._children(root, scope)

    def plan(self) -> Plan:
        """All that was found, as a plan.

        Raises:
            InvalidFile: Two nodes have the same name, or a node is wrong.
        """
        nodes = [self._planned(wanted) for wanted in self.wanted]
        _check_names(nodes)
        return Plan(tuple(nodes), tuple(dict.fromkeys(self.files)), tuple(self.notes))

    def _planned(self, wanted: _Wanted) -> NodePlan:
        name = node_name(wanted.element, wanted.scope, wanted.program)
        own = {**wanted.scope.parameters, **own_parameters(name, self.parameters)}
        return plan_node(wanted.element, wanted.scope, wanted.program, own)

    def _children(self, element: Element, scope: Scope) -> Scope:
        """Take in what stands in an element; the scope behind the last of it."""
        self.notes += [*unknown_parts(element), *_meaningless(element)]
        for child in known_children(element):
            self.elements += 1
            if self.elements > MOST_ELEMENTS:
                raise child.error(f"more than {MOST_ELEMENTS} tags in all")
            if scope.holds(child):
                scope = self._take(child, scope)
        return scope

    def _take(self, element: Element, scope: Scope) -> Scope:
        """Take in one element; the scope behind it."""
        ways: Mapping[str, Callable[[Element, Scope], Scope]] = {
            "arg": self._arg,
            "group": self._group,
            "include": self._include,
            "node": self._node,
            "param": self._param,
            "rosparam": self._rosparam,
        }
        if element.tag in ways:
            return ways[element.tag](element, scope)
        self.notes += unknown_parts(element)
        if element.tag == "remap":
            return scope.with_remap(element)
        if element.tag == "env":
            return scope.with_variable(element)
        if element.tag == "machine":
            self.notes.append(f"{element.place}: machine means nothing here: all runs on this one")
        return scope  # a test is for rostest, and left out as roslaunch leaves it out

    def _arg(self, element: Element, scope: Scope) -> Scope:
        self.notes += unknown_parts(element)
        return declare(element, scope)

    def _group(self, element: Element, scope: Scope) -> Scope:
        self._children(element, scope.below(element))
        return scope

    def _node(self, element: Element, scope: Scope) -> Scope:
        inside = scope.below(element)
        program = find_node(element, inside)
        name = node_name(element, inside, program)
        # what is not private already has the node's name before it: parameters, as in roslaunch
        behind = self._children(element, replace(inside, namespace=name))
        own = replace(behind, namespace=inside.namespace)
        self.wanted.append(_Wanted(element, own, program))
        return scope

    def _param(self, element: Element, scope: Scope) -> Scope:
        self.notes += unknown_parts(element)
        found = param(element, scope)
        if found is None:
            what = f"{element.place}: no command is run, and no binary file read, for a parameter"
            self.notes.append(f"{what}; it is left out")
            return scope
        return self._set(element, scope, [found])

    def _rosparam(self, element: Element, scope: Scope) -> Scope:
        self.notes += unknown_parts(element)
        command = scope.text(element, "command", "load")
        if command != "load":
            self.notes.append(f"{element.place}: rosparam {command} means nothing here")
            return scope
        return self._set(element, scope, list(rosparam(element, scope)))

    def _set(self, element: Element, scope: Scope, found: Sequence[tuple[str, str]]) -> Scope:
        """Parameters: private ones are for the nodes below, the others for nodes by their names."""
        private = {name[1:].lstrip("/"): text for name, text in found if name.startswith("~")}
        for name, text in found:
            if not name.startswith("~"):
                self.parameters[full_name(element, name, scope)] = text
        return scope.with_parameters(private.items())

    def _include(self, element: Element, scope: Scope) -> Scope:
        self.notes += unknown_parts(element)
        if self.depth == DEEPEST:
            raise element.error(f"files include each other more than {DEEPEST} levels deep")
        name = scope.required(element, "file")
        path = located(element, lambda: path_from(scope.folder, name))
        takes_all = scope.flag(element, "pass_all_args")
        inside, passed = given_inside(element, scope)
        file = read_file(path, element.place)
        if not takes_all:
            check_passed(element, passed, names_in(file.root), file.root.source)
        self.depth += 1
        self.read(
            file,
            replace(
                inside,
                folder=file.folder,
                arguments={},
                passed={**(scope.arguments if takes_all else {}), **passed},
                is_included=True,
                takes_all=takes_all,
            ),
        )
        self.depth -= 1
        return scope


def _meaningless(element: Element) -> Iterator[str]:
    """What roslaunch does by an attribute, and a launch on LCM does not."""
    if element.attributes.get("clear_params", "false") != "false":
        yield f"{element.place}: clear_params means nothing here: no parameter outlives its node"
    if "machine" in element.attributes:
        yield f"{element.place}: machine means nothing here: all runs on this one"


@dataclass(frozen=True, slots=True)
class Given:
    """What was said besides the files.

    Attributes:
        arguments: Of the files, by name.
        namespace: The full one that everything is pushed into.
        environment: The variables.
    """

    arguments: Mapping[str, str] = field(default_factory=dict)
    namespace: str = "/"
    environment: Mapping[str, str] = field(default_factory=dict)


def make_plan(files: Sequence[File], given: Given) -> Plan:
    """What files ask for, all together.

    Args:
        files: The files.
        given: What was said besides.

    Raises:
        InvalidFile: Something in them is wrong.
        UsageError: An argument was given that no file takes.
    """
    try:
        return _plan(files, given)
    except RecursionError:
        source = files[0].root.source
        raise InvalidFile(f"{source}: groups and includes are nested too deeply") from None


def _plan(files: Sequence[File], given: Given) -> Plan:
    check_given([file.root for file in files], given.arguments)
    reading = Reading()
    names: dict[str, str] = {}
    for file in files:
        taken = names_in(file.root)
        own = {name: text for name, text in given.arguments.items() if name in taken}
        reading.read(
            file, Scope(file.folder, given.namespace, given.environment, names, passed=own)
        )
    return reading.plan()


def _check_names(nodes: Sequence[NodePlan]) -> None:
    counts = Counter(node.name for node in nodes)
    for name, count in counts.items():
        if count > 1:
            places = [node.place for node in nodes if node.name == name]
            what = f"{places[1]}: the node {name} is there already, by {places[0]}"
            raise InvalidFile(what, "give it another name or namespace")
