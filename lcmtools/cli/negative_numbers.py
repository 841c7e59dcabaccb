"""Click commands that accept "-1" and "-0.5" as arguments."""

import re
from collections.abc import Collection, Iterator, Sequence
from itertools import pairwise
from typing import ClassVar

import click

from lcmtools.cli.completion.line import is_value

WITHOUT_END = "forever"  # the value of an option of ``may_stand_alone`` that is given alone

_ONCE = re.compile("-1[a-z]*", re.IGNORECASE)  # "-1v" is two options
_WORDS = f"{__name__}.words"


class CommandWithWords(click.Command):
    """A command whose arguments may be negative numbers or YAML.

    A word after an option with a value is always that value. If the command has an option -1, the
    first other -1 is that option, and "-- -1" the value.
    """

    may_stand_alone: ClassVar[tuple[str, ...]] = ()  # options with "=" and a value, or without

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line."""
        ctx.meta[_WORDS] = tuple(args)
        rest = super().parse_args(ctx, list(self._shielded(args)))
        for name in (one.name or "" for one in self.params if isinstance(one, click.Argument)):
            value = ctx.params[name]
            if isinstance(value, (str, tuple)):
                ctx.params[name] = bare(value) if isinstance(value, str) else (*map(bare, value),)
        return rest

    def _shielded(self, words: Sequence[str]) -> Iterator[str]:
        options = self._options_with_value()
        is_once = any("-1" in one.opts for one in self.params)
        for before, word in pairwise(["", *words]):
            if before in options:
                yield word
            elif word in self.may_stand_alone:
                yield f"{word}={WITHOUT_END}"
            elif is_once and _ONCE.fullmatch(word):
                is_once = False
                yield word
            else:
                yield shielded(word)

    def _options_with_value(self) -> Collection[str]:
        options = (p for p in self.params if isinstance(p, click.Option) and not p.is_flag)
        return {name for option in options for name in option.opts} - set(self.may_stand_alone)


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


def typed_words() -> Sequence[str]:
    """Return the words of the running command line, as they were typed."""
    words: Sequence[str] = click.get_current_context().meta[_WORDS]
    return words
