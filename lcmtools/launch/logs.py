"""The folder of a launch's log files."""

import contextlib
import os
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from lcmtools.errors import LcmtoolsError
from lcmtools.folders import home_folder


def make_folder(environment: Mapping[str, str]) -> Path:
    """Make this launch's folder, by XDG's rules, and its link ``latest``; LcmtoolsError if not."""
    state = home_folder(environment, "XDG_STATE_HOME", ".local/state")
    if state is None:
        raise LcmtoolsError("there is no folder for log files", "set HOME or XDG_STATE_HOME")
    base = state / "lcmtools" / "log"
    folder = base / f"{time.strftime('%Y-%m-%d-%H-%M-%S')}-{os.getpid()}"
    try:
        base.mkdir(parents=True, exist_ok=True)
        if folder.exists():  # an earlier launch of this process, or of a container with this pid
            folder = Path(tempfile.mkdtemp(prefix=f"{folder.name}-", dir=base))
            folder.chmod(0o755)
        else:
            folder.mkdir()
    except OSError as error:
        what = f"cannot make the folder for log files, {folder}: {error.strerror}"
        raise LcmtoolsError(what, "set XDG_STATE_HOME to another place") from error
    with contextlib.suppress(OSError):  # a file system without links
        temporary = base / f".{folder.name}"
        temporary.symlink_to(folder.name)
        temporary.replace(base / "latest")
    return folder
