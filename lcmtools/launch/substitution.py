"""What stands in ``$( )``: arguments, variables, folders of packages, names, expressions.

Belongs here: roslaunch's substitutions as functions of text and of what is known in a place of a
launch file. Must not know tags. https://wiki.ros.org/roslaunch/XML#substitution_args
"""

import secrets
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from lcmtools.errors import UsageError
from lcmtools.launch.expression import Functions, evaluate
from lcmtools.names import did_you_mean

_QUOTES = "'\""


@dataclass(frozen=True, slots=True)
class Known:
    """What may be put in.

    Attributes:
        arguments: The file's arguments.
        environment: The variables.
        folder: The folder of the file.
        find_package: Gives a package's folder.
        names: What ``$(anon x)`` has been so far; new ones are added.
    """

    arguments: Mapping[str, str]
    environment: Mapping[str, str]
    folder: str
    find_package: Callable[[str], str]
    names: dict[str, str] = field(default_factory=dict)


def substitute(text: str, known: Known) -> str:
    """A text with everything in ``$( )`` replaced; what was put in is not looked through again.

    Raises:
        UsageError: It asks for something that there is not, or is not closed.
    """
    return "".join(_replaced(part, known) if inside else part for inside, part in _parts(text))


def _parts(text: str) -> Iterator[tuple[bool, str]]:
    """The text in parts, each with whether it stands in ``$( )``."""
    rest = text
    while True:
        before, mark, rest = rest.partition("$(")
        yield False, before
        if not mark:
            return
        inside, rest = _closed(rest, text)
        yield True, inside


def _closed(rest: str, text: str) -> tuple[str, str]:
    """What is before the parenthesis that closes, and what is behind it."""
    quotes = _QUOTES if rest.startswith("eval") else ""
    depth, quote = 1, ""
    for index, character in enumerate(rest):
        if quote:
            quote = "" if character == quote else quote
        elif character in quotes:
            quote = character
        else:
            depth += {"(": 1, ")": -1}.get(character, 0)
        if depth == 0:
            return rest[:index], rest[index + 1 :]
    raise UsageError(f"'$(' is not closed in '{text}'")


def _replaced(inside: str, known: Known) -> str:
    command, _, rest = inside.strip().partition(" ")
    rest = rest.strip()
    functions = _functions(known)
    if command == "eval":
        return evaluate(rest, known.arguments, functions)
    if command == "optenv":
        name, _, default = rest.partition(" ")
        return known.environment.get(_one(command, name), default.strip())
    if command == "dirname":
        return known.folder
    command = {"var": "arg"}.get(command, command)  # as ROS 2 has it
    if command not in functions:
        hint = did_you_mean(command, _COMMANDS) or f"there are {', '.join(_COMMANDS)}"
        raise UsageError(f"there is no '$({command} ...)'", hint)
    return functions[command](_one(command, rest))


_COMMANDS = ("arg", "env", "optenv", "find", "anon", "dirname", "eval")


def _one(command: str, words: str) -> str:
    if not words or len(words.split()) > 1:
        form = f"optenv {words}" if command == "env" and words else f"{command} NAME"
        raise UsageError(f"'$({command} {words})' needs one name", f"write $({form})")
    return words


def _functions(known: Known) -> Functions:
    def argument(name: str) -> str:
        if name not in known.arguments:
            hint = did_you_mean(name, known.arguments) or "declare it by arg before it is used"
            raise UsageError(f"there is no argument '{name}'", hint)
        return known.arguments[name]

    def variable(name: str) -> str:
        if name not in known.environment:
            raise UsageError(
                f"the environment variable {name} is not set", f"or write $(optenv {name} DEFAULT)"
            )
        return known.environment[name]

    def anonymous(name: str) -> str:
        return known.names.setdefault(name, f"{name}_{secrets.token_hex(4)}")

    return {"arg": argument, "env": variable, "find": known.find_package, "anon": anonymous}
