"""Parameters of launch files: from ``<param>`` and ``<rosparam>`` to names and YAML texts.

Belongs here: the values of parameters, and which nodes get them. There is no parameter server on
LCM: each node gets its parameters on its command line.
"""

from collections.abc import Collection, Iterator, Mapping

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.formats.strict_xml import Element
from lcmtools.launch.packages import LARGEST, path_from
from lcmtools.launch.scope import Scope, located
from lcmtools.messages.documents import parse
from lcmtools.messages.fill import Value
from lcmtools.messages.setting import ANY, read_setting, text_of, write_setting
from lcmtools.names import check_legal, namespace_of

_KINDS = {"str": "string", "int": "int", "double": "float", "bool": "bool"}
_SOURCES = ("value", "textfile", "command", "binfile")
_MOST_NAMED = 5


def param(element: Element, scope: Scope) -> tuple[str, str] | None:
    """Return a ``<param>``'s name and text; None for a command's output, which is not supported."""
    name = scope.required(element, "name")
    located(element, lambda: check_legal(name))
    given = [source for source in _SOURCES if source in element.attributes]
    if len(given) != 1:
        raise element.error(f"param {name} needs one of: {', '.join(_SOURCES)}")
    if given[0] == "value":
        return name, _typed(element, scope, name)
    if given[0] == "textfile":
        return name, write_setting(_read(element, scope.required(element, "textfile"), scope))
    return None


def rosparam(element: Element, scope: Scope) -> Iterator[tuple[str, str]]:
    """Return the names and texts of a ``<rosparam>``: YAML in it, or in a file."""
    text, source, line = element.text, element.source, element.line
    if file := scope.text(element, "file"):
        text, source, line = _read(element, file, scope), file, 1
    if scope.flag(element, "subst_value"):
        text = scope.substituted(element, text)
    prefix = [part for part in (scope.text(element, "ns"), scope.text(element, "param")) if part]
    try:
        documents = list(parse(text, line))
    except UsageError as error:
        raise InvalidFile(f"{source}: {error.what}", error.hint) from None
    for document in documents:
        if not isinstance(document.value, dict) and "param" not in element.attributes:
            raise element.error("rosparam: expected names and values", "for example kp: 0.5")
        for name, leaf in _leaves(document.value, "/".join(prefix)):
            located(element, lambda name=name: check_legal(name))  # type: ignore[misc]
            yield name, text_of(leaf, ANY)


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
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
        if len(content) > LARGEST:
            raise element.error(f"{path} has more than {LARGEST} bytes")
        return content.decode()
    except OSError as error:
        raise element.error(f"cannot read {path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise element.error(f"cannot read {path}: it is not UTF-8 text") from None


def _typed(element: Element, scope: Scope, name: str) -> str:
    kind, text = scope.text(element, "type", "auto"), scope.text(element, "value")
    if kind in ("auto", "yaml"):
        return text or write_setting("")  # nodes ignore an empty text
    if kind not in _KINDS:
        raise element.error(f"'{kind}' is not a type", f"types: {', '.join(_KINDS)}, yaml, auto")
    return located(
        element, lambda: write_setting(read_setting(text, _KINDS[kind], f"param {name}"))
    )


def _leaves(value: Value, name: str) -> Iterator[tuple[str, Value]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _leaves(part, f"{name}/{key}" if name else key)
    else:
        yield name, value
