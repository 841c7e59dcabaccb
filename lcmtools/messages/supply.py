"""The supply of users' own types, which the edge of the program sets."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:  # imported at the first look-up
    from pathlib import Path

    from lcmtools.messages.type_source import TypeSource


class Supply(Protocol):
    """A user's own types, found on request; None if there are none."""

    def workspace(self) -> "TypeSource | None":
        """Types that take precedence over the shipped ones."""

    def installed(self) -> "TypeSource | None":
        """Types for names that are otherwise unknown."""

    def add_start(self, folder: "Path") -> None:
        """Also search the workspace of another folder."""

    def recorded_names(self, fingerprint: int) -> "Sequence[str]":
        """Return the names under which logs have stored types with this fingerprint."""

    def recorded(self) -> "Sequence[TypeSource]":
        """The types stored with each log, for its messages if they are otherwise unknown."""


_make: Callable[[], Supply] | None = None
_supply: Supply | None = None


def set_supply(make: Callable[[], Supply] | None) -> None:
    """Set the supply of users' types for this process; it is created at the first look-up."""
    global _make, _supply
    _make, _supply = make, None


def current_supply() -> Supply | None:
    """Return the supply of users' types; None if none has been set."""
    global _supply  # noqa: PLW0603
    if _supply is None and _make is not None:
        _supply = _make()
    return _supply


def has_supply() -> bool:
    """Return True if the edge of the program has set a supply."""
    return _make is not None
