"""The rows of a check's result, one a question."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Row:
    """One thing that was looked at.

    Attributes:
        what: In a few words.
        wanted: What the lab asks for, with its unit.
        measured: What was seen, with its unit.
        is_ok: Whether the one is as good as the other.
        hint: What to look at next; "" where all is well.
    """

    what: str
    wanted: str
    measured: str
    is_ok: bool
    hint: str = ""


def row(what: str, wanted: str, measured: str, *, is_ok: bool, hint: str) -> Row:
    """A row whose hint counts only where something is wrong."""
    return Row(what, wanted, measured, is_ok, "" if is_ok else hint)
