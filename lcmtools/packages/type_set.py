"""A set of types: those in some files that can be used, by name and by fingerprint.

Belongs here: precedence, versions, problems of types that need others, the pairs of services,
fingerprints. Must not know where the files are, or Python's classes.

Several files may define a type. A field's type is the definition that is nearest to the field's
own file; a name alone means that of the first file. Equal definitions are one type.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from itertools import takewhile
from math import prod
from typing import NamedTuple

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.type_source import Problem, version_name
from lcmtools.names import closest
from lcmtools.packages.expansion import Expansion, TooManyFields
from lcmtools.packages.lcm_parser import LcmField, LcmType
from lcmtools.packages.placed_type import FileTypes, PlacedType
from lcmtools.wire.datagram import MESSAGE_MAX

_MOST_HINTS = 50  # problems with a hint at a similar type, which takes milliseconds to find
_MOST_ELEMENTS = 10_000_000  # of a new message, which Python creates in half a second
_MASK = (1 << 64) - 1
_LCM_NAMES = {
    "bool": "boolean",
    "str": "string",
    "int": "int32_t",
    "uint": "int32_t",
    **dict.fromkeys(("char", "uint8", "uint8_t"), "byte"),
    **dict.fromkeys(("float32", "float32_t"), "float"),
    **dict.fromkeys(("float64", "float64_t"), "double"),
    **{f"int{bits}": f"int{bits}_t" for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": f"int{bits}_t" for bits in (16, 32, 64)},
    **{f"uint{bits}_t": f"int{bits}_t" for bits in (16, 32, 64)},
}
"""Type names of C, Python and ROS, and LCM's names for them."""
_NEARLY_THE_SAME = 0.8  # similarity of two letters exchanged; point_t and int8_t have less


class UsableType(NamedTuple):
    """A type that can be used; ``parts`` are the keys of its fields' types, by their names."""

    type: LcmType
    file: str
    number: int  # its fingerprint; of an enum, its hash
    parts: Mapping[str, str]


