"""The folder of a launch's log files.

Belongs here: where it is, what the files are called, and the link to the newest.
"""

import contextlib
import os
import time
from collections.abc import Mapping
from pathlib import Path

from lcmtools.errors import LcmtoolsError

LATEST = "latest"


def base_folder(environment: Mapping[str, str]) -> Path:
    """Where the folders of all launches are, by the XDG rules.

    Raises:
        LcmtoolsError: There is no home.
    """
    state = environment.get("XDG_STATE_HOME", "")
    if state.startswith("/"):  # the XDG rules have a relative one ignored
        return Path(state) / "lcmtools" / "log"
    home = environment.get("HOME", "")
    if not home:
        raise LcmtoolsError("there is no folder for log files", "set HOME or XDG_STATE_HOME")
    return Path(home) / ".local" / "state" / "lcmtools" / "log"


def make_folder(environment: Mapping[str, str]) -> Path:
    """Make this launch's folder, and let ``latest`` lead to it.

    Raises:
        LcmtoolsError: It cannot be made.
    """
    base = base_folder(environment)
    folder = base / f"{time.strftime('%Y-%m-%d-%H-%M-%S')}-{os.getpid()}"
    try:
        folder.mkdir(parents=True)
    except OSError as error:
        what = f"cannot make the folder for log files, {folder}: {error.strerror}"
        raise LcmtoolsError(what, "set XDG_STATE_HOME to another place") from error
    with contextlib.suppress(OSError):  # a file system without links
        temporary = base / f".{folder.name}"
        temporary.symlink_to(folder.name)
        temporary.replace(base / LATEST)
    return folder


def log_path(folder: Path, node: str, number: int) -> Path:
    """A node's file: ``husky0-driver-1.log``; it goes on where the node is started again."""
    return folder / f"{node.strip('/').replace('/', '-')}-{number}.log"
