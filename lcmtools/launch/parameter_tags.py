"""Parameters of launch files: from ``<param>`` and ``<rosparam>`` to names and YAML texts.

Belongs here: the values of parameters, and which nodes get them. There is no parameter server on
LCM: each node gets its parameters on its command line.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping

from lcmtools.errors import InvalidName, ValueMismatch
from lcmtools.folders import read_text
from lcmtools.formats.strict_xml import Element
from lcmtools.launch.packages import path_from
from lcmtools.launch.parameter_yaml import leaves, read_parameters, text_of
from lcmtools.launch.scope import Scope, located
from lcmtools.messages.setting import ANY, guessed, read_setting, write_setting
from lcmtools.names import check_legal, namespace_of

_KINDS = {
    "str": "string",
    "string": "string",
    "int": "int",
    "double": "float",
    "bool": "bool",
    "boolean": "bool",
}
AS_TYPED = "as typed"
"""The type of a value that a YAML file gives: a node reads it as on its command line."""
_SOURCES = ("value", "textfile", "command", "binfile")
_MOST_NAMED = 5


def param(element: Element, scope: Scope) -> list[tuple[str, str]] | None:
    """Return a ``<param>``'s names and texts; None for a command's output, which is not supported.

    It has several names if its value is a mapping.
    """
    name = scope.required(element, "name")
    located(element, lambda: check_legal(name))
    given = [source for source in _SOURCES if source in element.attributes]
    if len(given) != 1:
        raise element.error(f"param {name} needs one of: {', '.join(_SOURCES)}")
    if given[0] == "value":
        return list(_typed(element, scope, name))
    if given[0] == "textfile":
        text = _read(element, scope.required(element, "textfile"), scope)
        return [(name, write_setting(text))]
    return None


def rosparam(element: Element, scope: Scope, notes: list[str]) -> Iterator[tuple[str, str]]:
    """Return the names and texts of a ``<rosparam>``: YAML in it, or in a file.

    A name that a node's parameter cannot have is left out, with a note.
    """
    text, source, line = element.text, element.source, element.line
    if "file" in element.attributes:
        source, line = scope.required(element, "file"), 1
        text = _read(element, source, scope)
    if scope.flag(element, "subst_value"):
        text = scope.substituted(element, text)
    prefix = [part for part in (scope.text(element, "ns"), scope.text(element, "param")) if part]
    root = read_parameters(text, source, line)
    if root is None:
        return
    if not isinstance(root.value, dict) and "param" not in element.attributes:
        raise element.error("rosparam: expected names and values", "for example kp: 0.5")
    for name, leaf in leaves(root, "/".join(prefix)):
        try:
            check_legal(name)
        except InvalidName as error:  # noqa: PERF203 - each name fails on its own
            notes.append(f"{source}:{leaf.key_line}: parameter {error.what}; it is left out")
        else:
            yield name, text_of(leaf, source)


def notes_on_values(found: Iterable[tuple[str, str]], element: Element) -> Iterator[str]:
    """Yield a note on each parameter whose value no node can hold: the node misses it then."""
    for name, text in found:
        try:
            read_setting(text, ANY, f"parameter {name}")
        except ValueMismatch as error:  # noqa: PERF203 - each value fails on its own
            yield f"{element.place}: {error.what}; a node cannot hold it, and goes without it"


def own_parameters(node: str, everywhere: Mapping[str, str]) -> dict[str, str]:
    """Return the parameters with full names that a node gets: those below or above it.

    A ROS node would find those above by searching in its namespace and its parents.
    """
    from_above = sorted(everywhere, key=lambda name: name.count("/"))
    return {own: everywhere[name] for name in from_above if (own := _own_name(node, name))}


def note_on_lost(nodes: Collection[str], everywhere: Mapping[str, str]) -> Iterator[str]:
    """Yield a sentence on the parameters that no node gets, if there are any."""
    lost = [name for name in everywhere if not any(_own_name(node, name) for node in nodes)]
    if lost:
        more = f" and {len(lost) - _MOST_NAMED} more" if len(lost) > _MOST_NAMED else ""
        names = ", ".join(lost[:_MOST_NAMED])
        yield f"no node gets the parameters {names}{more}: there is none in their namespaces"


def _own_name(node: str, parameter: str) -> str:
    """Return a node's own name for a parameter with a full name; "" if it does not get it."""
    if parameter.startswith(f"{node}/"):
        return parameter[len(node) + 1 :]
    around = f"{namespace_of(parameter).rstrip('/')}/"
    is_above = f"{namespace_of(node).rstrip('/')}/".startswith(around)
    return parameter.rpartition("/")[2] if is_above else ""


def _read(element: Element, name: str, scope: Scope) -> str:
    path = located(element, lambda: path_from(scope.folder, name))
    return located(element, lambda: read_text(path))


def _typed(element: Element, scope: Scope, name: str) -> Iterator[tuple[str, str]]:
    """Yield names and texts of a value, checked by its type."""
    kind, text = scope.text(element, "type", "auto").lower(), scope.text(element, "value").strip()
    if kind not in (*_KINDS, "auto", "yaml", AS_TYPED):
        raise element.error(f"'{kind}' is not a type", f"types: {', '.join(_KINDS)}, yaml, auto")
    if kind == "yaml" and (root := read_parameters(text, element.source, element.line)):
        yield from ((path, text_of(leaf, element.source)) for path, leaf in leaves(root, name))
    elif kind == AS_TYPED:
        yield name, text or write_setting("")  # nodes ignore an empty text
    elif kind in ("auto", "yaml"):
        yield name, text if not isinstance(guessed(text), str) else write_setting(text)
    elif _KINDS[kind] == "string":
        yield name, write_setting(text)
    else:
        value = located(element, lambda: read_setting(text, _KINDS[kind], f"param {name}"))
        yield name, write_setting(value)
