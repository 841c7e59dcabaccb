"""Commands and options of ROS and catkin, and their replacements.

Imported only if a command or an option is unknown.
"""

import os
import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from lcmtools.cli.output import write_note
from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools.ros_words.commands import (
    COMMANDS,
    LANGUAGES,
    NO_BUILD,
    NOT_MESSAGES,
    OPTIONS,
    PACKAGE_OPTIONS,
    PREFIXES,
)
from lcmtools.ros_words.nodes import PACKAGES


def _create_package(words: Sequence[str]) -> list[str]:
    """Translate catkin_create_pkg NAME roscpp rospy std_msgs; keep dependencies with messages.

    Options of ros2 pkg create, too: --build-type ament_python, --node-name drive. The package is in
    C++ if that is the only language named.
    """
    from lcmtools.messages.registry import packages

    plain, kept, folder = _package_options(words)
    name, *others = plain or [""]
    known = [word for word in others if word in packages()]
    if unknown := [word for word in others if word not in (*known, *NOT_MESSAGES)]:
        write_note(f"lcmtools pkg create: no messages in {', '.join(unknown)}, which is left out")
    named = [word for word in (name, folder) if word]
    languages = {LANGUAGES.get(word.rpartition("=")[2]) for word in words} - {None}
    kept += ["--cpp"] if languages == {"C++"} else []
    return ["pkg", "create", *named, *kept, *(["--deps", *known] if known else [])]


def _package_options(words: Sequence[str]) -> tuple[list[str], list[str], str]:
    """Return the words that are no options, the options that lcmtools has, and the folder."""
    plain, kept, folder = [], [], ""
    rest = iter(words)
    for word in rest:
        option, equals, value = word.partition("=")
        if not word.startswith("-"):
            plain.append(word)
        elif option in PACKAGE_OPTIONS:
            value = value if equals else next(rest, "")
            meant = PACKAGE_OPTIONS[option]
            folder = value if meant == "DIR" else folder
            kept += [meant, value] if meant.startswith("--") else []
    return plain, kept, folder


def _build(words: Sequence[str]) -> list[str]:
    """Translate catkin build NAME and colcon build, without the compiler's options."""
    names = [word for word in words if word[:1].isalpha()]
    return ["pkg", "build", *names[:1]]


def _make(words: Sequence[str]) -> list[str]:
    """Translate catkin_make TARGET, --pkg NAME."""
    return _build(words[words.index("--pkg") :] if "--pkg" in words else ())


def _catkin(words: Sequence[str]) -> list[str]:
    verb, rest = words[0] if words else "", words[1:]
    if verb == "build":
        return _build(rest)
    if verb == "create":  # catkin create pkg NAME
        return _create_package(rest[1:])
    if verb in ("list", "locate"):
        return ["pkg", {"list": "list", "locate": "find"}[verb], *rest]
    if verb.startswith(("test", "run_tests")):
        raise UsageError(f"packages need no {verb} of ROS", str(COMMANDS["test"]))
    what = f"a workspace is a folder with packages, and needs no {verb}".rstrip()
    raise UsageError(what, f"lcmtools pkg create NAME creates a package; {NO_BUILD}")


def _change_folder(words: Sequence[str]) -> list[str]:
    """Refuse roscd NAME/FOLDER, with the shell's command."""
    name, mark, below = (words[0] if words else "NAME").partition("/")
    if name == "air_morse":
        raise UsageError("the worlds of the labs are in lcmtools", str(COMMANDS["morse"]))
    command = f'cd "$(lcmtools pkg find {name}){mark}{below}"'
    raise UsageError("only your shell can change its folder", f"type: {command}")


def _morse(words: Sequence[str]) -> list[str]:
    """Translate morse run WORLD, whose world has the Husky."""
    if list(words[:1]) == ["run"]:
        return ["lab", "start", "husky"]
    return _replaced("morse", COMMANDS["morse"], words)


def _run(words: Sequence[str]) -> list[str]:
    """Translate rosrun PACKAGE NODE; a node of ROS that lcmtools has is lcmtools' own."""
    from lcmtools.packages.runnable_nodes import OWN, runnables

    known = runnables(Path.cwd())
    package, name, *rest = (*words, "", "")[: max(2, len(words))]
    if len(words) == 1 and not any(package in (one.package, one.name) for one in known):
        hint = f"lcmtools pkg create {package} creates it; lcmtools run --list shows the nodes"
        raise UsageError(f"there is no package '{package}'", hint)
    is_of_ros = package in PACKAGES or package == name.removesuffix(".py")
    if not is_of_ros or package in {node.package for node in known}:
        return ["run", *words]
    if name in {node.name for node in known if node.package == OWN}:
        return ["run", name, *rest]
    found = _INSTEAD.get(name.removesuffix(".py"))
    return ["run", *words] if found is None else _replaced(name, found, rest)


def _ros2(words: Sequence[str]) -> list[str]:
    """Translate ros2 run PACKAGE NODE --ros-args -r a:=b; remaps need no --ros-args here."""
    if list(words[:1]) == ["run"]:
        return _run([word for word in words[1:] if word != "--ros-args"])
    if list(words[:2]) == ["pkg", "create"]:
        return _create_package(words[2:])
    if words and words[0] in _INSTEAD:
        return _replaced(words[0], _INSTEAD[words[0]], words[1:])
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
    "catkin_make": _make,
    "catkin_make_isolated": _make,
    "colcon": _catkin,
    "image_view": _image_view,
    "morse": _morse,
    "ros2": _ros2,
    "roscd": _change_folder,
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
    write_note(f"{name} is here: lcmtools {' '.join(map(_quoted, replaced))}")
    return replaced


def _quoted(word: str) -> str:
    """Quote a word for a shell in one line; one with a line break as $'first\\nsecond'."""
    if word.isprintable():
        return shlex.quote(word)
    escaped = "".join(map(_escaped, word))
    return f"$'{escaped}'"


def _escaped(character: str) -> str:
    if character in "\\'\n":
        return "\\n" if character == "\n" else f"\\{character}"
    if character.isprintable():
        return character
    return "".join(f"\\x{byte:02x}" for byte in os.fsencode(character))


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
