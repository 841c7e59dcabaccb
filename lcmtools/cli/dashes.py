"""Words that begin with "-" and are no options: negative numbers, and lists of YAML.

Belongs here: telling them apart, and how they pass a parser that takes them for options. Must not
import click, for the sake of completion.
"""

import re


class Dashes:
    """What a command takes for a value although it begins with "-".

    Args:
        also: More that is a value, as a regular expression; what follows "-".
        but: What is none, as a regular expression of the whole word.
    """

    def __init__(self, also: str = "", but: str = "") -> None:
        more = f"|{also}" if also else ""
        no = f"(?!{but}$)" if but else ""
        value = rf"{no}-(\.?\d|\.?inf|\s{more})"
        self._value = re.compile(value, re.IGNORECASE)
        self._shielded = re.compile(f"^ (?={value})", re.IGNORECASE)

    def is_value(self, word: str) -> bool:
        """Whether a word is a value and no option."""
        return self._value.match(word) is not None

    def shielded(self, word: str) -> str:
        """A word as a parser takes it for what it is: a value has a blank before it."""
        return f" {word}" if self.is_value(word) else word

    def bare(self, word: str) -> str:
        """A word without its shield."""
        return self._shielded.sub("", word)
