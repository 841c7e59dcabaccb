"""Running the callbacks of nodes: ``spin`` and ``spin_once``."""

import contextlib
import threading
from collections.abc import Sequence

from lcmtools.bus.base import refusal
from lcmtools.errors import UsageError, explained
from lcmtools.node import checks
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.node import Node


@explained
def spin(*nodes: Node) -> None:
    """Run the nodes' callbacks until Ctrl-C, SIGTERM or ``shutdown``.

    Raises:
        UsageError: There is no node, or one was destroyed or runs in another ``spin``.
    """
    if not nodes:
        raise UsageError("lcmtools.spin() has no node to run", "write lcmtools.spin(node)")
    for node in nodes:
        _check_node("spin", node)
    context = nodes[0].context
    for node in nodes if context.ok() else ():
        if node.is_destroyed:
            raise UsageError(f"lcmtools.spin: the node {node.name} was destroyed before")
        if node.callbacks.spinning_thread is not None:
            hint = "call it once, and not in a callback"
            raise UsageError(f"lcmtools.spin({node.name}) runs already", hint)
    nodes[0].warn_of_unknown_parameters()
    _run(context, [node.callbacks for node in nodes])
    context.is_ending = not context.ok()


def _run(context: Context, callbacks: Sequence[Callbacks]) -> None:
    for one in callbacks:
        one.spinning_thread = threading.get_ident()
    try:
        with contextlib.suppress(KeyboardInterrupt):
            while context.ok():
                context.run_once(callbacks, None)
    finally:
        for one in callbacks:
            one.spinning_thread = None


def _check_node(call: str, node: object) -> None:
    if isinstance(node, Node):
        if node.context.is_of_parent:
            raise refusal(is_of_parent=True)
        return
    hint = f"write lcmtools.{call}(node)"
    if isinstance(node, type) and issubclass(node, Node):
        hint = f"write lcmtools.{call}({node.__name__}())"
    elif isinstance(node, (list, tuple, set)):
        hint = f"write lcmtools.{call}(node, other_node)"
    raise UsageError(f"lcmtools.{call} needs a node, got {checks.described(node)}", hint)


@explained
def spin_once(node: Node, timeout: float | None = 0.0) -> None:
    """Wait for something to do, for ``timeout`` seconds at most (None: without end); do all of it.

    Returns as soon as callbacks have run, or when the time is over or the program should end.
    """
    _check_node("spin_once", node)
    if timeout == 0 and node.context.ok():  # a simulator does this in each of its steps
        node.callbacks.run_ready()
    else:
        node.context.run_once((node.callbacks,), timeout)
