"""Running nodes' callbacks."""

import contextlib
import time

from lcmtools.node.context import Context
from lcmtools.node.node import Node
from lcmtools.node.process import current_context


def spin(*nodes: Node) -> None:
    """Run the nodes' callbacks until Ctrl-C, SIGTERM or ``shutdown``."""
    context = nodes[0].context if nodes else current_context()
    for node in nodes[:1]:
        node.warn_of_unknown_parameters()
    with contextlib.suppress(KeyboardInterrupt):
        while context.ok():
            _run_once(context, nodes, None)
    context.is_told = not context.ok()


def spin_once(node: Node, timeout: float | None = 0.0) -> None:
    """Wait for something to do, for ``timeout`` seconds at most (None: without end); do all of it.

    Returns as soon as callbacks have run, or when the time is over or the program should end.
    """
    if timeout == 0 and node.context.ok():  # a simulator does this in each of its steps
        node.callbacks.run_ready()
    else:
        _run_once(node.context, (node,), timeout)


def _run_once(context: Context, nodes: tuple[Node, ...], timeout: float | None) -> None:
    deadline = None if timeout is None else time.monotonic() + timeout
    while context.ok():
        if sum(node.callbacks.run_ready() for node in nodes):
            return
        left = None if deadline is None else deadline - time.monotonic()
        if left is not None and left <= 0:
            return
        waits = [wait for node in nodes if (wait := node.callbacks.time_to_timer()) is not None]
        context.wakeup.wait(min([*waits, *([] if left is None else [left])], default=None))
