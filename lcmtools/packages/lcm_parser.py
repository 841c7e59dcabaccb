"""Reading .lcm files: the types of a text, or the first thing that is wrong with it.

Belongs here: LCM's grammar as lcm-gen has it, and where it is stricter. Must not know files, other
types or Python's names. lcm-gen is its judge in tests: both have the same fields, constants and
fingerprints, or a text is refused here.

    package a.b;
    struct Scan { const int16_t MOST = 720; int32_t n; float ranges[n], pose[2][3]; mode_t mode; }
    enum mode_t { IDLE=0, RUN }

Constants are integers and floats; an array's size is a number, a constant, or an integer member
above it; a type without a package is in that of its struct. Braces need blanks around them.
"""

import re
from collections.abc import Mapping
from math import isfinite
from struct import pack
from typing import NamedTuple, NoReturn, TypeAlias

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.python_names import base_hash, enum_hash
from lcmtools.messages.scalars import INTEGERS

Constants: TypeAlias = "Mapping[str, tuple[str, int | float | str]]"
"""The types and values of constants by name."""

_RANGES = {f"{name}_t": bounds for name, bounds in INTEGERS.items() if name != "uint8"}
_CONSTANT_TYPES = {*_RANGES, "float", "double"}
_HINTS = {
    "expected token {": "lcm-gen wants a space or a new line before '{'",
    "expected token ;": "a ';' is missing before this",
    "expected token }": "a '}' is missing, or lacks a space before it",
    "Missing struct token": "a file is  package name;  and then  struct Name { ... }",
}
_NO_SIZE = "Array sizes must be declared either as a constant or variable"

# Each pattern passes over a text once, whatever is in it: one that looks for an end which may be
# missing, or begins within a word, would do so again from every place.
COMMENT = re.compile(r"//[^\n]*|/\*.*?(?:\*/|(?P<unclosed>\Z))", re.DOTALL)
_STRANGE = re.compile(r"[^\w\s;{}\[\].,=+\-/*]", re.ASCII)
_TOKEN = re.compile(r"[;\[\],=]|[^\s;\[\],=]+")
_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_PATH = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*", re.ASCII)
_INTEGER = re.compile(r"-?(?:0x[0-9a-f]+|0|[1-9][0-9]*)", re.IGNORECASE | re.ASCII)
_FLOAT = re.compile(r"-?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?", re.IGNORECASE | re.ASCII)
_DECLARATION = re.compile(r"\bpackage\s+([\w.]+)|\b(?:struct|enum)\s+(\w+)\s*\{")


class LcmField(NamedTuple):
    """A field of a struct."""

    name: str
    type: str  # a primitive, "int32_t", or another type, "geometry_msgs/Twist"
    sizes: tuple[int | str, ...]  # of an array: numbers, or names of fields
    line: int

    @property
    def is_fixed(self) -> bool:
        """True for an array whose sizes are numbers, and for a single value."""
        return all(isinstance(size, int) for size in self.sizes)


class LcmType(NamedTuple):
    """A struct, or an enum, which has values and no fields."""

    name: str  # "geometry_msgs/Twist", or "pose_t" without a package
    number: int  # its hash, to which a struct's fields add those of their types
    fields: tuple[LcmField, ...]
    constants: Constants
    values: Mapping[str, int] | None  # of an enum
    line: int


class SyntaxFault(ValueError):  # noqa: N818 - named for what it is
    """A fault in a text, with its line and the remedy; only in this package."""

    def __init__(self, what: str, line: int, hint: str = "") -> None:
        super().__init__(what)
        self.what, self.line = what, line
        self.hint = hint or _HINTS.get(what, "")


def parse(text: str) -> list[LcmType]:
    """Return the types in a text; raise SyntaxFault for the first fault."""
    text = without_comments(text)
    if strange := _STRANGE.search(text):
        line = text.count("\n", 0, strange.start()) + 1
        hint = "a .lcm file has words, numbers and ;{}[].=-"
        raise SyntaxFault(f"unexpected {strange[0]!r}", line, hint)
    return _Parser(text).types()


