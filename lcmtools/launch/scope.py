"""What holds at a place of a launch file: namespace, arguments, remaps, parameters, variables.

Belongs here: the value, and how a tag's attributes are read with it. Must not know what tags do. A
tag that changes what holds behind it gives a new scope; nothing is changed in place.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from lcmtools.errors import UsageError
from lcmtools.formats.strict_xml import Element
from lcmtools.launch.packages import find_package
from lcmtools.launch.substitution import Known, substitute
from lcmtools.names import check_legal, resolve

_TRUTH = {"true": True, "1": True, "false": False, "0": False}

T = TypeVar("T")
Remaps = tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Scope:
    """What holds at a place.

    Attributes:
        folder: Of the file, for ``$(dirname)`` and paths.
        namespace: The full one.
        environment: All variables, the launcher's own too.
        set_variables: Those that the files set.
        arguments: The values of the arguments that have been declared so far.
        passed: What whoever reads the file has said; a default gives way to it.
        is_included: The file was included by another one.
        takes_all: And with ``pass_all_args``, and has arguments of its own too.
        remaps: Pairs (from, to).
        parameters: Private ones for the nodes below, name to YAML text.
        names: What ``$(anon x)`` has been.
    """

    folder: Path
    namespace: str
    environment: Mapping[str, str]
    names: dict[str, str]
    set_variables: Mapping[str, str] = field(default_factory=dict)
    arguments: Mapping[str, str] = field(default_factory=dict)
    passed: Mapping[str, str] = field(default_factory=dict)
    is_included: bool = False
    takes_all: bool = False
    remaps: Remaps = ()
    parameters: Mapping[str, str] = field(default_factory=dict)

    def put_in(self, element: Element, text: str) -> str:
        """A text of an element with everything in ``$( )`` replaced.

        Raises:
            InvalidFile: It asks for something that there is not.
        """
        known = Known(
            self.arguments,
            self.environment,
            str(self.folder),
            lambda name: str(find_package(name, self.folder)),
            self.names,
        )
        return located(element, lambda: substitute(text, known))

    def text(self, element: Element, name: str, default: str = "") -> str:
        """An attribute's value; the default where it is not given.

        Raises:
            InvalidFile: It cannot be worked out.
        """
        return self.put_in(element, element.attributes.get(name, default))

    def required(self, element: Element, name: str) -> str:
        """An attribute's value.

        Raises:
            InvalidFile: It is not given, empty, or cannot be worked out.
        """
        text = self.text(element, name)
        if not text:
            what = "is empty in" if name in element.attributes else "is missing in"
            raise element.error(f"'{name}' {what} {element.tag}")
        return text

    def flag(self, element: Element, name: str, *, default: bool = False) -> bool:
        """Whether an attribute is true.

        Raises:
            InvalidFile: It is neither true nor false.
        """
        if name not in element.attributes:
            return default
        text = self.text(element, name).strip()
        if text.lower() not in _TRUTH:
            raise element.error(f"'{name}' must be true or false, not '{text}'")
        return _TRUTH[text.lower()]

    def number(self, element: Element, name: str) -> float:
        """A number of seconds, 0 where it is not given.

        Raises:
            InvalidFile: It is no number, or negative.
        """
        text = self.text(element, name, "0")
        try:
            value = float(text)
        except ValueError:
            value = -1.0
        if not 0 <= value < float("inf"):
            raise element.error(f"'{name}' must be a number of seconds, not '{text}'")
        return value

    def holds(self, element: Element) -> bool:
        """Whether an element counts, by its ``if`` and ``unless``.

        Raises:
            InvalidFile: They are neither true nor false, or both are given.
        """
        if {"if", "unless"} <= set(element.attributes):
            raise element.error(
                f"{element.tag} has both 'if' and 'unless'", "leave one of them out"
            )
        return self.flag(element, "if", default=True) and not self.flag(element, "unless")

    def below(self, element: Element) -> "Scope":
        """The scope in an element that has a namespace, or none.

        Raises:
            InvalidFile: It is no legal namespace.
        """
        namespace = self.text(element, "ns")
        if not namespace:
            return self
        return replace(self, namespace=located(element, lambda: resolve(namespace, self.namespace)))

    def with_remap(self, element: Element) -> "Scope":
        """The scope behind a remap.

        Raises:
            InvalidFile: A name is missing or not legal.
        """
        pair = (self.required(element, "from"), self.required(element, "to"))
        located(element, lambda: check_legal(pair[0]))
        located(element, lambda: check_legal(pair[1]))
        others = tuple(known for known in self.remaps if known[0] != pair[0])
        return replace(self, remaps=(*others, pair))

    def with_variable(self, element: Element) -> "Scope":
        """The scope behind a variable that is set.

        Raises:
            InvalidFile: Its name is missing, or none.
        """
        name, text = self.required(element, "name"), self.text(element, "value")
        if "value" not in element.attributes:
            raise element.error("'value' is missing in env")
        if "=" in name or "\0" in name + text:
            raise element.error(f"'{name}' is no name of an environment variable")
        return replace(
            self,
            environment={**self.environment, name: text},
            set_variables={**self.set_variables, name: text},
        )

    def with_parameters(self, found: Iterable[tuple[str, str]]) -> "Scope":
        """The scope behind private parameters."""
        return replace(self, parameters={**self.parameters, **dict(found)})


def located(element: Element, work: Callable[[], T]) -> T:
    """What some work on an element gives; what is wrong with it gets the element's place.

    Raises:
        InvalidFile: Something is wrong.
    """
    try:
        return work()
    except UsageError as error:
        raise element.error(error.what, error.hint) from None
