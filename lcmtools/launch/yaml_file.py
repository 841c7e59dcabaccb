"""YAML launch files, as elements.

Belongs here: the keys of our own form, and which tags they mean. Others are refused.

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

import yaml  # noqa: TID253 - the one reader that is for YAML only

from lcmtools.errors import InvalidFile
from lcmtools.launch.element import DEEPEST, Element
from lcmtools.messages.setting import write_setting
from lcmtools.names import did_you_mean

_Part: TypeAlias = "Callable[[_Document, yaml.Node], list[Element]]"

_NODE = {
    **{key: key for key in ("run", "exec", "name", "ns", "args", "cwd", "output", "respawn")},
    **{key: key for key in ("required", "stdin", "if", "unless")},
    "respawn_delay": "respawn_delay",
    "launch_prefix": "launch-prefix",
}
_GROUP = {key: key for key in ("ns", "if", "unless")}
_INCLUDE = {key: key for key in ("file", "ns", "pass_all_args", "if", "unless")}
_MOST_VALUES = 100_000
"""Values of a file, those that aliases repeat counted."""


@dataclass(frozen=True, slots=True)
class _Document:
    """Makes the elements of one file."""

    source: str
    counted: list[int]

    def error(self, node: yaml.Node, reason: str, hint: str = "") -> InvalidFile:
        return InvalidFile(f"{self.source}:{node.start_mark.line + 1}: {reason}", hint)

    def element(self, tag: str, node: yaml.Node, **attributes: str) -> Element:
        return Element(tag, self.source, node.start_mark.line + 1, attributes)

    def fields(self, node: yaml.Node, what: str) -> Iterator[tuple[yaml.Node, str, yaml.Node]]:
        """The keys and values of a mapping; nothing is an empty one."""
        if _is_nothing(node):
            return
        if not isinstance(node, yaml.MappingNode):
            raise self.error(node, f"{what}: expected names and values", "for example  name: value")
        seen: set[str] = set()
        for key, value in node.value:
            self.counted[0] += 1
            if self.counted[0] > _MOST_VALUES:
                raise self.error(key, f"more than {_MOST_VALUES} values")
            name = self.text(key, what)
            if name in seen:
                raise self.error(key, f"'{name}' is given twice in {what}")
            seen.add(name)
            yield key, name, value

    def items(self, node: yaml.Node, what: str) -> list[yaml.Node]:
        """The elements of a list; nothing is an empty one."""
        if _is_nothing(node):
            return []
        if not isinstance(node, yaml.SequenceNode):
            raise self.error(node, f"{what}: expected a list", "begin each of its parts with '- '")
        self.counted[0] += len(node.value)
        return list(node.value)

    def text(self, node: yaml.Node, what: str) -> str:
        if not isinstance(node, yaml.ScalarNode):
            raise self.error(node, f"{what}: expected one word or number")
        return "" if _is_nothing(node) else str(node.value)


def read_yaml(text: str, source: str) -> Element:
    """The root of a file.

    Raises:
        InvalidFile: It is no YAML, or a key or value is wrong; with the line.
    """
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 1
        reason = f"not YAML: {error.problem or error.context}"
        hint = "indent the keys of one entry alike" if "block" in reason else ""
        raise InvalidFile(f"{source}:{line}: {reason}", hint) from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise InvalidFile(f"{source}:{line}: not YAML: {error.reason}") from None
    except RecursionError:
        raise InvalidFile(f"{source}: nested too deeply") from None
    if root is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    return _block(_Document(source, [0]), "launch", root, {}, 0)


def _block(
    document: _Document, tag: str, node: yaml.Node, own: Mapping[str, str], depth: int
) -> Element:
    """A file or a group: its keys in the order in which they count."""
    if depth > DEEPEST:
        raise document.error(node, f"nested more than {DEEPEST} levels deep")
    what = "the file" if tag == "launch" else tag
    attributes: dict[str, str] = {}
    found: dict[str, list[Element]] = {}
    for key, name, value in document.fields(node, what):
        if name in own:
            attributes[own[name]] = document.text(value, name)
        elif name in ("groups", "group"):
            found["groups"] = [
                _block(document, "group", item, _GROUP, depth + 1)
                for item in document.items(value, name)
            ]
        elif name in _PARTS:
            found[name] = _PARTS[name](document, value)
        else:
            raise document.error(key, *_unknown(name, what, {*own, *_PARTS, "groups"}))
    order = (*(name for name in _PARTS if name in _FIRST), *found)
    children = [child for name in dict.fromkeys(order) for child in found.get(name, [])]
    return Element(tag, document.source, node.start_mark.line + 1, attributes, tuple(children))


def _nodes(document: _Document, node: yaml.Node) -> list[Element]:
    return [_node(document, item) for item in document.items(node, "nodes")]


def _node(document: _Document, node: yaml.Node) -> Element:
    attributes = {"output": "both"}
    children: list[Element] = []
    for key, name, value in document.fields(node, "a node"):
        if name == "args" and isinstance(value, yaml.SequenceNode):
            words = [document.text(word, "args") for word in value.value]
            attributes["args"] = " ".join(f"'{word}'" if " " in word else word for word in words)
        elif name in _NODE:
            attributes[_NODE[name]] = document.text(value, name)
        elif name in _NODE_PARTS:
            children += _NODE_PARTS[name](document, value)
        else:
            raise document.error(key, *_unknown(name, "a node", {*_NODE, *_NODE_PARTS}))
    if not {"run", "exec"} & set(attributes):
        raise document.error(node, "'run' is missing in a node", "for example  run: talker")
    line = node.start_mark.line + 1
    return Element("node", document.source, line, attributes, tuple(children))


def _arguments(document: _Document, node: yaml.Node) -> list[Element]:
    found = []
    for key, name, value in document.fields(node, "args"):
        about = {"name": name}
        if isinstance(value, yaml.MappingNode):
            for inner, part, text in document.fields(value, name):
                if part not in ("default", "value", "doc"):
                    raise document.error(inner, *_unknown(part, name, {"default", "value", "doc"}))
                about[part] = document.text(text, part)
        elif not _is_nothing(value):
            about["default"] = document.text(value, name)
        found.append(document.element("arg", key, **about))
    return found


def _pairs(tag: str, first: str, second: str) -> _Part:
    def read(document: _Document, node: yaml.Node) -> list[Element]:
        return [
            document.element(tag, key, **{first: name, second: document.text(value, name)})
            for key, name, value in document.fields(node, tag)
        ]

    return read


def _private_parameters(document: _Document, node: yaml.Node) -> list[Element]:
    """Parameters of the nodes below; in groups, all of them."""
    return [
        document.element("param", key, name=f"~{name}", value=text)
        for key, name, text in _leaves(document, node, "", 0)
    ]


def _leaves(
    document: _Document, node: yaml.Node, path: str, depth: int
) -> Iterator[tuple[yaml.Node, str, str]]:
    if depth > DEEPEST:
        raise document.error(node, f"nested more than {DEEPEST} levels deep")
    for key, name, value in document.fields(node, "param"):
        full = f"{path}/{name}" if path else name
        if isinstance(value, yaml.MappingNode):
            yield from _leaves(document, value, full, depth + 1)
        else:
            yield key, full, _flow(document, value, depth)


def _flow(document: _Document, node: yaml.Node, depth: int) -> str:
    """A value as YAML in one line; what was quoted stays text."""
    if depth > DEEPEST:
        raise document.error(node, f"nested more than {DEEPEST} levels deep")
    if isinstance(node, yaml.SequenceNode):
        parts = [_flow(document, part, depth + 1) for part in document.items(node, "param")]
        return f"[{', '.join(parts)}]"
    text = document.text(node, "param")
    is_quoted = getattr(node, "style", None) is not None
    return write_setting(text) if is_quoted and "$(" not in text else text


def _includes(document: _Document, node: yaml.Node) -> list[Element]:
    is_list = isinstance(node, yaml.SequenceNode) or _is_nothing(node)
    items = document.items(node, "include") if is_list else [node]
    return [_include(document, item) for item in items]


def _include(document: _Document, node: yaml.Node) -> Element:
    if isinstance(node, yaml.ScalarNode):
        return document.element("include", node, file=document.text(node, "include"))
    attributes: dict[str, str] = {}
    children: list[Element] = []
    for key, name, value in document.fields(node, "include"):
        if name == "args":
            children += _pairs("arg", "name", "value")(document, value)
        elif name in _INCLUDE:
            attributes[_INCLUDE[name]] = document.text(value, name)
        else:
            raise document.error(key, *_unknown(name, "include", {*_INCLUDE, "args"}))
    line = node.start_mark.line + 1
    return Element("include", document.source, line, attributes, tuple(children))


_NODE_PARTS: Mapping[str, _Part] = {
    "remap": _pairs("remap", "from", "to"),
    "param": _private_parameters,
    "env": _pairs("env", "name", "value"),
}
_PARTS: Mapping[str, _Part] = {
    "args": _arguments,
    **_NODE_PARTS,
    "include": _includes,
    "nodes": _nodes,
}
_FIRST = {"args", *_NODE_PARTS}
"""The keys that count for the others wherever they stand."""


def _unknown(name: str, what: str, known: Collection[str]) -> tuple[str, str]:
    hint = did_you_mean(name, known) or f"there are {', '.join(sorted(known))}"
    return f"there is no key '{name}' in {what}", hint


def _is_nothing(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and str(node.tag).endswith(":null")
