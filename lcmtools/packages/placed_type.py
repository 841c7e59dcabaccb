"""The types of a file, its problems, and its comments."""

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import takewhile
from typing import NamedTuple

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.type_source import Problem
from lcmtools.packages.lcm_parser import COMMENT, LcmField, LcmType, SyntaxFault, declared, parse
from lcmtools.packages.ros_files import LcmSource, to_lcm
from lcmtools.packages.type_files import LcmFile

_ROS_COMMENT = re.compile(r"#[^\n]*")
_UNIT = re.compile(r"\[([^\]]*)\]\s*")

ParsedProblem = tuple[int, str, str, tuple[str, ...]]
"""A line, what is wrong there, the remedy, and the types that are lost."""


class Parsed(NamedTuple):
    """The types of a file's content, and its problems."""

    types: Sequence[LcmType]
    problems: Sequence[ParsedProblem] = ()

    def plain(self) -> tuple[object, ...]:
        """Return the same as values that ``marshal`` takes; see ``parsed_from``."""
        types = [
            (*one[:2], tuple(map(tuple, one.fields)), dict(one.constants), *one[4:])
            for one in self.types
        ]
        return types, [*self.problems]


def parsed_from(plain: tuple[Iterable[tuple], Sequence[ParsedProblem]]) -> Parsed:  # type: ignore[type-arg] # as stored
    """Return what ``Parsed.plain`` made plain."""
    types, problems = plain
    return Parsed(
        [
            LcmType(name, number, tuple(map(LcmField._make, fields)), *rest)
            for name, number, fields, *rest in types
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


class Comment(NamedTuple):
    """A comment, with the unit that it begins with."""

    text: str = ""
    unit: str = ""  # "" for none


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
        found = [(one.line, one.what, one.hint, lost) for one in source.problems]
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


def comments(file: LcmFile, name: str) -> dict[str, Comment]:
    """Return the comments on a type in a file by field; the type's own has the key "".

    A comment stands above its field or behind it.
    """
    one = next((one for one in parse_file(file).types if one.name == name), None)
    if one is None:
        return {}
    pattern = _ROS_COMMENT if file.package else COMMENT
    text = pattern.sub(_marked, file.content.decode("utf-8", "replace"))
    lines = [line.split("\0") for line in text.split("\n")]
    places = {} if file.package else {"": one.line}
    places |= {part.name: part.line for part in one.fields if part.line not in places.values()}
    return {key: _comment(lines, line - 1) for key, line in places.items()}


def _marked(comment: re.Match[str]) -> str:
    """Return a comment between NULs in each of its lines, instead of LCM's or ROS's marks."""
    text = comment[0].removeprefix("/*").removesuffix("*/").lstrip("/#")
    return "\0" + re.sub(r"\n\s*\*?", "\n\0", text) + "\0"


def _comment(lines: Sequence[Sequence[str]], at: int) -> Comment:
    """Return the comment on what is in a line: that in the line, else that above it."""
    texts = ["".join(lines[at][1::2])]
    if not texts[0].strip():
        above = takewhile(lambda one: one[1:] and not "".join(one[::2]).strip(), lines[:at][::-1])
        texts = ["".join(one[1::2]) for one in above][::-1]
    text = " ".join(" ".join(texts).split())
    unit = _UNIT.match(text)
    return Comment(text[unit.end() :], unit[1]) if unit else Comment(text)
