"""The cache of compiled type files in the user's cache folder, keyed by their content.

Belongs here: the folder, its indices of the types in sets of files, the units with the types of one
file each, and safety if two processes write the same at once. Must not know how they are made: see
``generated`` and ``build``, which are imported only then, as most commands find them made.
"""

import hashlib
import json
import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from threading import Lock

from lcmtools import __version__
from lcmtools.errors import LcmtoolsError, os_errors_as
from lcmtools.folders import cache_folder, write_atomically
from lcmtools.messages.type_source import SHIPPED, Problem, TypeSource
from lcmtools.packages.lcm_gen import find_lcm_gen
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.unit import Generated, Output, load
from lcmtools.packages.versions import with_versions

_FORM = "6"  # version of the files; a change invalidates the cache
_PREFIX = "lcmtools_types_"
VERSION_PREFIX = f"{_PREFIX}v_"
"""The beginning of a package with other versions of types."""
_DAY = 86400.0
_KEPT = 30 * _DAY
_AT_ONCE = 64  # files compiled together
_SHORT = 1.0  # [s] of compiling without a word
_ONE_AT_A_TIME = Lock()

Units = Mapping[str, str]
"""The keys of files or types in the cache."""


def cached_types(
    files: Sequence[LcmFile],
    environment: Mapping[str, str],
    shipped: Mapping[str, int],
    say: Callable[[str], object] = str,
    home: str = SHIPPED,
) -> TypeSource:
    """Return the types of some files, ready to import; compile the files that are new.

    The files are in order of precedence; ``shipped`` has the fingerprints of lcmtools' own types;
    ``home`` is the package that has them. ``say`` is called with a line if it takes long.

    Raises:
        MissingExtra: There is no lcm-gen.
        LcmtoolsError: The result cannot be written.
    """
    keys = _keys(files)
    paths = (f"{file.path}\n{key}\n" for file, key in zip(files, keys, strict=True))
    total = hashlib.sha256(os.fsencode("".join((home, *paths)))).hexdigest()
    prefix = (_PREFIX if home == SHIPPED else VERSION_PREFIX) + total[:20]
    with _ONE_AT_A_TIME:
        root = _cache_folder(environment)
        index = root / f"{prefix}.json"
        if (found := _read_index(index)) is None:
            _make(files, keys, index, shipped, say)
            if (found := _read_index(index)) is None:
                raise LcmtoolsError(f"cannot read {index}")
        source, units, files_of = found
        if index.stem not in sys.modules:
            from lcmtools.packages.loading import TypeLoader

            def read(name: str) -> Generated:
                file = LcmFile(Path(files_of[name]), b"")
                output = _read_unit(root, units[name], file) or Output([])
                found = next((one for one in output.types if one.name == name), None)
                if found is None:
                    raise LcmtoolsError(f"cannot read {root / units[name]}, the type {name}")
                return found

            TypeLoader(source, units, read, shipped, home).open()

    def compiled(inside: Sequence[LcmFile], known: Mapping[str, int], home: str) -> TypeSource:
        return cached_types(inside, environment, known, say, home)

    return with_versions(source, files, shipped, compiled)


def _keys(files: Sequence[LcmFile]) -> list[str]:
    """Return the keys of files' content, and of the versions of lcm-gen and lcmtools that read it.

    The content of a ROS file does not contain the names of its package and of its type.
    """
    program = Path(find_lcm_gen()).stat()
    known = f"{_FORM} {__version__} {sys.version} {program.st_size} {program.st_mtime_ns}".encode()
    start = hashlib.sha256(known)
    keys = []
    for file in files:
        total = start.copy()
        total.update(os.fsencode(f"{file.package}:{file.path.name}\n") if file.package else b"\n")
        total.update(file.content)
        keys.append(f"{total.hexdigest()[:32]}.types")
    return keys


