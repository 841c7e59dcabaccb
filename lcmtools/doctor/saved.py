"""Evidence in a file: JSON with a version, to be judged again elsewhere.

The fields of ``Evidence`` and of the values in it are written by name, except those that have
their default; named tuples of a few fields are lists. Later versions may add fields with defaults,
and names of enumerations: a reader ignores fields that it does not know, and leaves out a value or
an element of a list with a name that it does not know. Pure, except for reading and writing the
file. Must not judge.
"""

import json
import types
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import nullcontext, suppress
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias, Union, get_args, get_origin, get_type_hints

from lcmtools.doctor.evidence import Evidence
from lcmtools.errors import LcmtoolsError
from lcmtools.folders import read_text, write_whole

VERSION = 1  # of the file's layout: greater by one with each addition
_KEY = "lcmtools_evidence"
_MOST_BYTES = 100_000_000
_FEW = 3  # fields of a named tuple that is written as a list, unless all have a default
_MOST, _LEAST = (1 << 64) - 1, -(1 << 63)

_hints = cache(get_type_hints)

_Plain: TypeAlias = Any  # what JSON holds
_Type: TypeAlias = Any  # a type as annotations have it
_Made: TypeAlias = Any  # a value of such a type


class _InvalidEvidence(Exception):  # noqa: N818 - never leaves this module
    """A value in the file that does not match its type."""


class _UnknownName(_InvalidEvidence):
    """A name of an enumeration in another version."""


def save(evidence: Evidence, file: Path) -> None:
    """Write evidence to a file; an error has one line."""
    write_whole(file, to_text(evidence))


def load(file: Path) -> Evidence:
    """Read evidence from a file that ``save`` wrote; an error has one line."""
    try:
        return from_text(read_text(file, _MOST_BYTES, kind=LcmtoolsError))
    except (_InvalidEvidence, ValueError, RecursionError) as error:
        why = error if isinstance(error, _InvalidEvidence) else "it is not JSON"
        what = f"{file} does not contain evidence that wtf can judge: {why}"
        raise LcmtoolsError(what) from error


def to_text(evidence: Evidence) -> str:
    """Return evidence as the text of a file."""
    document = {_KEY: VERSION, "evidence": _plain(evidence)}
    return f"{json.dumps(document, separators=(',', ':'))}\n"


def from_text(text: str) -> Evidence:
    """Return the evidence in the text of a file."""
    document = json.loads(text)
    version = document.get(_KEY) if isinstance(document, dict) else None
    if not isinstance(version, int):
        raise _InvalidEvidence("it is other JSON")
    found: Evidence = _value(document.get("evidence"), Evidence, "evidence")
    return found


def _plain(value: object) -> object:
    kind: _Type = type(value)
    if _has_names(kind):
        known = ((name, getattr(value, name), usual) for name, usual in _defaults(kind).items())
        return {name: _plain(part) for name, part, usual in known if part != usual}
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, Mapping):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, AbstractSet):
        return sorted(map(str, value))
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(part) for part in value]
    return value


def _has_names(kind: _Type) -> bool:
    """Return whether the fields of a type are written with their names."""
    if is_dataclass(kind):
        return True
    names, defaults = getattr(kind, "_fields", ()), getattr(kind, "_field_defaults", ())
    return len(names) > _FEW or 0 < len(names) == len(defaults)


@cache
def _defaults(kind: _Type) -> dict[str, object]:
    """Return the defaults of a type's fields; MISSING for a field without one."""
    if not is_dataclass(kind):
        return {name: kind._field_defaults.get(name, MISSING) for name in kind._fields}
    factories = {part.name: part.default_factory for part in fields(kind)}
    made = {name: make() for name, make in factories.items() if make is not MISSING}
    return {part.name: made.get(part.name, part.default) for part in fields(kind)}


def _value(plain: _Plain, kind: _Type, path: str) -> _Made:
    """Build a value of type ``kind`` from JSON; the inverse of ``_plain``."""
    origin: object = get_origin(kind)
    kinds = get_args(kind)
    if origin in (Union, types.UnionType):  # as in ``float | None``
        return None if plain is None else _value(plain, kinds[0], path)
    if origin is Mapping:
        _expect(isinstance(plain, dict) and all(k.isascii() and k.isdigit() for k in plain), path)
        return {int(key): _value(part, kinds[1], path) for key, part in plain.items()}
    if origin is tuple:
        return tuple(_several(plain, kinds, path))
    if origin is not None:
        values = _several(plain, (kinds[0], ...), path)
        return frozenset(values) if origin is AbstractSet else tuple(values)
    if hasattr(kind, "_fields") and not _has_names(kind):
        return kind(*_several(plain, tuple(_hints(kind).values()), path))
    return _object(plain, kind, path) if _has_names(kind) else _single(plain, kind, path)


def _object(plain: _Plain, kind: _Type, path: str) -> _Made:
    _expect(isinstance(plain, dict), path)
    hints, values = _hints(kind), {}
    for name, default in _defaults(kind).items():
        is_needed = default is MISSING
        _expect(name in plain or not is_needed, f"{path}.{name}")
        if name in plain:
            with nullcontext() if is_needed else suppress(_UnknownName):
                values[name] = _value(plain[name], hints[name], f"{path}.{name}")
    return kind(**values)


def _several(plain: _Plain, kinds: tuple[_Type, ...], path: str) -> list[_Made]:
    """Build the values of a list, all of one type or each of its own; ignore further ones."""
    _expect(isinstance(plain, list), path)
    if kinds[-1] is not ...:
        _expect(len(plain) >= len(kinds), path)
        pairs = zip(plain, kinds, strict=False)
        return [_value(part, kind, f"{path}[{n}]") for n, (part, kind) in enumerate(pairs)]
    values = []
    for n, part in enumerate(plain):
        with suppress(_UnknownName):
            values.append(_value(part, kinds[0], f"{path}[{n}]"))
    return values


def _single(plain: _Plain, kind: _Type, path: str) -> _Made:
    if issubclass(kind, Enum):
        _expect(isinstance(plain, str), path)
        if plain not in kind.__members__:
            raise _UnknownName(f"'{path[:80]}' is missing, unknown or wrong")
        return kind[plain]
    _expect(isinstance(plain, (int, float) if kind is float else kind), path)
    _expect(isinstance(plain, bool) == (kind is bool), path)
    _expect(isinstance(plain, str) or _LEAST <= plain <= _MOST, path)
    return kind(plain)


def _expect(holds: bool, path: str) -> None:  # noqa: FBT001 - an assertion
    if not holds:
        raise _InvalidEvidence(f"'{path[:80]}' is missing, unknown or wrong")
