"""The log files of a launch: their folder, and a file for each node."""

import contextlib
import os
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from lcmtools.errors import LcmtoolsError
from lcmtools.folders import home_folder
from lcmtools.launch.node_process import NodeProcess
from lcmtools.launch.plan import Output


def _base_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder of all launches, by the XDG rules."""
    state = home_folder(environment, "XDG_STATE_HOME", ".local/state")
    if state is None:
        raise LcmtoolsError("there is no folder for log files", "set HOME or XDG_STATE_HOME")
    return state / "lcmtools" / "log"


def make_folder(environment: Mapping[str, str]) -> Path:
    """Make this launch's folder, and let the link ``latest`` lead to it.

    Raises:
        LcmtoolsError: It cannot be made.
    """
    base = _base_folder(environment)
    folder = base / f"{time.strftime('%Y-%m-%d-%H-%M-%S')}-{os.getpid()}"
    try:
        base.mkdir(parents=True, exist_ok=True)
        if folder.exists():  # an earlier launch of this process, or of a container with this number
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


class Journal:
    """Writes the lines of nodes into files in a folder; as a context, closes them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._files: dict[NodeProcess, TextIO | None] = {}

    def __enter__(self) -> "Journal":
        """Return it; nothing is opened yet."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close all files."""
        for file in filter(None, self._files.values()):
            file.close()

    def path(self, node: NodeProcess) -> str:
        """Return the path of a node's file, ``husky0-driver-1.log``; "" if it has none."""
        if node.plan.output is Output.SCREEN or node.plan.takes_terminal:
            return ""
        return str(self._folder / f"{node.label.replace('/', '-')}.log")

    def begin(self, node: NodeProcess) -> str:
        """Open a node's file, once for all its runs; return the error, or ""."""
        path = self.path(node)
        if not path or node in self._files:
            return ""
        self._files[node] = None
        try:
            self._files[node] = Path(path).open("a", encoding="utf-8")  # noqa: SIM115 - closed with all
        except OSError as error:
            return f"cannot write {path}: {error.strerror}"
        return ""

    def write(self, node: NodeProcess, text: str) -> str:
        """Write a line; return the first error, or ""."""
        file = self._files.get(node)
        if file is None:
            return ""
        try:
            file.write(f"{text}\n")
            file.flush()
        except OSError as error:
            self._files[node] = None
            return f"nothing more is written into {self.path(node)}: {error.strerror}"
        return ""
