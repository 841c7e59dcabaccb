"""Nodes that were started a moment ago and load: a simulator takes two seconds.

They are found among the processes of this computer, by the command line of ``lcmtools run`` or
``lab start``, and by the bus that it and its environment select.
"""

import contextlib
import os
import re
import time
from collections.abc import Container, Iterator
from itertools import pairwise

from lcmtools.bus.kernel import own_network
from lcmtools.bus.processes import shows_own_pids, usage_of
from lcmtools.bus.url import BusUrl, choose_url
from lcmtools.errors import UsageError
from lcmtools.settings import read_user_file

_RUNS_NODE = re.compile(r"(?:^|[/\0])lcmtools\0((?:run|lab\0start)\0[^\0]+)")
_LONGEST = 20_000_000_000  # [ns] that a node may load


def starting_nodes(url: BusUrl, known: Container[int]) -> Iterator[str]:
    """Yield the nodes that load, to come to this bus: "lcmtools lab start husky (pid 4711)".

    ``known`` are the processes whose nodes have come.
    """
    names = os.listdir("/proc") if shows_own_pids() else ()  # noqa: PTH208 - Paths cost most of it
    for pid in map(int, filter(str.isdigit, names)):
        words = _text(pid, "cmdline")
        match = _RUNS_NODE.search(words)
        if not match or pid in known or not _is_young(pid):
            continue
        if _network(pid) == own_network() and _bus(words, _text(pid, "environ")) == url:
            yield f"lcmtools {match[1].replace(chr(0), ' ')} (pid {pid})"


def _is_young(pid: int) -> bool:
    usage = usage_of(pid)
    return usage is not None and time.time_ns() - usage.start_time < _LONGEST


def _network(pid: int) -> int:
    """Return the network namespace of a process, which containers have of their own."""
    with contextlib.suppress(OSError):
        return os.stat(f"/proc/{pid}/ns/net").st_ino  # noqa: PTH116
    return 0


def _text(pid: int, file: str) -> str:
    """Return a file of a process; "" if it has ended, or is another user's."""
    with contextlib.suppress(OSError), open(f"/proc/{pid}/{file}", "rb") as opened:  # noqa: PTH123
        return opened.read().decode("utf-8", "replace")
    return ""


def _bus(words: str, environment: str) -> BusUrl | None:
    """Return the bus that a command line and an environment select; None for a wrong choice."""
    given = dict(pairwise(words.split("\0")))
    variables = dict(one.split("=", 1) for one in environment.split("\0") if "=" in one)
    try:
        file = read_user_file(variables)
        return choose_url(given.get("--lcm-url"), given.get("--domain"), variables, file)[0]
    except UsageError:
        return None
