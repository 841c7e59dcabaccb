"""Files that appear only when complete: written beside their target, then renamed."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lcmtools.errors import LcmtoolsError, os_errors_as


@contextmanager
def output_beside(target: Path, *, force: bool = False) -> Iterator[Path]:
    """Give the path to write to; at the end it replaces the target, or is deleted on an error.

    With ``force`` it may replace an existing file, but never a folder.

    Raises:
        LcmtoolsError: The target exists, or cannot be written.
    """
    if target.is_dir():
        raise LcmtoolsError(f"{target} is a folder", "name another, or remove it")
    if target.exists() and not force:
        raise LcmtoolsError(f"{target} exists", "name another file, or add --force")
    scratch = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        with os_errors_as(f"cannot write {target}"):
            scratch.mkdir()
            yield scratch / target.name
            (scratch / target.name).rename(target)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
