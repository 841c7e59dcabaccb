"""The window of a simulator: ``lcmtools gui world`` on the same bus, as a process of its own."""

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from lcmtools.arguments import NodeArguments, split_arguments
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_TIMEOUTS = StopTimeouts(interrupt=2.0, terminate=1.0)


@contextmanager
def opened_window(arguments: Sequence[str]) -> Iterator[None]:
    """Open the window; it ends with the context. The simulator's command line names the bus.

    It prints its address by itself, and the reason if it cannot be opened: the simulator goes on.
    """
    node, _ = split_arguments(arguments)
    bus = NodeArguments(lcm_url=node.lcm_url, domain=node.domain).words()
    command = [sys.executable, "-m", "lcmtools", "gui", "world", *bus]
    start = Start(command, os.environ, takes_terminal=True)
    with ProcessGuard() as guard, ChildProcess(start, guard, _TIMEOUTS):
        yield
