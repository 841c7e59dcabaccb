"""The labs' nodes with the interesting part left out, to be filled in: one file a node.

``lcmtools lab skeleton NAME`` copies one. Each runs as it is and does nothing wrong; its TODOs say
what is missing. The answers are the nodes of the same names in the folder above.
"""

from pathlib import Path

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.folders import write_whole
from lcmtools.names import did_you_mean
from lcmtools.packages.runnable_nodes import ANSWERS

NAMES = tuple(sorted((*ANSWERS, "listener", "talker")))


def skeleton_text(name: str) -> str:
    """Return a node's skeleton, or raise UsageError if there is none with this name."""
    if name not in NAMES:
        hint = did_you_mean(name, NAMES) or f"there are {', '.join(NAMES)}"
        raise UsageError(f"there is no skeleton of '{name}'", hint)
    return Path(__file__).with_name(f"{name}.py").read_text("utf-8")


def copy_skeleton(name: str, folder: Path, *, overwrite: bool = False) -> Path:
    """Write a node's skeleton into a folder, created if missing; return the file.

    Raises:
        UsageError: There is no skeleton of that name, or the file already exists.
        LcmtoolsError: It cannot be written.
    """
    text = skeleton_text(name)
    path = folder / f"{name}.py"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise UsageError(f"{folder} is not a folder", "name a folder to write into") from None
    except OSError as error:
        raise LcmtoolsError(f"cannot write {path}: {error.strerror}") from error
    if path.exists() and not overwrite:
        raise UsageError(f"{path} already exists", "--force overwrites it")
    write_whole(path, text)
    return path
