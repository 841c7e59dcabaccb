"""The use of this computer's resources by a process, as lines of text."""

import time

from lcmtools.bus.processes import Process
from lcmtools.observe.reading.senders import user_name


def usage_rows(pid: int, now: int) -> list[str]:
    """Return the resources that a process of this computer uses; none if the system hides them."""
    taken = Process(pid).usage()
    if taken is None:
        return []
    started = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(taken.start_time / 1e9))
    share = percent(taken.processor_time, (now - taken.start_time) / 1e9)
    return [
        f"User: {user_name(taken.uid)}",
        f"Started: {started}",
        f"Memory: {taken.memory_bytes / 1e6:.1f} MB",
        f"Processor: {share} of a core since it started",
    ]


def percent(spent: float, seconds: float) -> str:
    """Return a share of some time as text."""
    return f"{100 * spent / max(1e-9, seconds):.1f} %"