class TypeSet:
    """The types of files, in order of precedence, as far as they can be used.

    ``shipped`` has the fingerprints of others that they may contain.
    """

    def __init__(self, files: Iterable[FileTypes], shipped: Mapping[str, int]) -> None:
        self.problems: list[Problem] = []
        self.notes: dict[str, str] = {}
        self._shipped = shipped
        self._types: dict[int, PlacedType] = {}  # by their place, until they are refused
        self._named: defaultdict[str, list[int]] = defaultdict(list)
        self._parts: dict[int, list[tuple[LcmField, int]]] = {}  # with their places; -1 if shipped
        self._numbers: dict[int, int] = {}  # fingerprints that are known
        for file in files:
            self._add(file)
        for place, one in self._types.items():
            parts = [part for part in one.type.fields if part.type not in PRIMITIVES]
            self._parts[place] = [(part, self._nearest(place, part.type)) for part in parts]
        self._drop_exploding()
        self._drop_too_large()
        self._drop_endless()
        self._drop_incomplete()
        self.types = self._usable()
        """The types by key: the name, and for versions that it does not mean ``version_name``."""

    def services(self) -> list[str]:
        """The names of the services, sorted."""
        ends = "_Request", "_Response"
        requests = sorted(one.removesuffix(ends[0]) for one in self.types if one.endswith(ends[0]))
        known = self.types.keys()
        return [name for name in requests if name + ends[1] in known and name not in known]

    def _add(self, file: FileTypes) -> None:
        self.problems += file.problems
        for one in file.types:
            others = self._named[one.name]
            if one.file.package and self._is_own_primitive(one):
                self.notes[one.name] = f"{one.name} is lcmtools' own, not that of {one.file.where}"
            elif not (others and one.wire == self._types[others[0]].wire and one.is_plain):
                others.append(len(self._types))
                self._types[len(self._types)] = one

    def _is_own_primitive(self, one: PlacedType) -> bool:
        """Return True for ROS 1's std_msgs/Time and Duration, whose only field is the primitive."""
        return [part.type for part in one.type.fields] == [one.name] and one.name in self._shipped

    def _nearest(self, place: int, name: str) -> int:
        """Return the place of the definition of a type nearest to another; -1 if there is none."""
        known = self._named.get(name, [])
        if len(known) < 2:  # noqa: PLR2004 - a choice
            return known[0] if known else -1
        own = self._types[place].file.where.split("/")

        def shared(other: int) -> int:
            pairs = zip(own, self._types[other].file.where.split("/"), strict=False)
            return len([*takewhile(lambda pair: pair[0] == pair[1], pairs)])

        return max(known, key=shared)

    def _drop_exploding(self) -> None:
        """Remove types with too many fields, before anything follows all of these."""
        parts = {place: [part for _, part in parts] for place, parts in self._parts.items()}
        counts = {place: len(one.type.fields) for place, one in self._types.items()}
        expansion = Expansion(parts, counts)
        for place, one in list(self._types.items()):
            try:
                expansion.fields(place)
            except TooManyFields as error:  # noqa: PERF203 - each type fails on its own
                self._refuse(place, f"{one.name} {error}", "")

    def _drop_too_large(self) -> None:
        """Remove types with too many elements: Python would create them all."""
        counts: dict[int, int] = {}
        for place, one in list(self._types.items()):
            count = self._elements(place, counts)
            if count > _MOST_ELEMENTS:
                what = f"{one.name} has {count} elements, more than {_MOST_ELEMENTS}"
                if count > MESSAGE_MAX:
                    what = f"{one.name} is larger than LCM's {MESSAGE_MAX} bytes"
                self._refuse(place, what, "give the array's size in a field:  double values[size];")

    def _elements(self, place: int, counts: dict[int, int]) -> int:
        """Return the least number of elements of a type's messages; ``counts`` has known ones."""
        one = self._types.get(place)
        if place not in counts and one and one.type.values is None:
            counts[place] = 1  # while it is being counted, for a type that contains itself
            inner = {part.name: self._elements(at, counts) for part, at in self._parts[place]}
            count = len(one.type.fields)
            for part in one.type.fields:
                if part.sizes or part.name in inner:
                    each = inner.get(part.name, 1)
                    count += prod(map(int, part.sizes)) * each - 1 if part.is_fixed else -1
            counts[place] = count
        return counts.get(place, 1)

    def _drop_endless(self) -> None:
        """Remove types that contain themselves, other than in an array of variable size."""
        inner = {
            place: {at for part, at in self._parts[place] if part.is_fixed} for place in self._types
        }
        while ends := [place for place, parts in inner.items() if not parts & inner.keys()]:
            for place in ends:
                del inner[place]
        for place in inner:
            if place in _reached(place, inner):
                hint = "only an array of variable size can hold its own type"
                self._refuse(place, f"{self._types[place].name} contains itself", hint)

    def _drop_incomplete(self) -> None:
        """Remove types with fields of unknown types, until all are complete.

        What is lost with another type is added to that one's problem: the first cause.
        """
        cause = {name: n for n, problem in enumerate(self.problems) for name in problem.lost}
        while incomplete := [(at, part) for at in self._types if (part := self._missing(at))]:
            known = {*(one.name for one in self._types.values()), *self._shipped}
            for place, part in incomplete:
                one = self._types[place]
                if part.type in cause:
                    first = self.problems[cause[part.type]]
                    self.problems[cause[part.type]] = first._replace(lost=(*first.lost, one.name))
                else:
                    near = known if len(self.problems) < _MOST_HINTS else set()
                    self.problems.append(_unknown_type(one, part, near))
                cause[one.name] = cause.get(part.type, len(self.problems) - 1)
                self._remove(place)

    def _missing(self, place: int) -> LcmField | None:
        """Return the first field whose type is neither in the set nor shipped."""
        parts = self._parts[place]
        for number, (part, at) in enumerate(parts):
            if at not in self._types:
                if (at := self._nearest(place, part.type)) < 0 and part.type not in self._shipped:
                    return part
                parts[number] = part, at
        return None

    def _refuse(self, place: int, what: str, hint: str) -> None:
        one = self._types[place]
        self.problems.append(Problem(one.file.where, 0, what, hint, one.name, (one.name,)))
        self._remove(place)

    def _remove(self, place: int) -> None:
        self._named[self._types[place].name].remove(place)
        del self._types[place]

    def _usable(self) -> dict[str, UsableType]:
        """Return the types by their keys, equal ones once."""
        keys: dict[int, str] = {}
        for name in sorted(self._named):
            for place in self._named[name]:
                keys[place] = self._key(name, place, keys)
        found: dict[str, UsableType] = {}
        for place, key in keys.items():
            if key not in found:
                one = self._types[place]
                parts = {part.type: keys.get(at, part.type) for part, at in self._parts[place]}
                number = self._number(place, ())[0]
                found[key] = UsableType(one.type, one.file.where, number, parts)
        return found

    def _key(self, name: str, place: int, keys: Mapping[int, str]) -> str:
        """Return the key of a definition; it is that of an earlier one of the same type."""
        first, *_ = earlier = self._named[name]
        one, number = self._types[place], self._number(place, ())[0]
        for other in earlier[: earlier.index(place)]:
            same = self._types[other].type.values == one.type.values
            if same and self._number(other, ())[0] == number:
                return keys[other]
        if place == first:
            return name
        where = f"{self._types[first].file.where} and in {one.file.where}"
        self.notes[name] = f"{name} is defined differently in {where}"
        return version_name(name, number if one.type.values is None else place)

    def _number(self, place: int, above: tuple[int, ...]) -> tuple[int, bool]:
        """Return a type's hash below others, and whether that is its hash everywhere.

        As in LCM, a type counts as 0 within itself.
        """
        one = self._types[place].type
        if one.values is not None:
            return one.number, True
        if place in above:
            return 0, False
        if place in self._numbers:
            return self._numbers[place], True
        total, is_everywhere = one.number, True
        for part, at in self._parts[place]:
            number, fixed = self._shipped.get(part.type, 0), True
            if at >= 0:
                number, fixed = self._number(at, (*above, place))
            total, is_everywhere = total + number, is_everywhere and fixed
        total &= _MASK
        total = (total << 1 | total >> 63) & _MASK
        if is_everywhere:
            self._numbers[place] = total
        return total, is_everywhere


