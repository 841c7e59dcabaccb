"""What to type so that a node uses another topic: one flag, or one flag less.

Pure: nodes as they are in, words out.
"""

import re

from lcmtools.doctor.near_names import are_near
from lcmtools.graph.model import Node
from lcmtools.names import base_name_of, namespace_of


def is_legal(channel: str) -> bool:
    """Whether a node can have this channel: names begin with a slash."""
    return re.fullmatch(r"/[A-Za-z0-9_/]*", channel) is not None


def start_with(node: Node, topic: str, target: str) -> str:
    """How to start a node so that it uses another topic in place of one that it uses now."""
    name = base_name_of(topic) if namespace_of(node.name) == namespace_of(topic) else topic
    word = remapped(node, topic)
    if not word:
        return f"{node.name} with {name}:={target}"
    source = word.partition(":=")[0]
    wanted = expanded(target, node)
    if expanded(source, node) != wanted:
        return f"{node.name} with {source}:={target} in place of {word}"
    if are_near(topic, wanted):
        return f"{node.name} without {word}"
    # the other way round was meant
    return f"{node.name} with {name}:={target} in place of {word}"


def advice(publisher: Node, topic: str, target: str) -> str:
    """What lets a node publish on another topic than it does."""
    if publisher.tool:  # a command: its topic is an argument, and no flag changes it
        return f"let it publish on '{expanded(target, publisher)}'"
    if namespace_of(publisher.name) == namespace_of(topic) and base_name_of(topic) == base_name_of(
        target
    ):
        return f"start {publisher.name} with __ns:={namespace_of(target)}"
    return f"start {start_with(publisher, topic, target)}"


def remapped(node: Node, topic: str) -> str:
    """The argument of a node's command line that gave it this topic; "" without."""
    for word in node.command.split():
        source, sign, said = word.partition(":=")
        if sign and said and not source.startswith("_") and expanded(said, node) == topic:
            return word
    return ""


def expanded(name: str, node: Node) -> str:
    """A name as the node's namespace makes it a topic."""
    return name if name.startswith("/") else f"{namespace_of(node.name).rstrip('/')}/{name}"
