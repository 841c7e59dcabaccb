"""Nodes that were started a moment ago and load: a simulator takes two seconds.

They are found among the processes of this computer, by the command line of ``lcmtools run`` or
``lab start``, and by the bus that it and its environment select.
"""

import re
import time
from collections.abc import Container, Iterator, Mapping
from itertools import pairwise

from lcmtools.bus.kernel import own_network
from lcmtools.bus.processes import Process, running
from lcmtools.bus.url import BusUrl, choose_url
from lcmtools.errors import UsageError
from lcmtools.settings import read_user_file

_RUNS_NODE = re.compile(r"(?:^|[/\0])lcmtools\0((?:run|lab\0start)\0[^\0]+)")
_LONGEST = 20_000_000_000  # [ns] that a node may load


def starting_nodes(url: BusUrl, known: Container[int]) -> Iterator[str]:
    """Yield the nodes that load, to come to this bus: "lcmtools lab start husky (pid 4711)".

    ``known`` are the processes whose nodes have come.
    """
    for process in running():
        words = process.text("cmdline")
        match = _RUNS_NODE.search(words)
        if not match or process.pid in known or not _is_young(process):
            continue
        if process.network == own_network() and _bus(words, process.environment) == url:
            yield f"lcmtools {match[1].replace(chr(0), ' ')} (pid {process.pid})"


def _is_young(process: Process) -> bool:
    usage = process.usage()
    return usage is not None and time.time_ns() - usage.start_time < _LONGEST


def _bus(words: str, environment: Mapping[str, str]) -> BusUrl | None:
    """Return the bus that a command line and an environment select; None for a wrong choice."""
    words = re.sub("\0(--lcm-url|--domain)=", "\0\\1\0", words)
    given = dict(pairwise(words.split("\0")))
    try:
        file = read_user_file(environment)
        return choose_url(given.get("--lcm-url"), given.get("--domain"), environment, file)[0]
    except UsageError:
        return None
