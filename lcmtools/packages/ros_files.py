"""Translating ROS .msg, .srv and .action files to LCM, line by line, for lcm-gen's errors.

Belongs here: the syntax of ROS 1 and ROS 2, and what LCM cannot express. Must not know lcm-gen or
which types exist. As in the types that lcmtools ships, an array of variable size has a length field
NAME_length, these fields come first, and unsigned numbers are sent as signed ones of the same
width. A bound (``<=5``) is not checked.
"""

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from lcmtools.errors import InvalidFile
from lcmtools.messages.scalars import INTEGERS
from lcmtools.messages.type_source import Problem
from lcmtools.names import closest
from lcmtools.packages.ros_packages import ros_name
from lcmtools.packages.workspace import ROS_FOLDERS, package_name
from lcmtools.ros_words.field_types import MEANT, PRIMITIVES

_PARTS = {
    ".msg": ("",),
    ".srv": ("_Request", "_Response"),
    ".action": ("_Goal", "_Result", "_Feedback"),
}
"""The name suffixes of the structs in a file."""
SUFFIXES = tuple(_PARTS)

_RANGES = {
    **INTEGERS,
    **{f"uint{bits}": (0, (1 << bits) - 1) for bits in (16, 32, 64)},
    "byte": INTEGERS["int8"],
    "char": INTEGERS["uint8"],
    "bool": (0, 1),
}
_BOOLEANS = {"true": "1", "false": "0"}

_NAME = r"[A-Za-z]\w*"
_LEGAL = re.compile(_NAME, re.ASCII)
_TEXT = re.compile(rf"\s*w?string(?:<=\d+)?\s+({_NAME})\s*=(.*)", re.ASCII)
_ENTRY = re.compile(
    rf"({_NAME}(?:/{_NAME}){{0,2}})(?:<=\d+)?(?:\[(<=)?(\d*)\])?\s+({_NAME})\s*(.*)", re.ASCII
)
_MOST_PROBLEMS = 20  # of a file that are told
_EXAMPLE = "write  float64[] values  or  int32 LIMIT=5"


@dataclass(slots=True)
class LcmSource:
    """A ROS file as the text of a .lcm file with the same lines."""

    text: str
    problems: list[Problem]
    texts: dict[str, dict[str, str]]  # by type: string constants, which LCM does not have
    kinds: dict[str, dict[str, str]]  # by type: the types of the other constants


@dataclass(slots=True)
class _Struct:
    """A message whose lines are being read."""

    name: str
    lines: list[str] = field(default_factory=list)
    lengths: list[str] = field(default_factory=list)
    texts: dict[str, str] = field(default_factory=dict)
    kinds: dict[str, str] = field(default_factory=dict)

    def add(self, line: str) -> None:
        """Add a line; raise InvalidFile if it is not ROS syntax or LCM cannot express it."""
        if constant := _TEXT.fullmatch(line):
            text = constant[2].strip()
            is_quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "'\""
            self.texts[constant[1]] = text[1:-1] if is_quoted else text
            self.lines.append("")
            return
        bare = line.partition("#")[0].strip()
        self.lines.append(self._entry(bare) if bare else "")

    def _entry(self, bare: str) -> str:
        entry = _ENTRY.fullmatch(bare)
        if bare.endswith(";"):
            raise InvalidFile(f"'{bare}' ends in ';'", "lines of ROS have none")
        if not entry:
            raise InvalidFile(f"cannot read '{bare}'", _EXAMPLE)
        kind, bound, size, name, rest = entry.groups()
        if rest.startswith("="):
            self.kinds[name] = kind
            return _constant(kind, name, rest[1:].strip())
        if rest:
            what = f"{name} has a default value, which LCM does not support"
            raise InvalidFile(what, "leave it out: a new message has zeros")
        if size is None:
            return f"{_lcm_type(kind)} {name};"
        if not size or bound:
            size = f"{name}_length"
            self.lengths.append(f"int32_t {size};")
        return f"{_lcm_type(kind)} {name}[{size}];"

    def text(self) -> str:
        head = " ".join((f"struct {self.name} {{", *self.lengths))
        return f"{head} " + "\n".join(self.lines) + " }"


