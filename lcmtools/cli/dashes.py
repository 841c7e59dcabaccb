"""Words that begin with "-" and are no options: negative numbers, and documents of YAML.

Belongs here: telling them apart, and how they pass a parser that takes them for options. Must not
import click, for the sake of completion.
"""

import re


class Dashes:
    """What a command takes for a value although it begins with "-".

    Args:
        but: What is none, as a regular expression of the whole word.
    """

    def __init__(self, but: str = "") -> None:
        no = f"(?!{but}$)" if but else ""
        value = rf"{no}-(\.?\d|\.?inf|\.?nan\b|\s|--(?=\s))"
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
