"""A node's command line: names, parameters and the bus.

They can be written as in ROS (``__ns:=/husky0 a:=b _gain:=2.0``) or as flags (``--ns /husky0
--remap a:=b --param gain:=2.0``). This module extracts them from an argument list, and creates
argument lists. Must not know nodes or the environment.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from lcmtools.errors import UsageError

# ROS's remapping arguments, and parameters with dots in their names as in ROS 2.
# Everything else stays in the argument list.
_ASSIGNMENT = re.compile(
    r"([~/A-Za-z_][A-Za-z0-9_/]*|_[A-Za-z][A-Za-z0-9_/.]*):=(.*)", re.ASCII | re.DOTALL
)
# Misspelt assignments: with spaces, or with only one of the two signs.
_MISSPELT = re.compile(
    r"([~/A-Za-z_][A-Za-z0-9_/]*)(?:=|:|:=|=:|==)([^:=].*)", re.ASCII | re.DOTALL
)
_FIELDS = {"--ns": "namespace", "--name": "name", "--lcm-url": "lcm_url", "--domain": "domain"}
_FLAGS = (*_FIELDS, "--param", "--remap", "-r")
# ROS's special keys that mean nothing with LCM; accepted so that old command lines work.
_IGNORED_SPECIALS = ("__log", "__ip", "__hostname", "__master")


class NodeArguments(NamedTuple):
    """The names, parameters and bus in a node's command line; None for those not given."""

    namespace: str | None = None
    name: str | None = None
    remaps: tuple[tuple[str, str], ...] = ()  # (from, to) as written
    parameters: Mapping[str, str] = MappingProxyType({})  # private, name to YAML text
    lcm_url: str | None = None
    domain: str | None = None

    def words(self) -> list[str]:
        """Return the command line for these arguments; the inverse of ``split_arguments``."""
        specials = {"__ns": self.namespace, "__name": self.name}
        flags = {"--lcm-url": self.lcm_url, "--domain": self.domain}
        pairs = [
            *((key, value) for key, value in specials.items() if value),
            *self.remaps,
            *((f"_{name}", text) for name, text in self.parameters.items()),
        ]
        words = [word for flag, value in flags.items() if value for word in (flag, value)]
        return words + [f"{source}:={target}" for source, target in pairs]


def split_arguments(arguments: Sequence[str]) -> tuple[NodeArguments, list[str]]:
    """Split an argument list, without the program's name, into naming and other arguments.

    All arguments after ``--`` are the node's own. UsageError is raised for a flag without a value
    and for an unknown ``__special:=``.
    """
    said = NodeArguments()
    rest: list[str] = []
    words = iter(arguments)
    for word in words:
        if word == "--":
            rest += [word, *words]
            break
        flag, equals, value = word.partition("=")
        if flag in _FLAGS and (equals or word == flag):
            said = _with_flag(said, flag, value if equals else _next_value(flag, words))
        elif assignment := _ASSIGNMENT.fullmatch(word):
            said = _with_assignment(said, *assignment.groups())
        else:
            rest.append(word)
    return said, rest


def is_assignment(word: str) -> bool:
    """Return True for an assignment as in ROS: "a:=b", "__ns:=/husky0", "_gain:=2.0"."""
    return _ASSIGNMENT.fullmatch(word) is not None


def misspelt(words: Sequence[str], unknown: str, *, of_node: bool = True) -> str:
    """Return the hint for a misspelt assignment; "" for other words.

    Args:
        words: The command line.
        unknown: The unknown word in it: "a=b", or a part of "a := b".
        of_node: Read a value that is not a name as a parameter's; launches have no parameters.
    """
    if unknown == "--ros-args":
        return "names and remaps need none: leave it out"
    place = list(words).index(unknown)
    before = words[place - 1] if place else ""
    rest = list(words[place : place + 3])
    if before.endswith(":="):
        rest[:0] = [before]
    for count in range(1, len(rest) + 1):
        parts = rest[:count]
        if not all(map(_belong_together, parts, parts[1:])):
            break  # two separate words
        if match := _MISSPELT.fullmatch("".join(parts)):
            name, value = match.groups()
            is_topic = not of_node or name[0] in "_~/" or value[0].isalpha() or value[0] in "_~/"
            return f"did you mean {name if is_topic else f'_{name}'}:={value}?"
    return ""


def _belong_together(left: str, right: str) -> bool:
    """Return True for two adjacent parts of an assignment, as in "a :=" or "= b"."""
    has_sign = left[-1:] in (":", "=") or right[:1] in (":", "=")
    return has_sign and not is_assignment(right) and not right.startswith("--")


def looks_special(word: str) -> bool:
    """Return True for a word that can only be a naming argument: "__ns=/husky0", ":=b"."""
    return ":=" in word or bool(re.match(r"__[a-z]+[:=]", word))


def _next_value(flag: str, words: Iterator[str]) -> str:
    value = next(words, None)
    if value is None:
        raise UsageError(f"{flag} needs a value", _EXAMPLES[flag])
    return value


def _with_flag(said: NodeArguments, flag: str, value: str) -> NodeArguments:
    if flag in _FIELDS:
        field: dict[str, Any] = {_FIELDS[flag]: value}
        return said._replace(**field)
    bare = value.lstrip("~/_")
    is_parameter = flag == "--param" and bare[:1].isalpha()
    assignment = _ASSIGNMENT.fullmatch(f"_{bare}" if is_parameter else value)
    if not assignment:
        raise UsageError(f"{flag} {value}: expected two names with := between", _EXAMPLES[flag])
    return _with_assignment(said, *assignment.groups())


def _with_assignment(said: NodeArguments, key: str, value: str) -> NodeArguments:
    """Return the arguments with ``key:=value`` added; like ROS, ignore an empty value."""
    if key in _IGNORED_SPECIALS or not value:
        return said
    if key == "__ns":
        return said._replace(namespace=value)
    if key in ("__name", "__node"):
        return said._replace(name=value)
    if key.startswith("__"):
        what = f"{key}:={value}: there is no such special name"
        raise UsageError(what, "the special names: __ns, __name")
    if key.startswith("_"):
        return said._replace(parameters={**said.parameters, key[1:]: value})
    return said._replace(remaps=(*said.remaps, (key, value)))


_EXAMPLES = {
    "--ns": "for example --ns /husky0",
    "--name": "for example --name driver",
    "--param": "for example --param gain:=2.0",
    "--remap": "for example --remap controlled_velocity:=velocity_cmd",
    "-r": "for example -r controlled_velocity:=velocity_cmd",
    "--lcm-url": "for example --lcm-url 'udpm://239.255.76.67:7667?ttl=0'",
    "--domain": "for example --domain 3",
}
