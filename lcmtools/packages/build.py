"""Deciding which of the types in .lcm files can be used.

Belongs here: precedence, problems of types that need others, the pairs of services, fingerprints.
Must not know the source of the files or the place of the result.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import prod

from lcmtools.messages.type_source import Problem
from lcmtools.packages.expansion import Expansion, TooManyFields
from lcmtools.packages.generated import unknown_type
from lcmtools.packages.unit import Generated, Output
from lcmtools.packages.versions import version_place
from lcmtools.wire.datagram import MESSAGE_MAX

_MOST_HINTS = 50  # problems with a hint at a similar type, which takes milliseconds to find
_MOST_ELEMENTS = 10_000_000  # of a new message, which Python creates in half a second
_MASK = (1 << 64) - 1


@dataclass(slots=True)
class Build:
    """The types of some files; ``shipped`` has the fingerprints of others that they may contain.

    If two files have the same type, the first takes precedence.
    """

    shipped: Mapping[str, int]
    types: dict[str, Generated] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    places: list[str] = field(default_factory=list)  # folders and files with other definitions
    _numbers: dict[str, int] = field(default_factory=dict)  # fingerprints that are known

    def add(self, output: Output) -> None:
        """Add the types of one file."""
        self.problems += output.problems
        for one in output.types:
            if one.file.package and self._is_own_primitive(one):
                self.notes[one.name] = f"{one.name} is lcmtools' own, not that of {one.file.path}"
                continue
            first = self.types.setdefault(one.name, one)
            if (one.tables, one.values) != (first.tables, first.values):
                where = f"{first.file.path} and in {one.file.path}"
                self.notes[one.name] = f"{one.name} is defined differently in {where}"
                place = str(version_place(one.file.path, first.file.path))
                if place not in self.places:
                    self.places.append(place)

    def check(self) -> None:
        """Remove the types that cannot be used."""
        self._drop_exploding()
        self._drop_too_large()
        self._drop_endless()
        self._drop_incomplete()

    def services(self) -> list[str]:
        """The names of the services, sorted."""
        requests = [one.removesuffix("_Request") for one in self.types if one.endswith("_Request")]
        return [
            name
            for name in sorted(requests)
            if f"{name}_Response" in self.types and name not in self.types
        ]

    def fingerprints(self) -> dict[str, int]:
        """The fingerprint of each message type; an enum is not a message."""
        names = sorted(name for name, one in self.types.items() if one.tables is not None)
        return {name: self._number(name, ())[0] for name in names}

    def _number(self, name: str, above: tuple[str, ...]) -> tuple[int, bool]:
        """Return a type's hash below others, and whether that is its hash everywhere.

        As in LCM, a type counts as 0 within itself.
        """
        one = self.types.get(name)
        if one is None:
            return self.shipped[name], True
        if one.tables is None:
            return one.number, True
        if name in above:
            return 0, False
        if name in self._numbers:
            return self._numbers[name], True
        parts = [self._number(part, (*above, name)) for part in one.nested()]
        total = one.number + sum(number for number, _ in parts) & _MASK
        total = (total << 1 | total >> 63) & _MASK
        if is_fixed := all(fixed for _, fixed in parts):
            self._numbers[name] = total
        return total, is_fixed

    def _drop_exploding(self) -> None:
        """Remove types with too many fields, before anything follows all of these."""
        parts = {name: [part for part, _ in one.fields()] for name, one in self.types.items()}
        expansion = Expansion(parts)
        for one in list(self.types.values()):
            try:
                expansion.fields(one.name)
            except TooManyFields as error:  # noqa: PERF203 - each type fails on its own
                self._refuse(one, f"{one.name} {error}", "")

    def _drop_too_large(self) -> None:
        """Remove types with too many elements: Python would create them all."""
        counts: dict[str, int] = {}
        for one in list(self.types.values()):
            count = self._elements(one.name, counts)
            if count > _MOST_ELEMENTS:
                what = f"{one.name} has {count} elements, more than {_MOST_ELEMENTS}"
                if count > MESSAGE_MAX:
                    what = f"{one.name} is larger than LCM's {MESSAGE_MAX} bytes"
                self._refuse(one, what, "give the array's size in a field:  double values[size];")

    def _drop_endless(self) -> None:
        """Remove types that contain themselves, other than in an array of variable size."""
        inner = {
            name: {part for part, sizes in one.fields() if not _is_variable(sizes)}
            for name, one in self.types.items()
        }
        while ends := [name for name, parts in inner.items() if not parts & inner.keys()]:
            for name in ends:
                del inner[name]
        for name in inner:
            if name in _reached(name, inner):
                hint = "only an array of variable size can hold its own type"
                self._refuse(self.types[name], f"{name} contains itself", hint)

    def _drop_incomplete(self) -> None:
        """Remove types with fields of unknown types, until all are complete.

        What is lost with another type is added to that one's problem: the first cause.
        """
        cause = {name: n for n, problem in enumerate(self.problems) for name in problem.lost}
        while incomplete := [found for one in self.types.values() if (found := self._missing(one))]:
            known = {*self.types, *self.shipped}
            for one, missing in incomplete:
                if missing in cause:
                    first = self.problems[cause[missing]]
                    self.problems[cause[missing]] = first._replace(lost=(*first.lost, one.name))
                else:
                    near = known if len(self.problems) < _MOST_HINTS else set()
                    self.problems.append(unknown_type(one, missing, near))
                cause[one.name] = cause.get(missing, len(self.problems) - 1)
                del self.types[one.name]

    def _refuse(self, one: Generated, what: str, hint: str) -> None:
        file = str(one.file.path)
        self.problems.append(Problem(file, 0, what, hint, one.name, (one.name,)))
        del self.types[one.name]

    def _elements(self, name: str, counts: dict[str, int]) -> int:
        """Return the least number of elements of a type's messages; ``counts`` has known ones."""
        one = self.types.get(name)
        if name not in counts and one and one.tables:
            counts[name] = 1  # while it is being counted, for a type that contains itself
            counts[name] = sum(
                prod(map(int, sizes)) * (self._elements(part, counts) if part else 1)
                for part, sizes in one.fields()
                if not _is_variable(sizes)
            )
        return counts.get(name, 1)

    def _is_own_primitive(self, one: Generated) -> bool:
        """Return True for ROS 1's std_msgs/Time and Duration, whose only field is the primitive."""
        return list(one.nested()) == [one.name] and one.name in self.shipped

    def _missing(self, one: Generated) -> tuple[Generated, str] | None:
        missing = (name for name in one.nested() if name not in self.types)
        return next(((one, name) for name in missing if name not in self.shipped), None)


def build(outputs: Iterable[Output], shipped: Mapping[str, int]) -> Build:
    """Return the types of files in order of precedence, as far as they can be used."""
    made = Build(shipped)
    for output in outputs:
        made.add(output)
    made.check()
    return made


def _is_variable(sizes: Iterable[int | str]) -> bool:
    return any(isinstance(size, str) for size in sizes)


def _reached(name: str, inner: Mapping[str, set[str]]) -> set[str]:
    """Return the types that a type contains, at any depth."""
    found: set[str] = set()
    new = inner[name]
    while new:
        found |= new
        new = {part for one in new for part in inner.get(one, ())} - found
    return found
