"""The cache of compiled .lcm files in the user's cache folder, keyed by their content.

Belongs here: the folder, and that two processes can make the same thing at once. Must not know how
it is made, see ``build``. What only making needs is imported then: most commands find what is kept.
"""

import hashlib
import os
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Lock

from lcmtools import __version__
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.type_source import TypeSource
from lcmtools.packages.index import read_index
from lcmtools.packages.lcm_gen import find_lcm_gen
from lcmtools.packages.type_files import LcmFile

_FORM = "2"  # of what is kept; another number invalidates the cache
_PREFIX = "lcmtools_types_"
_KEPT_DAYS = 30.0
_ONE_AT_A_TIME = Lock()


def cached_types(
    files: Sequence[LcmFile], environment: Mapping[str, str], shipped: Mapping[str, int]
) -> TypeSource:
    """The types of some files, made now unless that has been done before, and ready to import.

    Args:
        files: In the order in which they count.
        environment: Where the user's cache folder is (XDG_CACHE_HOME, HOME).
        shipped: The types that lcmtools brings.

    Raises:
        MissingExtra: There is no lcm-gen.
        LcmtoolsError: What is made can be kept nowhere.
    """
    prefix = _PREFIX + digest(files)
    with _ONE_AT_A_TIME:
        root = _cache_folder(environment)
        if not _is_whole(prefix, root / prefix):
            _make(files, prefix, root, shipped)
        return _importable(prefix, root / prefix)


def digest(files: Sequence[LcmFile]) -> str:
    """A digest of the files' content and of the lcm-gen and the lcmtools that read them."""
    program = Path(find_lcm_gen()).stat()
    known = f"{_FORM} {__version__} {program.st_size} {program.st_mtime_ns}"
    total = hashlib.sha256(known.encode())
    for file in files:
        content = hashlib.sha256(file.content).digest()
        total.update(hashlib.sha256(os.fsencode(file.path)).digest() + content)
    return total.hexdigest()[:20]


def _importable(prefix: str, folder: Path) -> TypeSource:
    source = read_index(prefix, folder)
    with suppress(OSError):
        os.utime(folder)  # it is in use: see _forget_old
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # only ``prefix`` is in it, which nothing else is called
    return source


def _is_whole(prefix: str, folder: Path) -> bool:
    """Return whether it is there, and undamaged."""
    try:
        read_index(prefix, folder)
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return False
    return True


def _make(files: Sequence[LcmFile], prefix: str, root: Path, shipped: Mapping[str, int]) -> None:
    """Make it in a folder of its own, and put that in its place at once."""
    import shutil
    import tempfile

    from lcmtools.packages.build import build

    try:
        scratch = Path(tempfile.mkdtemp(prefix=".making-", dir=root))
    except OSError as error:
        raise LcmtoolsError(f"cannot write in {root}: {error.strerror}") from error
    target = root / prefix
    try:
        build(files, prefix, scratch, shipped)
        if not _is_whole(prefix, target):  # else another process was faster, with the same
            shutil.rmtree(target, ignore_errors=True)
            scratch.rename(target)
    except OSError as error:
        if not _is_whole(prefix, target):
            raise LcmtoolsError(f"cannot write in {root}: {error.strerror}") from error
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    _forget_old(root)


def _cache_folder(environment: Mapping[str, str]) -> Path:
    """The user's own, or, where that cannot be written, one for this process only."""
    said = environment.get("XDG_CACHE_HOME", "")
    home = environment.get("HOME", "")
    base = Path(said) if said.startswith("/") else Path(home) / ".cache" if home else None
    if base is not None:
        folder = base / "lcmtools" / "types"
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
    """Remove what no process has made or asked for in a month."""
    import shutil

    oldest = time.time() - _KEPT_DAYS * 86400
    for folder in root.iterdir():
        with suppress(OSError):
            if folder.stat().st_mtime < oldest:
                shutil.rmtree(folder, ignore_errors=True)
