"""Types that can be imported, as a value: names, fingerprints, and what is wrong with others.

Belongs here: plain values only.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from lcmtools.errors import InvalidFile


@dataclass(frozen=True, slots=True)
class Problem:
    """Why a file, or one type in it, cannot be used.

    Attributes:
        file: Its path, in full.
        line: Where in it, from 1 on; 0 where that is not known.
        what: What is wrong.
        hint: What to do about it, or "".
        type: The type that is meant; "" for the whole file.
    """

    file: str
    line: int
    what: str
    hint: str = ""
    type: str = ""

    def error(self) -> InvalidFile:
        """The same as an error to raise."""
        line = f":{self.line}" if self.line else ""
        return InvalidFile(f"{shown(self.file)}{line}: {self.what}", self.hint)

    def concerns(self, name: str) -> bool:
        """Whether it may be the reason why the type ``package/Name`` is not there."""
        if self.type:
            return name in (self.type, self.type.rpartition("/")[2])
        package, _, short = name.rpartition("/")
        path = Path(self.file)
        return path.stem in (short, f"{package}_{short}") and (
            not package or package in (*path.parts, path.stem.removesuffix(f"_{short}"))
        )


@dataclass(frozen=True, slots=True)
class TypeSource:
    """A place that generated classes are imported from.

    Attributes:
        prefix: The module above the packages, as given to lcm-gen ("lcmtools.types").
        fingerprints: Every type's name ("geometry_msgs/Twist") and fingerprint.
        services: Names of the service pairs ("std_srvs/Trigger").
        files: The .lcm file of each type, where that is known.
        problems: What cannot be used, and why.
        notes: Types that another file has too, by their name, with a sentence that says so.
    """

    prefix: str
    fingerprints: Mapping[str, int]
    services: Sequence[str] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    problems: Sequence[Problem] = ()
    notes: Mapping[str, str] = field(default_factory=dict)


def shown(path: str | Path) -> str:
    """A path as a person reads it: from the current folder on, where it is below that."""
    try:
        return str(Path(path).relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path)
