"""Sources of types as values: names, fingerprints, and the problems of files that lack them.

The supply of users' own types is set here by the edge of the program.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from lcmtools.errors import InvalidFile


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem that makes a file, or one type in it, unusable."""

    file: str  # its full path
    line: int  # from 1; 0 where it is unknown
    what: str
    hint: str = ""  # the remedy
    type: str = ""  # the type concerned; "" for the whole file

    def error(self) -> InvalidFile:
        """Return the problem as an error to raise."""
        line = f":{self.line}" if self.line else ""
        return InvalidFile(f"{shown(self.file)}{line}: {self.what}", self.hint)

    def concerns(self, name: str) -> bool:
        """Return True if it may be the reason why the type ``package/Name`` is missing."""
        if self.type:
            return name in (self.type, self.type.rpartition("/")[2])
        package, _, short = name.rpartition("/")
        path = Path(self.file)
        return path.stem in (short, f"{package}_{short}") and (
            not package or package in (*path.parts, path.stem.removesuffix(f"_{short}"))
        )


@dataclass(frozen=True, slots=True)
class TypeSource:
    """A place that generated classes are imported from; its tables are by types' full names."""

    prefix: str  # the module above the packages, as given to lcm-gen ("lcmtools.types")
    fingerprints: Mapping[str, int]
    services: Sequence[str] = ()  # service pairs ("std_srvs/Trigger")
    files: Mapping[str, str] = field(default_factory=dict)  # .lcm files, where they are known
    problems: Sequence[Problem] = ()  # types and files that cannot be used
    notes: Mapping[str, str] = field(default_factory=dict)  # a sentence: another file has it too


def shown(path: str | Path) -> str:
    """A path as a person reads it: from the current folder on, where it is below that."""
    try:
        return str(Path(path).relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path)


class Supply(Protocol):
    """Types of a user's own, found on request; None where there are none."""

    def near(self) -> TypeSource | None:
        """Types that take precedence over the shipped ones."""

    def far(self) -> TypeSource | None:
        """Types for names that are not known otherwise."""


_make: Callable[[], Supply] | None = None
_supply: Supply | None = None


def set_supply(make: Callable[[], Supply] | None) -> None:
    """Set the supply of users' types for this process; it is made with the first look-up."""
    global _make, _supply
    _make, _supply = make, None


def supply() -> Supply | None:
    """The supply of users' types; None where the edge has set none."""
    global _supply  # noqa: PLW0603
    if _supply is None and _make is not None:
        _supply = _make()
    return _supply


def has_supply() -> bool:
    """Return True if the edge of the program has set a supply."""
    return _make is not None
