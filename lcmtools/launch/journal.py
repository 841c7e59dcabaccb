"""The log files of a launch's processes.

Belongs here: which lines go into which file.
"""

from pathlib import Path
from typing import TextIO

from lcmtools.launch.logs import log_path
from lcmtools.launch.plan import Output
from lcmtools.processes.process import Process


class Journal:
    """Writes the lines of processes into files in a folder; as a context, closes them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._files: dict[int, TextIO | None] = {}

    def __enter__(self) -> "Journal":
        """Nothing is opened yet."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close all files."""
        for file in self._files.values():
            if file is not None:
                file.close()

    def path(self, process: Process) -> str:
        """A process's file; "" where it has none."""
        if process.plan.output is Output.SCREEN or process.plan.takes_terminal:
            return ""
        return str(log_path(self._folder, process.plan.name, process.number))

    def is_shown(self, process: Process) -> bool:
        """Whether all lines of a process are for the screen too; errors are in any case."""
        return process.plan.output is not Output.LOG

    def begin(self, process: Process) -> str:
        """Make a process's file, empty or as it is; what is wrong if that fails, or ""."""
        path = self.path(process)
        if not path or process.number in self._files:
            return ""
        self._files[process.number] = None
        try:
            self._files[process.number] = Path(path).open("a", encoding="utf-8")  # noqa: SIM115 - closed with all
        except OSError as error:
            return f"cannot write {path}: {error.strerror}"
        return ""

    def write(self, process: Process, text: str) -> str:
        """Write a line; what is wrong if it cannot be written, once, or ""."""
        file = self._files.get(process.number)
        if file is None:
            return ""
        try:
            file.write(f"{text}\n")
            file.flush()
        except OSError as error:
            self._files[process.number] = None
            return f"nothing more is written into {self.path(process)}: {error.strerror}"
        return ""
