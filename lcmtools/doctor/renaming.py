"""Names that nearly agree, and the argument that gives a node's topic another name.

Pure: nodes as they are in, remedies out.
"""

import re
from dataclasses import replace

from lcmtools.doctor.findings import Observed, Part, Statement, state
from lcmtools.graph.model import Node
from lcmtools.names import base_name_of, namespace_of

_SHORT = 4  # characters: names this short are near each other by chance


def are_near(one: str, other: str) -> bool:
    """Return whether two names are equal but for case, slashes, spaces or one character.

    Names that differ only in their numbers mean different things (/husky0, /husky1).
    """
    if re.sub(r"[0-9]+", "0", one) == re.sub(r"[0-9]+", "0", other):
        return False
    first, second = (re.sub(r"[\s/_]", "", name).casefold() for name in (one, other))
    if first == second:
        return True
    return min(len(first), len(second)) > _SHORT and _is_one_change(first, second)


def _is_one_change(one: str, other: str) -> bool:
    """Return whether one character more, less or changed, or two swapped, are the difference."""
    if len(one) > len(other):
        one, other = other, one
    start = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), len(one))
    if len(one) == len(other):
        swapped = one[start : start + 2][::-1] + one[start + 2 :]
        return one[start + 1 :] == other[start + 1 :] or swapped == other[start:]
    return one[start:] == other[start + 1 :]


def is_legal(channel: str) -> bool:
    """Return whether a node can have this channel: names begin with a slash."""
    return re.fullmatch(r"/[A-Za-z0-9_/]*", channel) is not None


def because(remedy: Statement, reason: str, **parts: Part | Observed) -> Statement:
    """Give a remedy its reason."""
    known = state("", because=reason, **parts).parts
    return replace(remedy, parts={**known, **remedy.parts})


def start_with(node: Node, topic: str, target: str) -> Statement:
    """Start a node so that it uses another topic in place of one that it uses now."""
    name = base_name_of(topic) if namespace_of(node.name) == namespace_of(topic) else topic
    argument = remap_argument(node, topic)
    if not argument:
        return state("remap", node=node, old=name, new=target)
    source = argument.partition(":=")[0]
    wanted = expanded(target, node)
    if expanded(source, node) != wanted:
        return state("replace-remap", node=node, old=source, new=target, argument=argument)
    if are_near(topic, wanted):
        return state("drop-remap", node=node, argument=argument)
    # the other way round was meant
    return state("replace-remap", node=node, old=name, new=target, argument=argument)


def publish_on(publisher: Node, topic: str, target: str) -> Statement:
    """Let a node publish on another topic than it does."""
    if publisher.tool:  # a command: its topic is an argument, and no remap changes it
        return state("republish", topic=expanded(target, publisher))
    space = namespace_of(target)
    if namespace_of(publisher.name) == namespace_of(topic) and base_name_of(topic) == base_name_of(
        target
    ):
        return state("namespace", node=publisher, namespace=space)
    return start_with(publisher, topic, target)


def remap_argument(node: Node, topic: str) -> str:
    """The argument of a node's command line that gave it this topic; "" if there is none."""
    for word in node.command.split():
        source, sign, target = word.partition(":=")
        if sign and target and not source.startswith("_") and expanded(target, node) == topic:
            return word
    return ""


def expanded(name: str, node: Node) -> str:
    """The topic that a name means in a node's namespace."""
    return name if name.startswith("/") else f"{namespace_of(node.name).rstrip('/')}/{name}"
