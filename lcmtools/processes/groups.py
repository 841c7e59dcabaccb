"""Groups of processes: sending them a signal, and finding out if anything of one is left."""

import contextlib
import os
from pathlib import Path


def send(group: int, number: int) -> bool:
    """Send a signal to a group of processes; return True if there is one."""
    if group <= 0:  # 0 would be this process's own
        return False
    try:
        os.killpg(group, number)
    except ProcessLookupError:
        return False
    except PermissionError:  # macOS: only a process that has ended is left of it
        return False
    return True


def is_gone(group: int) -> bool:
    """Return True if nothing of a group runs any more.

    A process that has ended may stay in the group for ever, if the system's first process, which
    inherits it, never waits for it, as in many containers. Without /proc that is not known.
    """
    if not send(group, 0):
        return True
    processes = list(Path("/proc").glob("[0-9]*/stat"))
    return bool(processes) and not any(_runs_in(path, group) for path in processes)


def _runs_in(path: Path, group: int) -> bool:
    """Return True if a process, by its stat file, is in a group and runs."""
    with contextlib.suppress(OSError, IndexError):  # it has just ended
        # after the name, which may have blanks: state, parent, group (proc_pid_stat(5))
        state, _, of_group = path.read_text(errors="replace").rpartition(")")[2].split()[:3]
        return of_group == str(group) and state not in "ZX"
    return False
