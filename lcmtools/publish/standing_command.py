"""Commands to actuators that remain in effect after the program that sent them has ended.

Pure decisions on the graph and on messages.
"""

import re
from copy import deepcopy
from shlex import quote
from typing import NamedTuple

from lcmtools.formats.strict_json import write_json
from lcmtools.graph.model import Graph, NodeInfo
from lcmtools.messages.codec import encode
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.plain import cells, to_plain
from lcmtools.messages.registry import Message
from lcmtools.observe.actuators import JOINTS, VELOCITY_TYPES, is_command_topic
from lcmtools.observe.simulators import is_simulator

_NO_MOTION = re.compile(
    r"(?:^|[._])(?:u?time(?:stamp|out)?|stamp|duration|dt|[num]?secs?"
    r"|u?id|index|name|num|number|count(?:er)?|seq(?:uence|num|no|nr)?)(?:[._]|$)|(?:^|[.])t$"
)
"""Words of names of times, sequence numbers, counts and names."""
_CAPITAL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")  # in robotId
_INDEX = re.compile(r"\d+\b")
_MOST_VALUES = 3  # values of a command that are shown


class StandingCommand(NamedTuple):
    """A command that is obeyed until another one arrives."""

    topic: str
    values: str  # the non-zero ones, "linear.x 0.5"; "" for none
    stop: bytes | None = None  # the same with zeros, if that means stop
    typed: str = ""  # the command line that sends it

    @property
    def said(self) -> str:
        """The command, as a sentence."""
        return f"the last command on {self.topic} was {self.values}"

    @property
    def lasting(self) -> str:
        """The sentence with its consequence and the remedy."""
        hint = f"; to stop: {self.typed}" if self.typed else ""
        return f"{self.said}, and remains in effect until another one comes{hint}"


def obeying(graph: Graph, topic: str, kind: str) -> list[NodeInfo]:
    """Return the living nodes that would obey a topic's messages of a type as commands."""
    nodes = {node.id: node for node, _ in graph.topic(topic).subscribers}
    commands = is_command_topic(topic, kind)
    return [
        node
        for node in nodes.values()
        if not (node.stale or node.tool) and (commands or is_simulator(node))
    ]


def standing_command(topic: str, kind: str, message: Message) -> StandingCommand:
    """Return the command that a topic's last message, of this type, leaves in effect."""
    flat = {name.strip("."): value for name, value in cells(to_plain(message), "").items()}
    moving = [
        f"{name} {value:g}"
        for name, value in flat.items()
        if isinstance(value, (int, float)) and value and _is_motion(name)
    ]
    more = ", ..." if len(moving) > _MOST_VALUES else ""
    values = ", ".join(moving[:_MOST_VALUES]) + more
    is_joints = kind == JOINTS and not any(name.startswith("position") for name in flat)
    if not (is_joints or kind in VELOCITY_TYPES):
        return StandingCommand(topic, values)
    zero = deepcopy(message)
    _set_to_zero(zero)
    stop = {k: v for k, v in to_plain(zero).items() if v and k != "header"} if is_joints else {}
    plain = "" if topic.startswith("/") else " --plain-channel"
    typed = f"lcmtools pub -1{plain} {quote(topic)} {kind} '{write_json(stop)}'"
    return StandingCommand(topic, values, encode(zero), typed)


def _is_motion(path: str) -> bool:
    """Return False for a field that names or counts a command or dates it: ``utime``, ``seq``."""
    names = _INDEX.sub("", _CAPITAL.sub("_", path)).lower()
    return not _NO_MOTION.search(names) and not names.startswith("header.")


def _set_to_zero(message: Message) -> None:
    """Set all numbers of a message to zero except in its header."""
    for field in visible_fields(type(message)):
        value = getattr(message, field.attribute)
        if field.dimensions == () and field.message_class:
            if field.type != "std_msgs/Header":
                _set_to_zero(value)
        elif not field.dimensions and isinstance(value, (int, float)):
            setattr(message, field.attribute, type(value)(0))
        elif field.depth == 1 and field.type.startswith(("float", "int")):
            setattr(message, field.attribute, [0] * len(value))
