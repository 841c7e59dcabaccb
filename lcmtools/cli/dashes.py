"""Words that begin with "-" and are no options: negative numbers, and documents of YAML.

Must not import click, for the sake of completion.
"""

import re

_VALUE = r"-(\.?\d|\.?inf|\.?nan\b|\s|--(?=\s))"
_IS_VALUE = re.compile(_VALUE, re.IGNORECASE)
_IS_SHIELDED = re.compile(f"^ (?={_VALUE})", re.IGNORECASE)


def is_value(word: str) -> bool:
    """Return whether a word is a value and no option, although it begins with "-"."""
    return _IS_VALUE.match(word) is not None


def shielded(word: str) -> str:
    """Return a word as click takes it for what it is: a value with a blank before it."""
    return f" {word}" if is_value(word) else word


def bare(word: str) -> str:
    """Return a word without its shield."""
    return _IS_SHIELDED.sub("", word)