def _reached(place: int, inner: Mapping[int, set[int]]) -> set[int]:
    """Return the types that a type contains, at any depth."""
    found: set[int] = set()
    new = inner[place]
    while new:
        found |= new
        new = {part for one in new for part in inner.get(one, ())} - found
    return found


def _unknown_type(one: PlacedType, field: LcmField, known: set[str]) -> Problem:
    """Return the problem for a type with a field of an unknown type."""
    missing = field.type
    short = missing.rpartition("/")[2]
    near = _LCM_NAMES.get(short) or _like_primitive(short) or _like(missing, one, known)
    same = missing.rpartition("/")[0] == one.name.rpartition("/")[0]
    written = short if same else missing.replace("/", ".")
    if one.file.package:
        written, near = written.replace(".", "/"), near.replace(".", "/")
    suffix = ".msg" if one.file.package else ".lcm"
    hint = f"did you mean {near}?" if near else f"name the folder of its {suffix} file too"
    what = f"{one.name}: unknown type '{written}'"
    return Problem(one.file.where, field.line, what, hint, one.name, (one.name,))


def _like(missing: str, one: PlacedType, known: set[str]) -> str:
    """Return the type that was probably meant, in .lcm notation; "" if none is similar."""
    package, _, short = missing.rpartition("/")
    shorts = {name.rpartition("/")[2]: name for name in sorted(known) if "/" in name or not package}
    inside = {name.rpartition("/")[2]: name for name in known if name.rpartition("/")[0] == package}
    if near := closest(short, inside):
        found = inside[near[0]]
    elif package == one.name.rpartition("/")[0]:  # written without a package
        found = next((shorts[name] for name in closest(short, shorts)), "")
    else:
        found = shorts.get(short) or next(iter(closest(missing, known)), "")
    return found.replace("/", ".")


def _like_primitive(name: str) -> str:
    """Return the primitive type of LCM that is misspelled; "" if none is."""
    from difflib import get_close_matches

    names = [*PRIMITIVES, *_LCM_NAMES] if name.islower() else []
    near = get_close_matches(name, names, 1, _NEARLY_THE_SAME)
    return _LCM_NAMES.get(near[0], near[0]) if near else ""
