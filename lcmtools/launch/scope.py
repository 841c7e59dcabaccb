"""The scope at a place in a launch file: namespace, arguments, remaps, parameters, variables.

Belongs here: the value, and the attributes of a tag that are read with it. Must not know the
meaning of tags. A tag that changes the scope after it makes a new one; nothing is changed in place.
"""

import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

from lcmtools.errors import UsageError
from lcmtools.formats.strict_xml import Element
from lcmtools.formats.strict_yaml import YamlNode
from lcmtools.formats.typed import Item
from lcmtools.launch.packages import package_folder
from lcmtools.launch.substitution import Known, substitute
from lcmtools.launch.tags import END_OF_WORD, unknown_attributes
from lcmtools.names import check_legal, resolve

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Scope:
    """The scope at a place."""

    folder: Path  # the file's, for ``$(dirname)`` and relative paths
    namespace: str  # the full namespace
    environment: Mapping[str, str]  # all variables, including the launcher's own
    names: dict[str, str]  # the names made by ``$(anon x)``
    set_variables: Mapping[str, str] = field(default_factory=dict)  # those set by the files
    arguments: Mapping[str, str] = field(default_factory=dict)  # those declared so far
    passed: Mapping[str, str] = field(default_factory=dict)  # given to the file; override defaults
    is_included: bool = False  # the file was included by another one
    takes_all: bool = False  # with ``pass_all_args``: the file may fix arguments that it is given
    remaps: Mapping[str, str] = field(default_factory=dict)  # from name to name
    parameters: Mapping[str, str] = field(default_factory=dict)  # private, name to YAML text

    def substituted(self, element: Element, text: str) -> str:
        """Return a text of an element with everything in ``$( )`` replaced."""
        return self._substituted(element, text, str)

    def words(self, element: Element, name: str) -> list[str]:
        """Return an attribute's words, split as by a shell; the path of a folder is one word."""
        folders: dict[str, str] = {}

        def hidden(folder: str) -> str:
            return folders.setdefault(folder, f"\ufdd0{len(folders)}\ufdd0")

        text = self._substituted(element, element.attributes.get(name, ""), hidden)
        is_list = text.endswith(END_OF_WORD)
        words = text.split(END_OF_WORD)[:-1] if is_list else _split(element, text)
        for folder, mark in folders.items():
            words = [word.replace(mark, folder) for word in words]
        return words

    def _substituted(self, element: Element, text: str, shown: Callable[[str], str]) -> str:
        def find(name: str) -> str:
            return str(package_folder(name, self.folder))

        known = Known(self.arguments, self.environment, str(self.folder), find, self.names)
        return located(element, lambda: substitute(text, known, shown))

    def text(self, element: Element, name: str, default: str = "") -> str:
        """Return an attribute's value; the default if it is not given."""
        return self.substituted(element, element.attributes.get(name, default))

    def required(self, element: Element, name: str) -> str:
        """Return the value of an attribute that must not be empty."""
        text = self.text(element, name)
        if not text:
            what = "is empty in" if name in element.attributes else "is missing in"
            unknown = ", ".join(map(repr, unknown_attributes(element)))
            hint = f"there is no attribute {unknown}" if unknown else ""
            raise element.error(f"'{name}' {what} {element.tag}", hint)
        return text

    def flag(self, element: Element, name: str, *, default: bool = False) -> bool:
        """Return True if an attribute is true, or 1."""
        value = self._value(element, name, str(default))
        return value.content == "1" or (value.content != "0" and value.flag())

    def seconds(self, element: Element, name: str) -> float:
        """Return a number of seconds, 0 if it is not given."""
        return self._value(element, name, "0").number(0.0)

    def _value(self, element: Element, name: str, default: str) -> Item:
        text = self.text(element, name, default).strip()
        return Item(name, element.source, YamlNode(text, element.line))

    def holds(self, element: Element) -> bool:
        """Return True if an element applies, by its ``if`` and ``unless``."""
        if {"if", "unless"} <= set(element.attributes):
            hint = "leave one of them out"
            raise element.error(f"{element.tag} has both 'if' and 'unless'", hint)
        return self.flag(element, "if", default=True) and not self.flag(element, "unless")

    def below(self, element: Element) -> "Scope":
        """Return the scope in an element, which may have a namespace."""
        namespace = self.text(element, "ns")
        if not namespace:
            return self
        return replace(self, namespace=located(element, lambda: resolve(namespace, self.namespace)))

    def with_remap(self, element: Element) -> "Scope":
        """Return the scope after a remap."""
        source, target = self.required(element, "from"), self.required(element, "to")
        for name in (source, target):
            located(element, partial(check_legal, name))
        others = {name: to for name, to in self.remaps.items() if name != source}
        return replace(self, remaps={**others, source: target})

    def with_variable(self, element: Element) -> "Scope":
        """Return the scope after a variable has been set."""
        name, text = self.required(element, "name"), self.text(element, "value")
        if "value" not in element.attributes:
            raise element.error("'value' is missing in env")
        if "=" in name or "\0" in name + text:
            raise element.error(f"'{name}' is not the name of an environment variable")
        environment = {**self.environment, name: text}
        set_variables = {**self.set_variables, name: text}
        return replace(self, environment=environment, set_variables=set_variables)


def _split(element: Element, text: str) -> list[str]:
    try:
        return shlex.split(text)
    except ValueError:
        raise element.error(f"a quote is not closed in '{' '.join(text.split())}'") from None


def located(element: Element, work: Callable[[], T]) -> T:
    """Return the result of ``work`` on an element; add the element's place to its errors."""
    try:
        return work()
    except UsageError as error:
        is_shell = any("${" in text for text in element.attributes.values())
        hint = "write an argument as $(arg NAME)" if is_shell else error.hint
        raise element.error(error.what, hint) from None
