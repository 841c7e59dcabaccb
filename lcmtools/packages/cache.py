"""The cache of compiled .lcm files in the user's cache folder, keyed by their content.

Belongs here: the folder, its index, and safety if two processes build the same at once. Must not
know how it is built: see ``build``, which is imported only then, as most commands find it built.
"""

import hashlib
import json
import os
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Lock

from lcmtools import __version__
from lcmtools.errors import LcmtoolsError, os_errors_as
from lcmtools.folders import cache_folder
from lcmtools.messages.type_source import SHIPPED, Problem, TypeSource
from lcmtools.packages.lcm_gen import find_lcm_gen
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.versions import with_versions

_INDEX = "index.json"  # the table of the types in a folder
_FORM = "4"  # version of the index; a change invalidates the cache
_PREFIX = "lcmtools_types_"
VERSION_PREFIX = f"{_PREFIX}v_"
"""The beginning of a package with other versions of types."""
_KEPT_DAYS = 30.0
_ONE_AT_A_TIME = Lock()


def cached_types(
    files: Sequence[LcmFile],
    environment: Mapping[str, str],
    shipped: Mapping[str, int],
    home: str = SHIPPED,
) -> TypeSource:
    """Return the types of some files, ready to import; compile them if necessary.

    The files are in order of precedence; ``shipped`` has the fingerprints of lcmtools' own types.
    ``home`` is the package that has them.

    Raises:
        MissingExtra: There is no lcm-gen.
        LcmtoolsError: The result cannot be written.
    """
    prefix = (_PREFIX if home == SHIPPED else VERSION_PREFIX) + digest(files, home)
    with _ONE_AT_A_TIME:
        root = _cache_folder(environment)
        if _read_index(prefix, root / prefix) is None:
            _make(files, prefix, root, shipped, home)
        source = _importable(prefix, root / prefix)

    def compiled(inside: Sequence[LcmFile], known: Mapping[str, int], home: str) -> TypeSource:
        return cached_types(inside, environment, known, home)

    return with_versions(source, files, shipped, compiled)


def digest(files: Sequence[LcmFile], home: str) -> str:
    """A digest of the files' content, and of all that the result depends on beside them."""
    program = Path(find_lcm_gen()).stat()
    known = f"{_FORM} {__version__} {program.st_size} {program.st_mtime_ns} {home}"
    total = hashlib.sha256(known.encode())
    for file in files:
        content = hashlib.sha256(file.content).digest()
        path = os.fsencode(f"{file.package}:{file.path}" if file.package else file.path)
        total.update(hashlib.sha256(path).digest() + content)
    return total.hexdigest()[:20]


def _importable(prefix: str, folder: Path) -> TypeSource:
    source = _read_index(prefix, folder)
    if source is None:
        raise LcmtoolsError(f"cannot read {folder / _INDEX}")
    with suppress(OSError):
        os.utime(folder)  # mark it as used: see _forget_old
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # it has only ``prefix``, a name that nothing else has
    return source


def _read_index(prefix: str, folder: Path) -> TypeSource | None:
    """Return the types of a folder that ``build`` has filled; None if it is incomplete."""
    try:
        table = json.loads((folder / _INDEX).read_text("utf-8"))
        return TypeSource(
            prefix,
            {name: int(digits, 16) for name, digits in table["fingerprints"].items()},
            table["services"],
            table["files"],
            [Problem(**problem) for problem in table["problems"]],
            table["notes"],
            table["places"],
        )
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return None


def _make(
    files: Sequence[LcmFile], prefix: str, root: Path, shipped: Mapping[str, int], home: str
) -> None:
    import shutil
    import tempfile

    from lcmtools.packages.build import build

    with os_errors_as(f"cannot write in {root}"):
        scratch = Path(tempfile.mkdtemp(prefix=".making-", dir=root))
    target = root / prefix
    try:
        table = build(files, prefix, scratch, shipped, home)
        (scratch / _INDEX).write_text(json.dumps(table), "utf-8")
        if _read_index(prefix, target) is None:  # else another process made it first
            shutil.rmtree(target, ignore_errors=True)
            scratch.rename(target)
    except OSError as error:
        if _read_index(prefix, target) is None:
            raise LcmtoolsError(f"cannot write in {root}: {error.strerror}") from error
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    _forget_old(root)


def _cache_folder(environment: Mapping[str, str]) -> Path:
    """Return the user's cache folder; one for this process only if that is not writable."""
    if base := cache_folder(environment):
        folder = base / "types"
        with suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if os.access(folder, os.W_OK):
                return folder
    return _scratch_folder()


def _scratch_folder() -> Path:
    import atexit
    import shutil
    import tempfile

    folder = Path(tempfile.mkdtemp(prefix="lcmtools-types-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _forget_old(root: Path) -> None:
    """Remove types that no process has used in a month."""
    import shutil

    oldest = time.time() - _KEPT_DAYS * 86400
    for folder in root.iterdir():
        with suppress(OSError):
            if folder.stat().st_mtime < oldest:
                shutil.rmtree(folder, ignore_errors=True)
