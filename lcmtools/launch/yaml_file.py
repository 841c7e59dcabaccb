"""YAML launch files, as elements.

Belongs here: the keys of our own form, and the tags that they mean. Others are refused.

    args: {robot: husky0}                    arguments with defaults; none given: must be given
    nodes:
      - run: simple_controller               as after lcmtools run
        name: husky_simple_controller
        ns: $(arg robot)
        remap: {controlled_velocity: velocity_cmd}
        param: {kp: 0.5}
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_xml import DEEPEST, Element
from lcmtools.formats.strict_yaml import Node, read_file
from lcmtools.messages.setting import write_setting
from lcmtools.names import did_you_mean

_Part: TypeAlias = "Callable[[_Document, Node], list[Element]]"

_NODE = (
    *("run", "exec", "name", "ns", "args", "cwd", "output", "respawn", "respawn_delay"),
    *("required", "stdin", "launch_prefix", "if", "unless"),
)
_GROUP = ("ns", "if", "unless")
_INCLUDE = ("file", "ns", "pass_all_args", "if", "unless")
_MOST_VALUES = 100_000
"""Values of a file, those that aliases repeat counted."""


@dataclass(slots=True)
class _Document:
    """Makes the elements of one file."""

    source: str
    values: int = 0

    def error(self, line: int, reason: str, hint: str = "") -> InvalidFile:
        return InvalidFile(f"{self.source}:{line}: {reason}", hint)

    def unknown(self, node: Node, name: str, what: str, known: Collection[str]) -> InvalidFile:
        hint = did_you_mean(name, known) or f"there are {', '.join(sorted(known))}"
        return self.error(node.key_line, f"there is no key '{name}' in {what}", hint)

    def element(self, tag: str, line: int, **attributes: str) -> Element:
        return Element(tag, self.source, line, attributes)

    def fields(self, node: Node, what: str) -> Iterator[tuple[str, Node]]:
        """Return the keys and values of a mapping; nothing is an empty one."""
        if node.is_nothing:
            return
        if not isinstance(node.value, dict):
            reason = f"{what}: expected names and values"
            raise self.error(node.line, reason, "for example  name: value")
        for name, value in node.value.items():
            self.values += 1
            if self.values > _MOST_VALUES:
                raise self.error(value.key_line, f"more than {_MOST_VALUES} values")
            yield name, value

    def items(self, node: Node, what: str) -> list[Node]:
        """Return the elements of a list; nothing is an empty one."""
        if node.is_nothing:
            return []
        if not isinstance(node.value, list):
            reason = f"{what}: expected a list"
            raise self.error(node.line, reason, "begin each of its parts with '- '")
        self.values += len(node.value)
        return node.value

    def text(self, node: Node, what: str) -> str:
        if not isinstance(node.value, str):
            raise self.error(node.line, f"{what}: expected one word or number")
        return "" if node.is_nothing else node.value


def read_yaml(text: str, source: str) -> Element:
    """Return the root of a file."""
    root = read_file(text, source)
    if root is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    return _block(_Document(source), "launch", root, (), 0)


def _block(document: _Document, tag: str, node: Node, own: Collection[str], depth: int) -> Element:
    """Return a file or a group: its keys in the order in which they take effect."""
    if depth > DEEPEST:
        raise document.error(node.line, f"nested more than {DEEPEST} levels deep")
    what = "the file" if tag == "launch" else tag
    element = document.element(tag, node.line)
    found: dict[str, list[Element]] = {name: [] for name in _FIRST}
    for name, value in document.fields(node, what):
        if name in own:
            element.attributes[name] = document.text(value, name)
        elif name in ("groups", "group"):
            found["groups"] = [
                _block(document, "group", item, _GROUP, depth + 1)
                for item in document.items(value, name)
            ]
        elif name in _PARTS:
            found[name] = _PARTS[name](document, value)
        else:
            raise document.unknown(value, name, what, {*own, *_PARTS, "groups"})
    element.children = [child for children in found.values() for child in children]
    return element


def _nodes(document: _Document, node: Node) -> list[Element]:
    return [_node(document, item) for item in document.items(node, "nodes")]


def _node(document: _Document, node: Node) -> Element:
    element = document.element("node", node.line, output="both")
    for name, value in document.fields(node, "a node"):
        if name == "args" and isinstance(value.value, list):
            words = [document.text(word, "args") for word in value.value]
            text = " ".join(f"'{word}'" if " " in word else word for word in words)
            element.attributes["args"] = text
        elif name in _NODE:
            key = name.replace("launch_prefix", "launch-prefix")
            element.attributes[key] = document.text(value, name)
        elif name in _NODE_PARTS:
            element.children += _NODE_PARTS[name](document, value)
        else:
            raise document.unknown(value, name, "a node", {*_NODE, *_NODE_PARTS})
    if not {"run", "exec"} & set(element.attributes):
        raise document.error(node.line, "'run' is missing in a node", "for example  run: talker")
    return element


def _arguments(document: _Document, node: Node) -> list[Element]:
    found = []
    for name, value in document.fields(node, "args"):
        element = document.element("arg", value.key_line, name=name)
        if isinstance(value.value, dict):
            for part, text in document.fields(value, name):
                if part not in ("default", "value", "doc"):
                    raise document.unknown(text, part, name, {"default", "value", "doc"})
                element.attributes[part] = document.text(text, part)
        elif not value.is_nothing:
            element.attributes["default"] = document.text(value, name)
        found.append(element)
    return found


def _pairs(tag: str, first: str, second: str) -> _Part:
    def read(document: _Document, node: Node) -> list[Element]:
        found = []
        for name, value in document.fields(node, tag):
            pair = {first: name, second: document.text(value, name)}
            found.append(document.element(tag, value.key_line, **pair))
        return found

    return read


def _private_parameters(document: _Document, node: Node, path: str = "~") -> list[Element]:
    """Return the parameters of the nodes below; in groups, all of them."""
    found: list[Element] = []
    for name, value in document.fields(node, "param"):
        if isinstance(value.value, dict):
            found += _private_parameters(document, value, f"{path}{name}/")
        else:
            text = _flow(document, value)
            found.append(document.element("param", value.key_line, name=path + name, value=text))
    return found


def _flow(document: _Document, node: Node) -> str:
    """Return a value as YAML in one line; what was quoted stays text."""
    if isinstance(node.value, list):
        return f"[{', '.join(_flow(document, part) for part in document.items(node, 'param'))}]"
    text = document.text(node, "param")
    return write_setting(text) if node.is_quoted and "$(" not in text else text


def _includes(document: _Document, node: Node) -> list[Element]:
    is_list = isinstance(node.value, list) or node.is_nothing
    items = document.items(node, "include") if is_list else [node]
    return [_include(document, item) for item in items]


def _include(document: _Document, node: Node) -> Element:
    element = document.element("include", node.line)
    if isinstance(node.value, str) and not node.is_nothing:
        element.attributes["file"] = node.value
        return element
    for name, value in document.fields(node, "include"):
        if name == "args":
            element.children += _pairs("arg", "name", "value")(document, value)
        elif name in _INCLUDE:
            element.attributes[name] = document.text(value, name)
        else:
            raise document.unknown(value, name, "include", {*_INCLUDE, "args"})
    return element


_NODE_PARTS: Mapping[str, _Part] = {
    "remap": _pairs("remap", "from", "to"),
    "param": _private_parameters,
    "env": _pairs("env", "name", "value"),
}
_FIRST = ("args", *_NODE_PARTS)
"""The keys that count for the others wherever they stand."""
_PARTS: Mapping[str, _Part] = {
    "args": _arguments,
    **_NODE_PARTS,
    "include": _includes,
    "nodes": _nodes,
}
