"""Noted workspaces, whose packages are found from everywhere: a list of folders.

It is LCMTOOLS_PACKAGE_PATH if that is set, else a file in the user's settings folder, one folder a
line, to which ``lcmtools pkg create`` adds. Must not know packages.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from lcmtools.errors import os_errors_as
from lcmtools.folders import home_folder, write_atomically

VARIABLE = "LCMTOOLS_PACKAGE_PATH"
"""Workspaces, separated by ':'; each has packages in it or in its ``src``, or is one."""

_HEADER = """\
# Workspaces: folders with packages, which lcmtools finds from everywhere.
# Remove a line to forget a workspace.
"""
_MOST_BYTES = 100_000


class NotedWorkspaces(NamedTuple):
    """The noted workspaces that exist, and where they are noted."""

    folders: list[Path]
    source: str  # the variable, or the file's path; "" if the environment has no home


def noted_workspaces(environment: Mapping[str, str]) -> NotedWorkspaces:
    """Return the noted workspaces; those that no longer exist are left out."""
    if named := environment.get(VARIABLE):
        return NotedWorkspaces(_folders(named.split(":")), VARIABLE)
    file = _file(environment)
    return NotedWorkspaces(_folders(_lines(file)), str(file or ""))


def note_workspace(folder: Path, environment: Mapping[str, str]) -> bool:
    """Add a workspace to the file, before the others; return True if it is found from now on.

    Raises:
        LcmtoolsError: The file cannot be written.
    """
    known = noted_workspaces(environment)
    file = _file(environment)
    if folder in known.folders:
        return True
    if known.source == VARIABLE or file is None or any(one in str(folder) for one in ":\n"):
        return False
    text = "".join(f"{one}\n" for one in (folder, *known.folders))
    with os_errors_as(f"cannot write {file}"):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(file, _HEADER + text)
    return True


def _file(environment: Mapping[str, str]) -> Path | None:
    folder = home_folder(environment, "XDG_CONFIG_HOME", ".config")
    return folder / "lcmtools" / "workspaces" if folder else None


def _lines(file: Path | None) -> list[str]:
    try:
        if file is not None and file.stat().st_size <= _MOST_BYTES:
            lines = file.read_bytes().splitlines()
            return [os.fsdecode(line) for line in lines if not line.startswith(b"#")]
    except OSError:
        pass
    return []


def _folders(words: list[str]) -> list[Path]:
    paths = (Path(word).expanduser().absolute() for word in words if word.strip())
    return [path for path in dict.fromkeys(paths) if path.is_dir()]
