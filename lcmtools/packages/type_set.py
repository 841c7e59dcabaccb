"""A set of types: which of those in some files can be used.

Belongs here: precedence, problems of types that need others, the pairs of services, fingerprints.
Must not know where the files are, or Python's classes.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import prod

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.type_source import Problem
from lcmtools.packages.expansion import Expansion, TooManyFields
from lcmtools.packages.lcm_parser import LcmField
from lcmtools.packages.placed_type import FileTypes, PlacedType
from lcmtools.packages.type_hints import unknown_type
from lcmtools.packages.versions import version_place
from lcmtools.wire.datagram import MESSAGE_MAX

_MOST_HINTS = 50  # problems with a hint at a similar type, which takes milliseconds to find
_MOST_ELEMENTS = 10_000_000  # of a new message, which Python creates in half a second
_MASK = (1 << 64) - 1


@dataclass(slots=True)
class TypeSet:
    """The types of some files; ``shipped`` has the fingerprints of others that they may contain.

    If two files have the same type, the first takes precedence.
    """

    shipped: Mapping[str, int]
    types: dict[str, PlacedType] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    places: list[str] = field(default_factory=list)  # folders and files with other definitions
    _parts: dict[str, list[LcmField]] = field(default_factory=dict)  # fields of other types
    _numbers: dict[str, int] = field(default_factory=dict)  # fingerprints that are known

    def add(self, types: FileTypes) -> None:
        """Add the types of one file."""
        self.problems += types.problems
        for one in types.types:
            if one.file.package and self._is_own_primitive(one):
                self.notes[one.name] = f"{one.name} is lcmtools' own, not that of {one.file.where}"
                continue
            first = self.types.setdefault(one.name, one)
            if first is not one and one.wire != first.wire:
                where = f"{first.file.where} and in {one.file.where}"
                self.notes[one.name] = f"{one.name} is defined differently in {where}"
                place = str(version_place(one.file.path, first.file.path))
                if place not in self.places:
                    self.places.append(place)

    def check(self) -> None:
        """Remove the types that cannot be used."""
        for name, one in self.types.items():
            self._parts[name] = [part for part in one.type.fields if part.type not in PRIMITIVES]
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
        names = sorted(name for name, one in self.types.items() if one.type.values is None)
        return {name: self._number(name, ())[0] for name in names}

    def _number(self, name: str, above: tuple[str, ...]) -> tuple[int, bool]:
        """Return a type's hash below others, and whether that is its hash everywhere.

        As in LCM, a type counts as 0 within itself.
        """
        one = self.types.get(name)
        if one is None:
            return self.shipped[name], True
        if one.type.values is not None:
            return one.type.number, True
        if name in above:
            return 0, False
        if name in self._numbers:
            return self._numbers[name], True
        parts = [self._number(part.type, (*above, name)) for part in self._parts[name]]
        total = one.type.number + sum(number for number, _ in parts) & _MASK
        total = (total << 1 | total >> 63) & _MASK
        if is_fixed := all(fixed for _, fixed in parts):
            self._numbers[name] = total
        return total, is_fixed

    def _drop_exploding(self) -> None:
        """Remove types with too many fields, before anything follows all of these."""
        parts = {name: [part.type for part in parts] for name, parts in self._parts.items()}
        counts = {name: len(one.type.fields) for name, one in self.types.items()}
        expansion = Expansion(parts, counts)
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
            name: {part.type for part in self._parts[name] if is_fixed(part.sizes)}
            for name in self.types
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
            for one, part in incomplete:
                missing = part.type
                if missing in cause:
                    first = self.problems[cause[missing]]
                    self.problems[cause[missing]] = first._replace(lost=(*first.lost, one.name))
                else:
                    near = known if len(self.problems) < _MOST_HINTS else set()
                    self.problems.append(unknown_type(one, part, near))
                cause[one.name] = cause.get(missing, len(self.problems) - 1)
                del self.types[one.name]

    def _refuse(self, one: PlacedType, what: str, hint: str) -> None:
        file = one.file.where
        self.problems.append(Problem(file, 0, what, hint, one.name, (one.name,)))
        del self.types[one.name]

    def _elements(self, name: str, counts: dict[str, int]) -> int:
        """Return the least number of elements of a type's messages; ``counts`` has known ones."""
        one = self.types.get(name)
        if name not in counts and one and one.type.values is None:
            counts[name] = 1  # while it is being counted, for a type that contains itself
            count = len(one.type.fields)
            for part in one.type.fields:
                if part.sizes or part.nested:
                    each = self._elements(part.type, counts) if part.nested else 1
                    count += prod(map(int, part.sizes)) * each - 1 if is_fixed(part.sizes) else -1
            counts[name] = count
        return counts.get(name, 1)

    def _is_own_primitive(self, one: PlacedType) -> bool:
        """Return True for ROS 1's std_msgs/Time and Duration, whose only field is the primitive."""
        return list(one.type.nested()) == [one.name] and one.name in self.shipped

    def _missing(self, one: PlacedType) -> tuple[PlacedType, LcmField] | None:
        missing = (part for part in self._parts[one.name] if part.type not in self.types)
        return next(((one, part) for part in missing if part.type not in self.shipped), None)


def type_set(files: Iterable[FileTypes], shipped: Mapping[str, int]) -> TypeSet:
    """Return the types of files in order of precedence, as far as they can be used."""
    made = TypeSet(shipped)
    for types in files:
        made.add(types)
    made.check()
    return made


def is_fixed(sizes: Iterable[int | str]) -> bool:
    """Return True for an array whose sizes are numbers, and for a single value."""
    return all(isinstance(size, int) for size in sizes)


def _reached(name: str, inner: Mapping[str, set[str]]) -> set[str]:
    """Return the types that a type contains, at any depth."""
    found: set[str] = set()
    new = inner[name]
    while new:
        found |= new
        new = {part for one in new for part in inner.get(one, ())} - found
    return found
