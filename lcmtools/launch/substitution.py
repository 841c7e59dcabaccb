"""Text in ``$( )``: arguments, variables, folders of packages, names, expressions.

Belongs here: roslaunch's substitutions as functions of a text and of the values known at a place in
a launch file. Must not know tags. https://wiki.ros.org/roslaunch/XML#substitution_args
"""

import contextlib
import math
import secrets
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import cast

from lcmtools.errors import UsageError
from lcmtools.formats.expression import Expression, ExpressionFault, Language
from lcmtools.formats.operations import CONSTANTS, LARGEST, TEXT_METHODS, Function
from lcmtools.names import did_you_mean

_QUOTES = "'\""
_COMMANDS = ("arg", "env", "optenv", "find", "anon", "dirname", "eval")
_LONGEST = 1000  # characters of an expression
_SHOWN = 60  # characters of a text in an error
_MOST_ADDED = 10_000  # characters of values; else a few arguments of arguments grow without end
_CONSTANTS: Mapping[str, object] = {**CONSTANTS, "e": math.e, "true": True, "false": False}
_COUNTS = {"dirname": (0, 0), "optenv": (1, 2), "pow": (2, 2), "fmod": (2, 2), "log": (1, 2)}
"""The numbers of arguments of functions that take more or less than one."""
_MATH = ("ceil", "exp", "fabs", "floor", "fmod", "log", "log10", "pow")
_CASTS: Mapping[str, Function] = {
    "str": str,
    "int": lambda value: int(cast("float", value)),
    "float": lambda value: float(cast("float", value)),
    "bool": bool,
}


@dataclass(frozen=True, slots=True)
class Known:
    """The values of substitutions."""

    arguments: Mapping[str, str]
    environment: Mapping[str, str]
    folder: str  # the file's
    package_folder: Callable[[str], str]  # returns a package's folder
    names: dict[str, str] = field(default_factory=dict)  # of ``$(anon x)``; new ones are added

    def argument(self, name: str) -> str:
        """Return an argument's value."""
        if name not in self.arguments:
            hint = did_you_mean(name, self.arguments) or "declare it by arg before it is used"
            raise UsageError(f"there is no argument '{name}'", hint)
        return self.arguments[name]

    def variable(self, name: str) -> str:
        """Return a variable of the environment."""
        if name not in self.environment:
            hint = f"or write $(optenv {name} DEFAULT)"
            raise UsageError(f"the environment variable {name} is not set", hint)
        return self.environment[name]

    def anonymous(self, name: str) -> str:
        """Return a unique name, the same for each use."""
        return self.names.setdefault(name, f"{name}_{secrets.token_hex(4)}")

    def named(self, name: str) -> object:
        """Return the value of a name in an expression."""
        if name in self.arguments:
            return _typed(self.arguments[name])
        if name in _CONSTANTS:
            return _CONSTANTS[name]
        raise LookupError(f"there is no '{name}'")

    def attribute(self, owner: object, name: str) -> object:
        """Raise the error for a field: values have no fields here."""
        raise LookupError(f"{owner} has no field '{name}'")


def substitute(text: str, known: Known, shown: Callable[[str], str] = str) -> str:
    """Replace all ``$( )``, but not those in values; UsageError if unknown or not closed.

    ``shown`` returns the text for the path of a folder, of ``$(dirname)`` or ``$(find x)``.
    """
    found, size = list[str](), 0
    for inside, part in _parts(text):
        found.append(_replaced(part, known, shown) if inside else part)
        size += len(found[-1])
        if size > 2 * len(text) + _MOST_ADDED:
            start = " ".join(text[:_SHOWN].split())
            raise UsageError(f"the values in '{start}' have more than {_MOST_ADDED} characters")
    return "".join(found)


def _parts(text: str) -> Iterator[tuple[bool, str]]:
    """Return the text in parts, each with True if it is within ``$( )``."""
    end = 0
    while (start := text.find("$(", end)) >= 0:
        yield False, text[end:start]
        end = _closing(text, start + 2)
        yield True, text[start + 2 : end]
        end += 1
    yield False, text[end:]


def _closing(text: str, start: int) -> int:
    """Return the index of the parenthesis that closes the one before ``start``."""
    quotes = _QUOTES if text.startswith("eval", start) else ""
    depth, quote = 1, ""
    for index in range(start, len(text)):
        character = text[index]
        if quote:
            quote = "" if character == quote else quote
        elif character in quotes:
            quote = character
        else:
            depth += {"(": 1, ")": -1}.get(character, 0)
        if depth == 0:
            return index
    raise UsageError(f"'$(' is not closed in '{text}'")


def _replaced(inside: str, known: Known, shown: Callable[[str], str]) -> str:
    command, _, rest = inside.strip().partition(" ")
    rest = rest.strip()
    if command == "eval":
        return _evaluated(rest, known)
    if command == "optenv":
        name, _, default = rest.partition(" ")
        return known.environment.get(_single_name(command, name), default.strip())
    if command == "dirname":
        return shown(known.folder)
    command = {"var": "arg"}.get(command, command)  # as in ROS 2
    functions = _functions(known)
    if command not in functions:
        hint = did_you_mean(command, _COMMANDS) or f"there are {', '.join(_COMMANDS)}"
        if command in known.arguments:
            hint = f"write $(arg {command})"
        raise UsageError(f"there is no '$({command} ...)'", hint)
    value = functions[command](_single_name(command, rest))
    return shown(value) if command == "find" else value


def _single_name(command: str, words: str) -> str:
    if not words or len(words.split()) > 1:
        form = f"optenv {words}" if command == "env" and words else f"{command} NAME"
        raise UsageError(f"'$({command} {words})' needs one name", f"write $({form})")
    return words


def _functions(known: Known) -> dict[str, Callable[[str], str]]:
    return {
        "arg": known.argument,
        "env": known.variable,
        "find": known.package_folder,
        "anon": known.anonymous,
    }


def _evaluated(text: str, known: Known) -> str:
    """Return the value of an expression with the file's arguments, as text."""
    language = Language(
        name="eval",
        example="write for example $(eval arg('count') * 2 + 1)",
        allowed="arguments, numbers, text, comparisons, arithmetic, and, or, not, in, if, else are",
        longest=_LONGEST,
        functions={
            **_CASTS,
            **{name: getattr(math, name) for name in _MATH},
            **_functions(known),
            "arg": lambda name: _typed(known.argument(str(name))),
            "optenv": lambda name, default="": known.environment.get(str(name), default),
            "dirname": lambda: known.folder,
        },
        has_choices=True,
        methods=TEXT_METHODS,
        counts=_COUNTS,
    )
    try:
        value = Expression(" ".join(text.splitlines()), language).value(known)
    except ExpressionFault as fault:
        raise UsageError(f"eval: cannot work out {fault}", language.example) from None
    return str(list(value) if isinstance(value, tuple) else value)


def _typed(text: str) -> object:
    """Return the value of a text: true or false, a number, or the text itself."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    with contextlib.suppress(ValueError):
        if abs(number := int(text)) <= LARGEST:
            return number
    with contextlib.suppress(ValueError):
        if math.isfinite(real := float(text)):
            return real
    return text
