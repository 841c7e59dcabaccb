"""Running the callbacks of nodes: ``spin``, ``spin_in_background`` and ``spin_once``."""

import contextlib
import threading
import time
from collections.abc import Iterator, Sequence

from lcmtools.bus.base import refusal, start_thread
from lcmtools.errors import BusError, UsageError, explained
from lcmtools.node import checks
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.future import Future
from lcmtools.node.node import Node

_LONGEST_CALLBACK = 2.0  # [s] that ``stop`` waits for


class BackgroundSpin:
    """A thread that runs the callbacks of nodes. Made by ``spin_in_background``.

    As a context manager, it stops at the end of the block.

    Attributes:
        nodes: The nodes.
    """

    def __init__(self, nodes: tuple[Node, ...]) -> None:
        self.nodes = nodes
        self._context = nodes[0].context
        self._is_stopped = False
        self._has_started = threading.Event()
        self._context.background_spins.append(self)
        try:
            start_thread(self._run, "background spin")
        except BusError:
            self._context.background_spins.remove(self)
            raise
        self._has_started.wait()

    def __enter__(self) -> "BackgroundSpin":
        """Use it as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Stop."""
        self.stop()

    def is_running(self) -> bool:
        """Return whether callbacks run: until ``stop``, ``shutdown`` or the end of all nodes."""
        return self._thread.is_alive()

    def stop(self) -> None:
        """Stop running callbacks, and wait until the current one returns, for 2 s at most.

        The nodes go on otherwise: they can publish, and spin again. A second call does nothing, and
        a callback may call it.
        """
        self._is_stopped = True
        self._context.wake()
        if threading.current_thread() is not self._thread:
            self._thread.join(_LONGEST_CALLBACK)

    def _run(self) -> None:
        self._thread = threading.current_thread()  # before a callback can stop it
        callbacks = [node.callbacks for node in self.nodes]
        try:
            with _spinning(callbacks):
                self._has_started.set()
                self._context.run(callbacks, self._is_over)
        finally:
            self._context.background_spins.remove(self)

    def _is_over(self) -> bool:
        return self._is_stopped or all(node.is_destroyed for node in self.nodes)


@explained
def spin(*nodes: Node) -> None:
    """Run the nodes' callbacks until Ctrl-C, SIGTERM or ``shutdown``.

    Raises:
        UsageError: There is no node, or one was destroyed or runs in another ``spin``.
        BusOfParent: This is a forked process, and a node is its parent's.
    """
    context = _check_nodes("spin", nodes)
    if context.ok():
        _check_are_idle("spin", nodes)
    nodes[0].warn_of_unused_arguments()
    callbacks = [node.callbacks for node in nodes]
    with _spinning(callbacks), contextlib.suppress(KeyboardInterrupt):
        context.run(callbacks)
    context.is_ending = not context.ok()


@explained
def spin_in_background(*nodes: Node) -> BackgroundSpin:
    """Run the nodes' callbacks on a thread of their own, and return at once.

    It ends with ``stop`` of the returned object, or with ``shutdown``. Ctrl-C in the calling thread
    does not end it, unless ``init`` handles signals. If these nodes run in the background already,
    that is returned, so that the cell of a notebook can be executed again.

    Raises:
        UsageError: There is no node, or one was destroyed or runs in another ``spin``.
        BusOfParent: This is a forked process, and a node is its parent's.
    """
    context = _check_nodes("spin_in_background", nodes)
    for running in tuple(context.background_spins):
        if isinstance(running, BackgroundSpin) and running.nodes == nodes and running.is_running():
            return running
    _check_are_idle("spin_in_background", nodes)
    nodes[0].warn_of_unused_arguments()
    return BackgroundSpin(nodes)


@contextlib.contextmanager
def _spinning(callbacks: Sequence[Callbacks]) -> Iterator[None]:
    """Mark callbacks as run by this thread."""
    for one in callbacks:
        one.spinning_thread = threading.get_ident()
    try:
        yield
    finally:
        for one in callbacks:
            one.spinning_thread = None


def _check_nodes(call: str, nodes: Sequence[Node]) -> Context:
    """Return the context of nodes; refuse what is none."""
    if not nodes:
        raise UsageError(f"lcmtools.{call}() has no node to run", f"write lcmtools.{call}(node)")
    contexts = [_context_of(call, node) for node in nodes]
    return contexts[0]


def _check_are_idle(call: str, nodes: Sequence[Node]) -> None:
    for node in nodes:
        if node.is_destroyed:
            raise UsageError(f"lcmtools.{call}: the node {node.name} was destroyed before")
        if node.callbacks.spinning_thread is not None:
            hint = "call it once, and not in a callback"
            raise UsageError(f"lcmtools.{call}({node.name}) runs already", hint)


def _context_of(call: str, node: object) -> Context:
    """Return the context of a node; refuse what is none, and nodes of a forked process's parent."""
    if isinstance(node, Node):
        context = node.context
        if context.is_of_parent:
            raise refusal(is_of_parent=True)
        return context
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
    context, callbacks = _context_of("spin_once", node), node.callbacks
    if timeout == 0 and context.ok():  # a simulator does this in each of its steps
        if not callbacks.run_ready() and context.lockstep:
            context.lockstep.answer((callbacks,))
    else:
        context.run_once((callbacks,), timeout)


@explained
def spin_until_future_complete(
    node: Node, future: Future[object], timeout: float | None = None
) -> None:
    """Run the node's callbacks until a future is done, for ``timeout`` seconds at most.

    Returns also when the program should end; ``future.done()`` tells.
    """
    context = _context_of("spin_until_future_complete", node)
    if not isinstance(future, Future):
        what = f"spin_until_future_complete needs a future, got {checks.described(future)}"
        raise UsageError(what, "write future = client.call_async(request)")
    deadline = None if timeout is None else time.monotonic() + timeout
    while context.ok() and not future.done():
        left = None if deadline is None else deadline - time.monotonic()
        if left is not None and left <= 0:
            return
        context.run_once((node.callbacks,), left, future.done)
