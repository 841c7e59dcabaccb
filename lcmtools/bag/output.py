"""Files that appear only when complete: written beside their target, then renamed."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from lcmtools.errors import LcmtoolsError, os_errors_as
from lcmtools.folders import open_stream, usual_mode


@contextmanager
def output_beside(target: Path, *, force: bool = False, binary: bool = True) -> Iterator[Path]:
    """Give the path to write to; at the end it replaces the target, or is deleted on an error.

    Files that are written beside it get their places beside the target. With ``force`` it may
    replace an existing file, also one that a link leads to, but never anything else. A stream (see
    ``open_stream``) gets the content at the end; only text if not ``binary`` may go to a terminal.

    Raises:
        LcmtoolsError: The target exists, or cannot be written.
    """
    stream = open_stream(target, binary=binary)
    if stream is not None:
        with os.fdopen(stream, "wb") as out, TemporaryDirectory(prefix="lcmtools-") as folder:
            made = Path(folder, f"output{target.suffix or '.out'}")
            yield made
            with made.open("rb") as content:
                shutil.copyfileobj(content, out)
        return
    if target.exists() and not force:
        raise LcmtoolsError(f"{target} exists", "name another file, or add --force")
    place = target.resolve()
    scratch = place.with_name(f".{place.name}.{os.getpid()}")
    made = scratch / place.name
    try:
        with os_errors_as(f"cannot write {target}"):
            scratch.mkdir()
            yield made
            if made.is_file():
                made.chmod(usual_mode(place))
            for one in sorted(scratch.iterdir(), key=made.__eq__):  # what is beside it first
                one.rename(place.with_name(one.name))
    except LcmtoolsError as error:  # of a writer that names the file that it writes
        error.what = error.what.replace(str(made), str(target))
        raise
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
