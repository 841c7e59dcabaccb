"""The types of a file, and its problems, as the set of types takes them."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.type_source import Problem
from lcmtools.packages.lcm_parser import LcmField, LcmType, SyntaxFault, declared, parse
from lcmtools.packages.ros_files import LcmSource, to_lcm
from lcmtools.packages.type_files import LcmFile

_MOST_PROBLEMS = 20  # of a file that are told

ParsedProblem = tuple[int, str, str, tuple[str, ...]]
"""A line, what is wrong there, the remedy, and the types that are lost."""


class Parsed(NamedTuple):
    """The types of a file's content, and its problems."""

    types: Sequence[LcmType]
    problems: Sequence[ParsedProblem] = ()

    def plain(self) -> tuple[object, ...]:
        """Return the same as values that ``marshal`` takes; see ``parsed_from``."""
        types = [
            (*one[:2], tuple(map(tuple, one.fields)), dict(one.constants), one.values)
            for one in self.types
        ]
        return types, [*self.problems]


def parsed_from(plain: tuple[Iterable[tuple], Sequence[ParsedProblem]]) -> Parsed:  # type: ignore[type-arg] # as stored
    """Return what ``Parsed.plain`` made plain."""
    types, problems = plain
    return Parsed(
        [
            LcmType(name, number, tuple(map(LcmField._make, fields)), constants, values)
            for name, number, fields, constants, values in types
        ],
        problems,
    )


class PlacedType(NamedTuple):
    """A type, and the file that defines it."""

    type: LcmType
    file: LcmFile

    @property
    def name(self) -> str:
        """Its name, "geometry_msgs/Twist"."""
        return self.type.name

    @property
    def is_plain(self) -> bool:
        """True if it has no fields of other types."""
        return all(field.type in PRIMITIVES for field in self.type.fields)

    @property
    def wire(self) -> tuple[object, ...]:
        """The parts that its messages depend on: fields without their lines, or values."""
        return [field[:3] for field in self.type.fields], self.type.values


class FileTypes(NamedTuple):
    """The types of one file, and its problems."""

    types: Sequence[PlacedType]
    problems: Sequence[Problem] = ()


def file_types(file: LcmFile, parsed: Parsed) -> FileTypes:
    """Return the types of a file with a content that has been parsed."""
    problems = [Problem(file.where, *rest[:3], "", rest[3]) for rest in parsed.problems]
    return FileTypes([PlacedType(one, file) for one in parsed.types], problems)


def parse_file(file: LcmFile) -> Parsed:
    """Return the types of a file, a .lcm file or a ROS file, which is translated first."""
    if not file.package:
        return _parsed(LcmSource(file.content.decode("utf-8", "replace"), [], {}, {}), ())
    source = to_lcm(file.path, file.content, file.package)
    named = f"{file.package}/{file.path.stem}"
    if source.problems:
        lost = (named, *declared(source.text)[0])
        found = [(one.line, one.what, one.hint, lost) for one in source.problems[:_MOST_PROBLEMS]]
        return Parsed([], found)
    return _parsed(source, (named,))


def _parsed(source: LcmSource, lost: tuple[str, ...]) -> Parsed:
    try:
        types = parse(source.text)
    except SyntaxFault as fault:
        lost = (*lost, *declared(source.text)[0])
        return Parsed([], [(fault.line, fault.what, fault.hint, lost)])
    return Parsed([_with_ros_constants(one, source) for one in types])


def _with_ros_constants(one: LcmType, source: LcmSource) -> LcmType:
    """Return a type with the constants that LCM does not have, and the types of the others."""
    kinds: Mapping[str, str] = source.kinds.get(one.name, {})
    known = {name: (kinds.get(name, kind), value) for name, (kind, value) in one.constants.items()}
    texts = source.texts.get(one.name, {})
    return one._replace(constants=known | {name: ("string", text) for name, text in texts.items()})
