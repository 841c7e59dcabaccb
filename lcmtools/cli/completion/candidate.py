"""A word that could stand where the cursor is, or that files could."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Candidate:
    """A word.

    Attributes:
        value: The whole word, as the command is to get it.
        help: What it is, for shells that show that; "" for nothing.
        is_open: More may follow without a blank, as after a package's name and slash.
    """

    value: str
    help: str = ""
    is_open: bool = False


FILES = Candidate("")
"""Stands for the files that the shell itself completes."""


def shown(candidates: list[Candidate], word: str) -> list[Candidate]:
    """The candidates that begin as the word does, each once.

    What has control characters in it, as a channel's name may, is no candidate: it would be acted
    upon by the terminal, or by the shell as a line of its own.
    """
    found = {
        one.value: one
        for one in reversed(candidates)
        if one is not FILES and one.value.startswith(word) and one.value.isprintable()
    }
    return list(reversed(found.values()))
