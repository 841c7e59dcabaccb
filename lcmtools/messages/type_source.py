"""Sources of types as values: names, fingerprints, and the problems of files that lack them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from lcmtools.errors import InvalidFile

SHIPPED = "lcmtools.types"
"""The package of the classes of lcmtools' own types."""

_FILES = (".lcm", ".msg", ".srv", ".action")
_MOST_NAMED = 3  # types that an error names


class Problem(NamedTuple):
    """A problem that makes a file, or one type in it, unusable."""

    file: str  # its full path
    line: int  # from 1; 0 if unknown
    what: str
    hint: str = ""  # the remedy
    type: str = ""  # the type concerned; "" for the whole file
    lost: Sequence[str] = ()  # the types that are unusable, this one's and those that contain it

    def error(self) -> InvalidFile:
        """Return the problem as an error to raise, with the types that it costs."""
        line = f":{self.line}" if self.line else ""
        others = [name for name in self.lost if name != self.type]
        path = Path(self.file)
        if path.suffix != ".lcm" or all(name.rpartition("/")[2] == path.stem for name in others):
            others = []  # the file's name says it
        more = f" and {len(others) - _MOST_NAMED} more" if len(others) > _MOST_NAMED else ""
        lost = f" (unusable: {', '.join(others[:_MOST_NAMED])}{more})" if others else ""
        return InvalidFile(f"{shown(self.file)}{line}: {self.what}{lost}", self.hint)

    @property
    def is_of_folder(self) -> bool:
        """True if it concerns a whole folder, so that any type may be missing because of it."""
        return not self.lost and Path(self.file).suffix not in _FILES

    def concerns(self, name: str) -> bool:
        """Return True if this is the reason why the type ``package/Name`` is missing.

        Of a file that cannot be read, the path decides.
        """
        if self.lost:
            return any(name in (one, one.rpartition("/")[2]) for one in self.lost)
        package, _, short = name.rpartition("/")
        path = Path(self.file)
        return path.stem in (short, f"{package}_{short}") and (
            not package or package in (*path.parts, path.stem.removesuffix(f"_{short}"))
        )


class TypeSource(NamedTuple):
    """A module from which classes are imported; its tables are by types' full names."""

    module: str  # the one above the packages ("lcmtools.types")
    fingerprints: Mapping[str, int]  # of several versions of a type, that of the first
    services: Sequence[str] = ()  # service pairs ("std_srvs/Trigger")
    files: Mapping[str, str] = MappingProxyType({})  # .lcm files, if known
    problems: Sequence[Problem] = ()  # types and files that cannot be used
    notes: Mapping[str, str] = MappingProxyType({})  # warnings: another file defines the type too
    versions: Mapping[str, Mapping[int, str]] = MappingProxyType({})  # files of others by number
    enums: Mapping[str, int] = MappingProxyType({})  # their hashes

    def numbers(self, name: str) -> dict[int, str]:
        """Return the files of a type's versions by fingerprint, that of the name alone first."""
        if name not in self.fingerprints:
            return {}
        return {self.fingerprints[name]: self.files.get(name, ""), **self.versions.get(name, {})}

    def names(self, number: int) -> list[str]:
        """Return the names of the types with a fingerprint."""
        found = [name for name, known in self.fingerprints.items() if known == number]
        return found + [name for name, others in self.versions.items() if number in others]


def version_name(name: str, number: int) -> str:
    """Return the name in a source's modules of a version that the name alone does not mean."""
    return f"{name}__{number:016x}"


def shown(path: str | Path) -> str:
    """Return a path for people: relative to the current folder if it is below that."""
    try:
        return str(Path(path).relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path)
