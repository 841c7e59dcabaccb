"""Click commands that accept "-1" and "-0.5" as arguments."""

import re
from collections.abc import Collection, Iterator, Sequence
from itertools import pairwise
from typing import ClassVar

import click

from lcmtools.cli.completion.line import is_value

WITHOUT_END = "forever"  # the value of an option of ``may_stand_alone`` that is given alone

_EXCLUDE_ONE = frozenset(("-r", "--rate", "-t", "--times"))
"""Options that conflict with -1 (``--once``)."""
_ONE_AND_MORE = re.compile("-1[a-z]+", re.IGNORECASE)  # "-1v" is two options
_ONE_VALUE = 3  # number of words: TOPIC, TYPE and the value
_VALUES_BEGIN = 2  # after TOPIC and TYPE
_ENDS_IN_ONE = f"{__name__}.ends_in_one"
_PLACE = f"{__name__}.place"


class CommandWithWords(click.Command):
    """A command whose arguments may be negative numbers or YAML.

    A word after an option with a value is always that value.
    """

    may_stand_alone: ClassVar[tuple[str, ...]] = ()  # options with "=" and a value, or without

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line."""
        rest = super().parse_args(ctx, list(self._shielded(args)))
        for name in (one.name or "" for one in self.params if isinstance(one, click.Argument)):
            value = ctx.params[name]
            if isinstance(value, (str, tuple)):
                ctx.params[name] = bare(value) if isinstance(value, str) else (*map(bare, value),)
        return rest

    def _shielded(self, words: Sequence[str]) -> Iterator[str]:
        options = self._options_with_value()
        for before, word in pairwise(["", *words]):
            if before in options:
                yield word
            elif word in self.may_stand_alone:
                yield f"{word}={WITHOUT_END}"
            else:
                yield self._shield(word)

    def _options_with_value(self) -> Collection[str]:
        options = (p for p in self.params if isinstance(p, click.Option) and not p.is_flag)
        return {name for option in options for name in option.opts} - set(self.may_stand_alone)

    def _shield(self, word: str) -> str:
        return shielded(word)


class CommandWithOnce(CommandWithWords):
    """A command with the option -1: the first -1 is the option, as in "rostopic pub -1".

    It is a value where the option cannot be meant: "-r 5 /speed std_msgs/Int32 -1".
    """

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line."""
        ctx.meta[_ENDS_IN_ONE] = args.count("-1") == 1 and args[-1] == "-1"
        free = self._free(args)
        plain = [word for word in free if word == "-1" or not word.startswith("-")]
        ctx.meta[_PLACE] = plain.index("-1") - _VALUES_BEGIN if "-1" in plain else -1
        return super().parse_args(ctx, args)

    def _shielded(self, words: Sequence[str]) -> Iterator[str]:
        options, free = self._options_with_value(), self._free(words)
        plain = [word for word in free if word == "-1" or not word.startswith("-")]
        one_is_value = (
            len(plain) == _ONE_VALUE and plain[-1] == "-1" and not _EXCLUDE_ONE.isdisjoint(free)
        )
        for before, word in pairwise(["", *words]):
            if before in options or (word == "-1" and not one_is_value):
                one_is_value = one_is_value or before not in options
                yield word
            else:
                yield self._shield(word)

    def _free(self, words: Sequence[str]) -> list[str]:
        """Return the words that are not values of options."""
        options = self._options_with_value()
        return [word for before, word in pairwise(["", *words]) if before not in options]

    def _shield(self, word: str) -> str:
        return word if _ONE_AND_MORE.fullmatch(word) else shielded(word)


class CommandWithWait(CommandWithWords):
    """A command with the option ``--wait``, which may have a value."""

    may_stand_alone = ("--wait",)


class CommandWithDeps(click.Command):
    """A command that takes ``--deps a b c`` as catkin and ros2 do: words up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the option before each of its words."""
        spread: list[str] = []
        option = ""
        for word in args:
            if word.startswith("-"):
                option = word if word in ("--deps", "--dependencies") else ""
                spread += [] if option else [word]
            else:
                spread += ["--deps", word] if option else [word]
        if option and args[-1] == option:
            spread.append(option)  # click reports the missing value
        return super().parse_args(ctx, spread)


def shielded(word: str) -> str:
    """Put a blank before a value that click would parse as an option."""
    return f" {word}" if is_value(word) else word


def bare(word: str) -> str:
    """Remove the blank that ``shielded`` has put before a word."""
    return word[1:] if word.startswith(" ") and is_value(word[1:]) else word


def ends_in_one() -> bool:
    """Return whether the command line ends in its only "-1": the option, or a value."""
    return bool(click.get_current_context().meta[_ENDS_IN_ONE])


def with_one(values: Sequence[str], count: int, *, excludes_option: bool) -> list[str] | None:
    """Return the values with the option -1 as one of them, if it stands where one is missing.

    ``count`` is the number of values that the type has. A single value may be a dict with all of
    them, which leaves -1 the option, unless others exclude it. None if -1 is the option.
    """
    place = click.get_current_context().meta[_PLACE]
    is_missing = len(values) + 1 == count and (len(values) > 1 or excludes_option)
    if place < 0 or not is_missing:
        return None
    return [*values[:place], "-1", *values[place:]]
