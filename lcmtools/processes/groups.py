"""Groups of processes: sending them a signal, and whether anything of one is left.

Belongs here: what the system knows of groups. Must not know nodes.
"""

import contextlib
import os
from pathlib import Path


def send(group: int, number: int) -> bool:
    """Send a signal to a group of processes; whether there is one."""
    if group <= 0:  # 0 would be the launcher's own
        return False
    try:
        os.killpg(group, number)
    except ProcessLookupError:
        return False
    except PermissionError:  # macOS: only a process that has ended is left of it
        return False
    return True


def is_gone(group: int) -> bool:
    """Whether nothing of a group runs any more.

    What has ended may stay in the group for ever, where the system's first process, which inherits
    it, takes no notice of it, as in many containers. Where there is no /proc that is not known.
    """
    if not send(group, 0):
        return True
    processes = list(Path("/proc").glob("[0-9]*/stat"))
    return bool(processes) and not any(_runs_in(path, group) for path in processes)


def _runs_in(path: Path, group: int) -> bool:
    """Whether a process, by its stat file, is in a group and runs."""
    with contextlib.suppress(OSError, IndexError):  # it has ended just now
        # after the name, which may have blanks: state, parent, group (proc_pid_stat(5))
        state, _, of_group = path.read_text(errors="replace").rpartition(")")[2].split()[:3]
        return of_group == str(group) and state not in "ZX"
    return False
