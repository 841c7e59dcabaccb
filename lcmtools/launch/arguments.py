"""The arguments of launch files: declared, given, passed on to included files.

Belongs here: the meaning of ``<arg>``. https://wiki.ros.org/roslaunch/XML/arg
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from lcmtools.errors import UsageError
from lcmtools.formats.strict_xml import Element
from lcmtools.launch.plan import LaunchArgument
from lcmtools.launch.scope import Scope
from lcmtools.launch.tags import known_children
from lcmtools.names import did_you_mean


def declare(element: Element, scope: Scope) -> Scope:
    """Return the scope after an ``<arg>``."""
    name = scope.required(element, "name")
    has_value, has_default = "value" in element.attributes, "default" in element.attributes
    if has_value and has_default:
        raise element.error(f"the argument '{name}' has both 'value' and 'default'")
    if name in scope.arguments:
        raise element.error(f"the argument '{name}' is declared twice")
    if has_value and name in scope.passed and not scope.takes_all:
        raise element.error(f"the argument '{name}' is fixed by the file and cannot be given")
    if has_value or (has_default and name not in scope.passed):
        text = scope.text(element, "value" if has_value else "default")
    elif name in scope.passed:
        text = scope.passed[name]
    else:
        doc = scope.text(element, "doc")
        hint = "give it in the include" if scope.is_included else f"type {name}:=VALUE"
        raise element.error(f"the argument '{name}'{f' ({doc})' if doc else ''} has no value", hint)
    return replace(scope, arguments={**scope.arguments, name: text})


def arguments_of(element: Element) -> list[LaunchArgument]:
    """Return the arguments that a file accepts: those whose values it does not fix."""
    found: dict[str, LaunchArgument] = {}
    for child in _declarations(element):
        about = child.attributes
        if "value" not in about and (name := about.get("name")):
            found.setdefault(name, LaunchArgument(name, about.get("default"), about.get("doc", "")))
    return list(found.values())


def names_in(element: Element) -> set[str]:
    """Return the names of a file's arguments, including the fixed ones."""
    return {child.attributes.get("name", "") for child in _declarations(element)}


def passes_all(element: Element) -> bool:
    """Return True if a file may pass arguments on that it does not declare itself."""
    is_include = element.tag == "include"
    given = element.attributes.get("pass_all_args", "false") if is_include else "false"
    return given.lower() not in ("false", "0") or any(map(passes_all, element.children))


def _declarations(element: Element) -> Iterator[Element]:
    for child in element.children:
        if child.tag == "group":
            yield from _declarations(child)
        elif child.tag == "arg":
            yield child


def given_inside(element: Element, scope: Scope) -> tuple[Scope, dict[str, str]]:
    """Return the scope and the arguments that an include gives to its file."""
    inside = scope.below(element)
    found: dict[str, str] = {}
    for child in filter(scope.holds, known_children(element)):
        if child.tag == "env":
            inside = inside.with_variable(child)
            continue
        name = scope.required(child, "name")
        key = "value" if "value" in child.attributes else "default"
        if key not in child.attributes:
            raise child.error(f"the argument '{name}' has no value")
        found[name] = scope.text(child, key)
    return inside, found


def check_given(roots: Sequence[Element], passed: Mapping[str, str]) -> None:
    """Raise UsageError for an argument that no file accepts."""
    known = {name for root in roots for name in names_in(root)}
    for name, text in passed.items():
        if name not in known:
            files = ", ".join(root.source for root in roots)
            what = f"{name}:={text}: {files} has no argument '{name}'"
            raise UsageError(what, _hint(name, known))


def check_passed(element: Element, passed: Mapping[str, str], root: Element) -> None:
    """Refuse arguments of an include that the file does not accept."""
    known = names_in(root)
    for name in passed:
        if name not in known:
            raise element.error(f"{root.source} has no argument '{name}'", _hint(name, known))


def _hint(name: str, known: Collection[str]) -> str:
    if not known:
        return "it takes none"
    return did_you_mean(name, known) or f"there are {', '.join(sorted(known))}"
