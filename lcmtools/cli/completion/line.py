"""The place of the cursor in a command line: at a command, an option, or a value of one.

Plain decisions on words and the commands' descriptions, as click would parse them.
"""

import re
from collections.abc import Callable, Iterator, Sequence

from lcmtools.cli.completion import Source
from lcmtools.cli.completion.tree import Argument, Command, Option

Describe = Callable[[Sequence[str]], Command | None]
_VALUE = re.compile(r"-(\.?\d|\.?inf|\.?nan\b|\s|--(?=\s))", re.IGNORECASE)


def is_value(word: str) -> bool:
    """Return whether a word that begins with "-" is a value: a negative number, or YAML."""
    return _VALUE.match(word) is not None


class Place:
    """The place of the cursor: the command, and what may follow."""

    def __init__(self, path: list[str], command: Command, given: dict[str, list[str]]) -> None:
        self.path = path
        self.command = command
        self.given = given  # values by the parameters' names
        self.kind = "value"  # or "commands" or "options"
        self.source: Source = ""  # of a value's candidates
        self.before = ""  # the part of the word before a value: "--field="
        self.options_are_over = False  # as behind "--"
        self.arguments = 0  # before the cursor

    def unused_options(self) -> Iterator[Option]:
        """Return the options that can still be given."""
        for one in self.command.options:
            if not one.is_hidden and (one.repeats or not self.given.get(one.parameter)):
                yield one


def locate(words: Sequence[str], word: str, describe: Describe) -> Place | None:
    """Return the place of a word after ``words``, or None after an unknown command."""
    root = describe(())
    place = Place([], root, {}) if root else None
    rest = iter(words)
    for one in rest:
        if place is None:
            return None
        option, value = _option_of(place, one)
        if option is not None:
            if not _take_option(place, option, value, rest):
                return place
        elif one == "--" and not place.options_are_over:
            place.options_are_over = True
        elif not _is_option(place, one):
            place = _take_argument(place, one, describe)
    return place and _at(place, word)


def _take_option(place: Place, option: Option, value: str | None, rest: Iterator[str]) -> bool:
    """Record an option and its value. Return False if its value is the word at the cursor."""
    if option.source is not None and value is None:
        value = next(rest, None)
        if value is None:
            place.source = option.source
            return False
    place.given.setdefault(option.parameter, []).append(value or "")
    return True


def _at(place: Place, word: str) -> Place:
    option, value = _option_of(place, word)
    if option is not None and value is not None and "=" in word:
        place.source = option.source or ""
        place.before = word[: len(word) - len(value)]
    elif _is_option(place, word):
        place.kind = "options"
    elif place.command.commands:
        place.kind = "commands"
    else:
        argument = _argument(place)
        place.kind = "value" if argument else "options"
        place.source = argument.source if argument else ""
    return place


def _take_argument(place: Place, word: str, describe: Describe) -> Place | None:
    if place.command.commands:
        path = [*place.path, word]
        command = describe(path) if word in place.command.commands else None
        return Place(path, command, place.given) if command else None
    argument = _argument(place)
    if argument:
        place.given.setdefault(argument.parameter, []).append(word)
        place.arguments += 1
        place.options_are_over |= not place.command.is_mixed
    return place


def _argument(place: Place) -> Argument | None:
    arguments = place.command.arguments
    if place.arguments < len(arguments):
        return arguments[place.arguments]
    return arguments[-1] if arguments and arguments[-1].repeats else None


def _option_of(place: Place, word: str) -> tuple[Option | None, str | None]:
    """Split '--option=value' or '-ovalue'. Either part is None if missing."""
    if place.options_are_over or not word.startswith("-"):
        return None, None
    name, equals, value = word.partition("=")
    for option in place.command.options:
        if name in option.names and (not equals or name.startswith("--")):
            return option, value if equals else None
        if option.source is not None and not word.startswith("--") and word[:2] in option.names:
            return option, word[2:]
    return None, None


def _is_option(place: Place, word: str) -> bool:
    return word.startswith("-") and not place.options_are_over and not is_value(word)
