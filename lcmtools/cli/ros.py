"""Commands and options of ROS and catkin, and their replacements.

Imported only if a command or an option is unknown.
"""

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from lcmtools.cli.output import write_note
from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools.ros_words.commands import COMMANDS, NO_BUILD, NOT_MESSAGES, OPTIONS, PREFIXES


def _create_package(words: Sequence[str]) -> list[str]:
    """Translate catkin_create_pkg NAME roscpp rospy std_msgs; keep dependencies with messages."""
    from lcmtools.messages.registry import packages

    name, *others = [word for word in words if not word.startswith("-")] or [""]
    known = [word for word in others if word in packages()]
    if unknown := [word for word in others if word not in (*known, *NOT_MESSAGES)]:
        write_note(f"lcmtools pkg create: no messages in {', '.join(unknown)}, which is left out")
    return ["pkg", "create", *([name] if name else []), *(["--deps", *known] if known else [])]


def _build(words: Sequence[str]) -> list[str]:
    """Translate catkin build NAME and catkin_make, without the compiler's options."""
    names = [word for word in words if word[:1].isalpha()]
    return ["pkg", "build", *names[:1]]


def _catkin(words: Sequence[str]) -> list[str]:
    verb, rest = words[0] if words else "", words[1:]
    if verb == "build":
        return _build(rest)
    if verb == "create":  # catkin create pkg NAME
        return _create_package(rest[1:])
    raise UsageError(f"a workspace needs no catkin {verb}".rstrip(), NO_BUILD)


def _run(words: Sequence[str]) -> list[str]:
    """Translate rosrun PACKAGE NODE. A missing package may be ROS's, with a node of lcmtools."""
    from lcmtools.packages.runnable_nodes import OWN, runnables

    known = runnables(Path.cwd())
    if len(words) < 2 or words[0] in {node.package for node in known}:  # noqa: PLR2004 - both
        return ["run", *words]
    _, name, *rest = words
    if name in {node.name for node in known if node.package == OWN}:
        return ["run", name, *rest]
    found = _INSTEAD.get(name.removesuffix(".py"))
    return ["run", *words] if found is None else _replaced(name, found, rest)


def _ros2(words: Sequence[str]) -> list[str]:
    """Translate ros2 run PACKAGE NODE --ros-args -r a:=b; remaps need no --ros-args here."""
    if list(words[:1]) == ["run"]:
        return _run([word for word in words[1:] if word != "--ros-args"])
    return list(words) or ["help"]


def _image_view(words: Sequence[str]) -> list[str]:
    """Translate rqt_image_view TOPIC; the words after the topic are the node's."""
    is_topic = bool(words) and not words[0].startswith("-") and ":=" not in words[0]
    return ["run", "image_view", *([f"image:={words[0]}"] if is_topic else []), *words[is_topic:]]


Instead = str | tuple[str, ...] | Callable[[Sequence[str]], list[str]]
"""A hint, the words of the replacement, or a function that translates the following words."""

_INSTEAD: Mapping[str, Instead] = {
    **COMMANDS,
    "catkin": _catkin,
    "catkin_create_pkg": _create_package,
    "catkin_make": _build,
    "catkin_make_isolated": _build,
    "colcon": lambda words: _build(words[1:]),
    "image_view": _image_view,
    "ros2": _ros2,
    "rosrun": _run,
    "rqt_image_view": _image_view,
}


def instead(group: str, words: Sequence[str]) -> list[str]:
    """Return the words that replace a command of ROS, or [] for other commands.

    ``group`` is the one that it is typed in, such as "param"; "" for ``lcmtools`` itself.

    Raises:
        UsageError: There is no such command here; with what takes its place.
    """
    name, *rest = words
    found = _INSTEAD.get(f"{group} {name}".strip())
    if found is None:
        if group or not name.startswith(PREFIXES):
            return []
        found = did_you_mean(name, _INSTEAD) or "lcmtools --help lists the commands"
    replaced = _replaced(name, found, rest)
    write_note(f"{name} is here: lcmtools {shlex.join(replaced)}")
    return replaced


def _replaced(name: str, found: Instead, rest: Sequence[str]) -> list[str]:
    if isinstance(found, str):
        raise UsageError(f"no such command '{name}'", found)
    return [*found, *rest] if isinstance(found, tuple) else found(rest)


def option_instead(command: str, name: str) -> str:
    """Return a hint about the replacement of an option of ROS, or "" for other options.

    Args:
        command: The command that it was typed for, such as "lcmtools topic hz".
        name: The option, such as "--tcpnodelay".
    """
    family = name if not name.startswith("--qos") else "--qos"
    return OPTIONS.get(f"{command.partition(' ')[2]} {name}") or OPTIONS.get(family, "")
