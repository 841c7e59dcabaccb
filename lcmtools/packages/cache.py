"""Users' types, parsed and ready to import; of many files, what was parsed is kept on disk.

Belongs here: which sets of types this process has, and the file in the user's cache folder with
parsed types by the content of their files. A lost or damaged one is written anew.
"""

import hashlib
import marshal
import os
import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Lock

from lcmtools import __version__
from lcmtools.folders import cache_folder, write_atomically
from lcmtools.messages.type_source import TypeSource
from lcmtools.packages.placed_type import Parsed, file_types, parse_file, parsed_from
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.type_set import TypeSet

_FORM = f"8 {__version__} {sys.version}"  # what the content of the file depends on
_PREFIX = "lcmtools_types_"
_FEW = 64  # files are parsed sooner than the file is written
_MOST = 20_000  # files whose types are kept
_ONE_AT_A_TIME = Lock()

_sources: dict[str, TypeSource] = {}  # of this process, by prefix
_parsed: dict[bytes, Parsed] = {}  # by a file's key
_read: set[Path] = set()  # cache files that have been read


def types_of(
    files: Sequence[LcmFile], environment: Mapping[str, str], shipped: Mapping[str, int]
) -> TypeSource:
    """Return the types of some files, ready to import.

    The files are in order of precedence; ``shipped`` has the fingerprints of lcmtools' own types.
    """
    keys = [_key(file) for file in files]
    total = hashlib.sha256()
    for file, key in zip(files, keys, strict=True):
        total.update(os.fsencode(file.where) + key)
    prefix = _PREFIX + total.hexdigest()[:20]
    with _ONE_AT_A_TIME:
        if prefix not in _sources or prefix not in sys.modules:
            _parse(dict(zip(keys, files, strict=True)), environment)
            parsed = (file_types(file, _parsed[key]) for file, key in zip(files, keys, strict=True))
            _sources[prefix] = _made(prefix, TypeSet(parsed, shipped), shipped)
        return _sources[prefix]


def _made(prefix: str, known: TypeSet, shipped: Mapping[str, int]) -> TypeSource:
    from lcmtools.packages.type_classes import TypeModules

    numbers: dict[str, int] = {}
    enums: dict[str, int] = {}
    versions: defaultdict[str, dict[int, str]] = defaultdict(dict)
    for key, one in known.types.items():
        if key == one.type.name:
            (numbers if one.type.values is None else enums)[key] = one.number
        elif one.type.values is None:
            versions[one.type.name][one.number] = one.file
    files = {name: known.types[name].file for name in numbers}
    rest = known.problems, known.notes, versions, enums
    source = TypeSource(prefix, numbers, known.services(), files, *rest)
    TypeModules(source, known.types, shipped).open()
    return source


def _key(file: LcmFile) -> bytes:
    """Return the key of a file's content; that of a ROS file has not the names of its types."""
    named = os.fsencode(f"{file.package}:{file.path.name}\n") if file.package else b"\n"
    return hashlib.blake2b(named + file.content, digest_size=16).digest()


def _parse(files: Mapping[bytes, LcmFile], environment: Mapping[str, str]) -> None:
    """Parse the files that no cache has."""
    if len(files.keys() - _parsed.keys()) <= _FEW:
        path = None
    elif (path := _path(environment)) and path not in _read:
        _read.add(path)
        _load(path)
    new = {key: parse_file(file) for key, file in files.items() if key not in _parsed}
    _parsed.update(new)
    if path and len(new) > _FEW:
        kept = dict(list(_parsed.items())[-_MOST:])
        data = marshal.dumps((_FORM, {key: one.plain() for key, one in kept.items()}))
        with suppress(OSError):  # it only saves time
            path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            write_atomically(path, data, private=True)


def _load(path: Path) -> None:
    with suppress(OSError, ValueError, EOFError, TypeError):
        form, stored = marshal.loads(path.read_bytes())  # noqa: S302 - from the user's own cache
        if form == _FORM:
            _parsed.update({key: parsed_from(one) for key, one in stored.items()})


def _path(environment: Mapping[str, str]) -> Path | None:
    folder = cache_folder(environment)
    return folder / "types.parsed" if folder else None