def package_of(path: Path) -> str:
    """Return a ROS file's package, whose folder, or e.g. the ``msg`` folder in it, has the file."""
    folder = path.parent.parent if path.parent.name in ROS_FOLDERS else path.parent
    if name := ros_name(folder):
        return name
    with suppress(InvalidFile):
        return package_name(folder)
    return folder.name


def to_lcm(path: Path, content: bytes, package: str) -> LcmSource:
    """Translate a ROS file; if there are problems, the text must not be used."""
    names = [f"{path.stem}{part}" for part in _PARTS[path.suffix]]
    structs = [_Struct(names[0])]
    problems = list(_names(path, package))
    try:
        lines = content.decode().splitlines() or [""]
    except UnicodeDecodeError:
        return LcmSource("", [Problem(str(path), 1, "it is not UTF-8 text")], {}, {})
    for number, line in enumerate(lines, 1):
        if line.startswith("---") and len(structs) < len(names):
            structs.append(_Struct(names[len(structs)], [""]))
            continue
        try:
            structs[-1].add(line)
        except InvalidFile as error:  # each line fails on its own
            problems.append(Problem(str(path), number, error.what, error.hint))
            if len(problems) == _MOST_PROBLEMS:
                return LcmSource("", problems, {}, {})
    if len(structs) < len(names):
        what = f"a line of --- before the fields of {names[len(structs)]} is missing"
        problems.append(Problem(str(path), len(lines), what))
    text = ("\n" if structs[0].lines else " ").join(one.text() for one in structs)
    texts = {f"{package}/{one.name}": one.texts for one in structs}
    kinds = {f"{package}/{one.name}": one.kinds for one in structs}
    return LcmSource(f"package {package}; {text}\n", problems, texts, kinds)


def _names(path: Path, package: str) -> Iterator[Problem]:
    for name, what in ((path.stem, "message type"), (package, "package")):
        if not _LEGAL.fullmatch(name):
            hint = "letters, digits and '_', a letter first"
            yield Problem(str(path), 0, f"'{name}' is not a valid name of a {what}", hint)


def _lcm_type(kind: str) -> str:
    if kind in MEANT:
        raise InvalidFile(f"unknown type '{kind}'", f"did you mean {MEANT[kind]}?")
    known = {**MEANT, **{name: name for name in PRIMITIVES}}
    if kind not in PRIMITIVES and kind.islower() and (near := closest(kind, known)):
        raise InvalidFile(f"unknown type '{kind}'", f"did you mean {known[near[0]]}?")
    return PRIMITIVES.get(kind, re.sub(r"/(?:(?:msg|srv)/)?", ".", kind))


def _constant(kind: str, name: str, text: str) -> str:
    """Return an LCM constant of the smallest type that holds it."""
    try:
        if kind in ("float32", "float64"):
            return f"const double {name} = {_finite(text)!r};"
        value = int(_BOOLEANS.get(text.lower(), text), 0)
        low, high = _RANGES[kind]
    except KeyError:
        _lcm_type(kind)
        raise InvalidFile(f"a constant cannot be of the type {kind}") from None
    except ValueError:
        raise InvalidFile(f"'{text}' is not a value of {kind}, the type of {name}") from None
    if not low <= value <= high:
        raise InvalidFile(f"{value} does not fit {kind} ({low}..{high})")
    for bits in (8, 16, 32, 64):
        least, most = INTEGERS[f"int{bits}"]
        if least <= value <= most:
            return f"const int{bits}_t {name} = {value};"
    raise InvalidFile(f"{name} is larger than LCM's largest number, 2^63 - 1")


def _finite(text: str) -> float:
    if not abs(float(text)) < float("inf"):
        raise ValueError
    return float(text)