def _read_index(index: Path) -> tuple[TypeSource, Units, Mapping[str, str]] | None:
    """Return the types of a set of files, their keys, and their files.

    None if the index is incomplete.
    """
    try:
        table = json.loads(index.read_text("utf-8"))
        files = dict(table["files"])
        source = TypeSource(
            index.stem,
            {name: int(digits, 16) for name, digits in table["fingerprints"].items()},
            table["services"],
            {name: path for name, path in files.items() if name in table["fingerprints"]},
            [Problem(**problem) for problem in table["problems"]],
            table["notes"],
            table["places"],
            enums={name: int(digits, 16) for name, digits in table["enums"].items()},
        )
        units = dict(table["units"])
        if time.time() - index.stat().st_mtime > _DAY:  # mark them as used: see _forget_old
            for path in (index, *(index.parent / key for key in units.values())):
                os.utime(path)
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return None
    return source, units, files


def _read_unit(root: Path, key: str, file: LcmFile) -> Output | None:
    """Return the types of a file; None if they are not in the cache."""
    try:
        return load((root / key).read_bytes(), file)
    except (OSError, ValueError, EOFError, TypeError):
        return None


def _make(
    files: Sequence[LcmFile],
    keys: Sequence[str],
    index: Path,
    shipped: Mapping[str, int],
    say: Callable[[str], object],
) -> None:
    """Compile the files that are not in the cache, and write the index of all."""
    from lcmtools.packages.build import build

    root = index.parent
    with os_errors_as(f"cannot write in {root}"):
        known = {key: _read_unit(root, key, file) for key, file in zip(keys, files, strict=True)}
        new = {key: file for key, file in zip(keys, files, strict=True) if known[key] is None}
        known |= _compile(new, root, say)
        units = [(known[key] or Output([])).of(file) for key, file in zip(keys, files, strict=True)]
        made = build(units, shipped)
        numbers = made.fingerprints()
        homes = {id(one): key for key, unit in zip(keys, units, strict=True) for one in unit.types}
        table = {
            "fingerprints": {name: f"{number:016x}" for name, number in numbers.items()},
            "enums": {n: f"{t.number:016x}" for n, t in made.types.items() if t.tables is None},
            "files": {name: str(one.file.path) for name, one in made.types.items()},
            "services": made.services(),
            "problems": [problem._asdict() for problem in made.problems],
            "notes": made.notes,
            "places": made.places,
            "units": {name: homes[id(one)] for name, one in made.types.items()},
        }
        write_atomically(index, json.dumps(table), private=True)
    _forget_old(root)


def _compile(
    files: Mapping[str, LcmFile], root: Path, say: Callable[[str], object]
) -> dict[str, Output]:
    """Compile files, and keep the types of each under its key."""
    from lcmtools.packages.generated import generate

    found: dict[str, Output] = {}
    begin, waiting = time.monotonic(), [f"lcmtools: compiling {len(files)} new type files ..."]
    keys = list(files)
    for start in range(0, len(keys), _AT_ONCE):
        some = keys[start : start + _AT_ONCE]
        for key, output in zip(some, generate([files[key] for key in some]), strict=True):
            write_atomically(root / key, output.dump(), private=True)
            found[key] = output
        if waiting and time.monotonic() - begin > _SHORT:
            say(waiting.pop())
    return found


def _cache_folder(environment: Mapping[str, str]) -> Path:
    """Return the user's cache folder; one for this process only if that is not writable."""
    if base := cache_folder(environment):
        folder = base / "types"
        with suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if os.access(folder, os.W_OK):
                return folder
    return _scratch_folder()


@cache
def _scratch_folder() -> Path:
    import atexit
    import shutil
    import tempfile

    folder = Path(tempfile.mkdtemp(prefix="lcmtools-types-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _forget_old(root: Path) -> None:
    """Remove what no process has used in a month."""
    import shutil

    oldest = time.time() - _KEPT
    for path in root.iterdir():
        with suppress(OSError):
            if path.stat().st_mtime >= oldest:
                continue
            if path.is_dir():  # of an older version
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()