def without_comments(text: str) -> str:
    """Return a text of the same lines; SyntaxFault for a comment that is not closed."""

    def blank(comment: re.Match[str]) -> str:
        if comment["unclosed"] is not None:
            line = text.count("\n", 0, comment.start()) + 1
            raise SyntaxFault("this comment is not closed", line, "write */")
        return " " + "\n" * comment[0].count("\n")

    return COMMENT.sub(blank, text)


def declared(text: str) -> tuple[list[str], list[str]]:
    """Return the types and packages in a text that may be wrong, as far as they can be made out."""
    types, packages = [], [""]
    for match in _DECLARATION.finditer(COMMENT.sub(" ", text)):
        if match[1]:
            packages.append(match[1])
        else:
            types.append(f"{packages[-1]}/{match[2]}".lstrip("/"))
    return types, packages[1:]


class _Parser:
    """A text's tokens, and the place of the next one."""

    def __init__(self, text: str) -> None:
        self._tokens: list[str] = []
        self._lines: list[int] = []
        for number, line in enumerate(text.split("\n"), 1):
            found = _TOKEN.findall(line)
            self._tokens += found
            self._lines += [number] * len(found)
        self._tokens.append("")
        self._lines.append(number)
        self._at = 0
        self._package = ""

    def types(self) -> list[LcmType]:
        found: dict[str, LcmType] = {}
        while word := self._next():
            if word == "package":
                name = self._name(_PATH, "package")
                self._expect(";")
                self._package = f"{name}/"
                continue
            if word not in ("struct", "enum"):
                self._fail("Missing struct token")
            line = self._lines[self._at - 1]
            name = self._package + self._name(_NAME, word)
            if name in found:
                self._fail(f"duplicate type {name} declared in this file")
            found[name] = (self._struct if word == "struct" else self._enum)(name, line)
        return list(found.values())

    def _next(self) -> str:
        token = self._tokens[self._at]
        self._at += token != ""
        return token

    def _take(self, token: str) -> bool:
        """Pass a token if it is the next one."""
        is_next = self._tokens[self._at] == token
        self._at += is_next
        return is_next

    def _expect(self, token: str) -> None:
        if not self._take(token):
            self._at += 1
            self._fail(f"expected token {token}")

    def _fail(self, what: str, hint: str = "") -> NoReturn:
        """Raise the fault at the last token."""
        raise SyntaxFault(what, self._lines[min(self._at, len(self._lines)) - 1], hint)

    def _name(self, pattern: re.Pattern[str], kind: str) -> str:
        name = self._next()
        if not pattern.fullmatch(name.rstrip("{")):
            self._fail(
                f"'{name}' is not a valid name of a {kind}" if name else "the file ends here"
            )
        return name

    def _enum(self, name: str, line: int) -> LcmType:
        self._expect("{")
        values: dict[str, int] = {}
        while not self._take("}"):
            value = self._name(_NAME, "value")
            if value in values:
                self._fail(f"Enum value {value} declared twice")
            number = max(0, *values.values()) + 1 if values else 1
            if self._take("="):
                number = self._integer(self._next(), "int32_t")
            if number in values.values():
                self._fail(f"two values of {name} are {number}")
            values[value] = number
            self._take(",")
            self._take(";")
        return LcmType(name, enum_hash(name.rpartition("/")[2]), (), {}, values, line)

    def _struct(self, name: str, line: int) -> LcmType:
        self._expect("{")
        body = _Body()
        while not self._take("}"):
            kind = self._next()
            (self._constants if kind == "const" else self._members)(kind, body)
        hashed = base_hash(zip(body.fields, body.primitives, body.sizes, strict=True))
        return LcmType(name, hashed, tuple(body.fields.values()), body.constants, None, line)

    def _constants(self, _: str, body: "_Body") -> None:
        kind = self._next()
        if kind not in _CONSTANT_TYPES:
            self._fail("invalid type for const", f"it can be {', '.join(sorted(_CONSTANT_TYPES))}")
        while True:
            name = self._new_name(body)
            self._expect("=")
            text = self._next()
            read = self._integer if kind in _RANGES else self._float
            body.constants[name] = kind, read(text, kind)
            if kind in _RANGES:
                body.lengths[name] = _Size(text)
            if not self._take(","):
                break
        self._expect(";")

    def _members(self, kind: str, body: "_Body") -> None:
        if kind in ("struct", "enum"):
            self._fail(f"recursive {kind}s not implemented")
        if not _PATH.fullmatch(kind):
            self._fail("invalid type name" if kind else "expected token }")
        full = kind
        if kind not in PRIMITIVES:
            package, point, short = kind.rpartition(".")
            full = f"{package}/{short}" if point else self._package + short
        while True:
            name, line = self._new_name(body), self._lines[self._at - 1]
            sizes: list[int | str] = []
            while self._take("["):
                sizes.append(self._size(body, kind, name))
            plain = tuple(int(one) if isinstance(one, int) else one for one in sizes)
            body.fields[name] = LcmField(name, full, plain, line)
            body.primitives.append(kind if kind in PRIMITIVES else "")
            body.sizes.append(tuple(sizes))
            if not self._take(","):
                break
        self._expect(";")

    def _new_name(self, body: "_Body") -> str:
        name = self._next()
        if not _NAME.fullmatch(name):
            self._fail("Invalid member name: must start with [a-zA-Z_], and have [a-zA-Z_0-9]")
        if name in body.fields or name in body.constants:
            self._fail(f"Duplicate member name '{name}'")
        return name

    def _size(self, body: "_Body", kind: str, name: str) -> int | str:
        word = self._next()
        if word == "]":
            length = f"int32_t {name}_length;"
            self._fail(_NO_SIZE, f"declare its length:  {length}  {kind} {name}[{name}_length];")
        size: int | str = word
        if _INTEGER.fullmatch(word):
            size = _Size(word)
        elif word in body.lengths:
            size = body.lengths[word]
        elif not _NAME.fullmatch(word):
            self._fail(f"'{word}' is neither a size nor the name of one", "write  [3]  or  [n]")
        else:
            self._check_length(word, body)
        if isinstance(size, int) and size <= 0:
            self._fail("Constant array size must be > 0")
        self._expect("]")
        return size

    def _check_length(self, word: str, body: "_Body") -> None:
        hint = f"declare  int32_t {word};  above the array"
        if word not in body.fields and word not in body.constants:
            what = f"Unknown variable array index '{word}'. Index variables must be declared before"
            self._fail(f"{what} the array", hint)
        if word in body.constants or body.fields[word].type not in _RANGES:
            self._fail(f"Array dimension '{word}' must be an integer type", hint)
        if body.fields[word].sizes:
            self._fail(f"Array dimension '{word}' must not be an array", hint)

    def _integer(self, text: str, kind: str) -> int:
        if not _INTEGER.fullmatch(text):
            self._fail("Expected integer value", "write 12, -12 or 0x1F")
        number = int(text, 0)
        low, high = _RANGES[kind]
        if not low <= number <= high:
            self._fail(f"Integer value out of bounds for {kind}")
        return number

    def _float(self, text: str, kind: str) -> int | float:
        if _INTEGER.fullmatch(text):
            return int(text, 0)
        if not _FLOAT.fullmatch(text):
            self._fail("Expected floating point value", "write 0.5 or 1e-3")
        number = float(text)
        if not isfinite(number) or (kind == "float" and not _fits_float(number)):
            self._fail(f"Floating point value out of range for {kind}")
        return number


class _Size(int):
    """An array's size, with its text, which lcm-gen hashes: 0x10."""

    def __new__(cls, text: str) -> "_Size":
        size = super().__new__(cls, int(text, 0))
        size.text = text
        return size

    text: str

    def __str__(self) -> str:
        return self.text


class _Body:
    """The members of a struct that is being read; ``sizes`` are as they are hashed."""

    def __init__(self) -> None:
        self.fields: dict[str, LcmField] = {}
        self.primitives: list[str] = []
        self.sizes: list[tuple[int | str, ...]] = []
        self.constants: dict[str, tuple[str, int | float | str]] = {}
        self.lengths: dict[str, _Size] = {}


def _fits_float(number: float) -> bool:
    try:
        pack(">f", number)
    except OverflowError:
        return False
    return True
