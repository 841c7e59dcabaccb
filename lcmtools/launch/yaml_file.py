"""YAML launch files, as elements.

Belongs here: the keys of lcmtools' own format, and their tags. Other keys are refused.

    args: {robot: husky0}                    arguments, defaults; without one, required
    nodes:
      - run: simple_controller               as after lcmtools run
        name: husky_simple_controller
        ns: $(arg robot)
        remap: {controlled_velocity: velocity_cmd}
        param: {kp: 0.5}
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_xml import Element
from lcmtools.formats.strict_yaml import YamlNode, read_file
from lcmtools.launch.parameter_tags import AS_TYPED
from lcmtools.launch.tags import END_OF_WORD
from lcmtools.messages.setting import write_setting
from lcmtools.names import did_you_mean
from lcmtools.ros_words.launch_keys import KEYS

_Parts: TypeAlias = Mapping[str, Callable[[YamlNode], list[Element]]]
"""For each key, the function that converts its value to elements."""

_NODE = (
    *("run", "exec", "name", "ns", "args", "cwd", "output", "respawn", "respawn_delay"),
    *("required", "stdin", "launch_prefix", "if", "unless"),
)
_GROUP = ("ns", "if", "unless")
_INCLUDE = ("file", "ns", "pass_all_args", "if", "unless")
_EXAMPLES = {"a node": "run: talker", "remap": "chatter: news", "param": "kp: 0.5"}
_FIRST = ("args", "remap", "param", "env")  # they apply to the others wherever they stand


def read_yaml(text: str, source: str) -> Element:
    """Return the root of a file."""
    root = read_file(text, source)
    if root is None:
        raise InvalidFile(f"{source}:1: the file is empty")
    reader = _Reader(source)
    return reader.element("launch", root, "the file", (), reader.block_parts())


@dataclass(frozen=True, slots=True)
class _Reader:
    """Makes the elements of one file."""

    source: str

    def element(
        self, tag: str, node: YamlNode, what: str, attributes: Collection[str], parts: _Parts
    ) -> Element:
        """Return the element for a mapping, with its parts in the order of their effect."""
        element = Element(tag, self.source, node.line)
        found: dict[str, list[Element]] = {name: [] for name in _FIRST}
        for name, value in self._fields(node, what):
            if name in attributes:
                key = name.replace("launch_prefix", "launch-prefix")
                read = self._words if name == "args" else self._text
                element.attributes[key] = read(value, name)
            elif name in parts:
                found[name] = parts[name](value)
            else:
                known = {*attributes, *parts} - {"group"}
                listed = f"there are {', '.join(sorted(known))}"
                meant = KEYS.get(name, "")
                hint = f"did you mean {meant}?" if meant.partition(":")[0] in known else ""
                hint = hint or did_you_mean(name, known) or listed
                raise self._error(value.key_line, f"there is no key '{name}' in {what}", hint)
        element.children = [child for children in found.values() for child in children]
        return element

    def block_parts(self) -> _Parts:
        """Return the conversions for the keys of a file or a group."""
        return {
            **self._node_parts(),
            "args": self._arguments,
            "include": self._includes,
            "nodes": lambda node: [self._node(item) for item in self._items(node, "nodes")],
            "groups": self._groups,
            "group": self._groups,
        }

    def _node_parts(self) -> _Parts:
        return {
            "remap": partial(self._pairs, "remap", "from", "to"),
            "param": self._private_parameters,
            "env": partial(self._pairs, "env", "name", "value"),
        }

    def _groups(self, node: YamlNode) -> list[Element]:
        items = self._items(node, "groups")
        return [self.element("group", item, "group", _GROUP, self.block_parts()) for item in items]

    def _node(self, node: YamlNode) -> Element:
        element = self.element("node", node, "a node", _NODE, self._node_parts())
        if not {"run", "exec"} & set(element.attributes):
            raise self._error(node.line, "'run' is missing in a node", "for example  run: talker")
        element.attributes.setdefault("output", "both")
        return element

    def _arguments(self, node: YamlNode) -> list[Element]:
        found = []
        for name, value in self._fields(node, "args"):
            if isinstance(value.value, dict):
                element = self.element("arg", value, name, ("default", "value", "doc"), {})
                element.line = value.key_line
            else:
                element = Element("arg", self.source, value.key_line)
                if not value.is_nothing:
                    element.attributes["default"] = self._text(value, name)
            element.attributes["name"] = name
            found.append(element)
        return found

    def _pairs(self, tag: str, first: str, second: str, node: YamlNode) -> list[Element]:
        found = []
        for name, value in self._fields(node, tag):
            pair = {first: name, second: self._text(value, name)}
            found.append(Element(tag, self.source, value.key_line, pair))
        return found

    def _private_parameters(self, node: YamlNode, path: str = "~") -> list[Element]:
        """Return the private parameters of the nodes below, also from nested mappings."""
        found: list[Element] = []
        for name, value in self._fields(node, "param"):
            if isinstance(value.value, dict):
                found += self._private_parameters(value, f"{path}{name}/")
            else:
                pair = {"name": path + name, "value": self._flow(value), "type": AS_TYPED}
                found.append(Element("param", self.source, value.key_line, pair))
        return found

    def _flow(self, node: YamlNode) -> str:
        """Return a value as one line of YAML; quoted values stay text."""
        if isinstance(node.value, list):
            return f"[{', '.join(self._flow(part) for part in node.value)}]"
        text = self._text(node, "param")
        return write_setting(text) if node.is_quoted and "$(" not in text else text

    def _includes(self, node: YamlNode) -> list[Element]:
        if isinstance(node.value, list) or node.is_nothing:
            return [self._include(item) for item in self._items(node, "include")]
        return [self._include(node)]

    def _include(self, node: YamlNode) -> Element:
        if isinstance(node.value, str) and not node.is_nothing:
            return Element("include", self.source, node.line, {"file": node.value})
        parts = {"args": partial(self._pairs, "arg", "name", "value")}
        return self.element("include", node, "include", _INCLUDE, parts)

    def _fields(self, node: YamlNode, what: str) -> Iterator[tuple[str, YamlNode]]:
        """Return the keys and values of a mapping; nothing counts as an empty one."""
        if isinstance(node.value, dict):
            yield from node.value.items()
        elif not node.is_nothing:
            hint = f"for example  {_EXAMPLES.get(what, 'name: value')}"
            raise self._error(node.line, f"{what}: expected names and values", hint)

    def _items(self, node: YamlNode, what: str) -> list[YamlNode]:
        """Return the elements of a list; nothing counts as an empty one."""
        if isinstance(node.value, list):
            return node.value
        if node.is_nothing:
            return []
        hint = "begin each of its parts with '- '"
        raise self._error(node.line, f"{what}: expected a list", hint)

    def _words(self, node: YamlNode, what: str) -> str:
        """Return a text of words, or the elements of a list, each as one word."""
        if not isinstance(node.value, list):
            return self._text(node, what)
        return "".join(f"{self._text(word, what)}{END_OF_WORD}" for word in node.value)

    def _text(self, node: YamlNode, what: str) -> str:
        if not isinstance(node.value, str):
            raise self._error(node.line, f"{what}: expected one word or number")
        return "" if node.is_nothing else node.value

    def _error(self, line: int, reason: str, hint: str = "") -> InvalidFile:
        return InvalidFile(f"{self.source}:{line}: {reason}", hint)
