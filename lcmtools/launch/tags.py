"""The tags of launch files and their attributes, as roslaunch has them.

Belongs here: which there are. https://wiki.ros.org/roslaunch/XML
"""

from collections.abc import Iterator, Mapping

from lcmtools.formats.strict_xml import Element
from lcmtools.names import did_you_mean

_OF_NODES = {"node", "remap", "param", "rosparam", "env"}
_EVERYWHERE = {"if", "unless"}

ATTRIBUTES: Mapping[str, set[str]] = {
    "launch": {"deprecated", "version"},
    "node": {
        *("pkg", "type", "name", "args", "ns", "machine", "cwd", "output", "clear_params"),
        *("respawn", "respawn_delay", "required", "launch-prefix"),
        *("run", "exec", "stdin"),  # ours
    },
    "remap": {"from", "to"},
    "param": {"name", "value", "type", "textfile", "binfile", "command"},
    "rosparam": {"command", "file", "param", "ns", "subst_value"},
    "arg": {"name", "default", "value", "doc"},
    "include": {"file", "ns", "clear_params", "pass_all_args"},
    "group": {"ns", "clear_params"},
    "env": {"name", "value"},
    "machine": {
        *("name", "address", "env-loader", "user", "password", "default", "timeout", "ssh-port"),
        *("ros-root", "ros-package-path", "ros-ip", "ros-host-name"),
    },
    "test": {
        *("pkg", "type", "name", "args", "ns", "test-name", "time-limit", "retry", "cwd"),
        *("launch-prefix", "clear_params"),
    },
}
"""The tags, and the attributes of each; ``if`` and ``unless`` besides."""

CHILDREN: Mapping[str, set[str]] = {
    "launch": {*ATTRIBUTES} - {"launch"},
    "group": {*ATTRIBUTES} - {"launch"},
    "node": _OF_NODES - {"node"},
    "test": _OF_NODES - {"node"},
    "include": {"arg", "env"},
    "machine": {"env"},
}
"""The tags that may stand in each; in all others none may."""


def unknown_parts(element: Element) -> Iterator[str]:
    """What roslaunch warns of: attributes and tags that mean nothing where they stand."""
    known = ATTRIBUTES[element.tag] | _EVERYWHERE
    for name in element.attributes:
        if name not in known:
            what = f"{element.place}: {element.tag} has no attribute '{name}'"
            yield _with_hint(what, did_you_mean(name, known))
    tags = CHILDREN.get(element.tag, set())
    for child in element.children:
        if child.tag not in tags:
            what = f"{child.place}: there is no tag '{child.tag}' in {element.tag}"
            yield _with_hint(what, did_you_mean(child.tag, tags))


def known_children(element: Element) -> list[Element]:
    """The tags in an element that mean something there."""
    tags = CHILDREN.get(element.tag, set())
    return [child for child in element.children if child.tag in tags]


def _with_hint(what: str, hint: str) -> str:
    return f"{what}; {hint}" if hint else f"{what}; it is left out"
