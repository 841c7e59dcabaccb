"""The tags of launch files and their attributes, as in roslaunch.

https://wiki.ros.org/roslaunch/XML
"""

from collections.abc import Iterator, Mapping

from lcmtools.formats.strict_xml import Element
from lcmtools.names import did_you_mean

END_OF_WORD = "\0"
"""Behind each word of an attribute whose words are given one by one, as in a list of YAML."""
_OF_NODES = {"node", "remap", "param", "rosparam", "env"}
_EVERYWHERE = {"if", "unless"}

_ATTRIBUTES: Mapping[str, set[str]] = {
    "launch": {"deprecated", "version"},
    "node": {
        *("pkg", "type", "name", "args", "ns", "machine", "cwd", "output", "clear_params"),
        *("respawn", "respawn_delay", "required", "launch-prefix"),
        *("run", "exec", "stdin"),  # lcmtools' own
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
_CHILDREN: Mapping[str, set[str]] = {
    "launch": {*_ATTRIBUTES} - {"launch"},
    "group": {*_ATTRIBUTES} - {"launch"},
    "node": _OF_NODES - {"node"},
    "test": _OF_NODES - {"node"},
    "include": {"arg", "env"},
    "machine": {"env"},
}
"""The tags allowed within each; others may not contain any."""


def unknown_attributes(element: Element) -> list[str]:
    """Return the attributes of an element that have no meaning there."""
    known = _ATTRIBUTES[element.tag] | _EVERYWHERE
    return [name for name in element.attributes if name not in known]


def notes_on(element: Element) -> Iterator[str]:
    """Return the parts of an element that have no meaning there, each with its place."""
    for name in unknown_attributes(element):
        hint = did_you_mean(name, _ATTRIBUTES[element.tag] | _EVERYWHERE) or "it is left out"
        yield f"{element.place}: {element.tag} has no attribute '{name}'; {hint}"
    tags = _CHILDREN.get(element.tag, set())
    for child in element.children:
        if child.tag not in tags:
            hint = did_you_mean(child.tag, tags) or "it is left out"
            yield f"{child.place}: there is no tag '{child.tag}' in {element.tag}; {hint}"
    if element.attributes.get("clear_params", "false") != "false":
        yield f"{element.place}: clear_params has no effect: parameters end with their node"
    if "machine" in element.attributes or element.tag == "machine":
        yield f"{element.place}: machine has no effect: all nodes run on this computer"


def known_children(element: Element) -> list[Element]:
    """Return the elements in an element that have a meaning there."""
    tags = _CHILDREN.get(element.tag, set())
    return [child for child in element.children if child.tag in tags]
