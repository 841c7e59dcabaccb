"""The context of this process and its signals: ``init``, ``ok`` and ``shutdown``."""

import atexit
import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from functools import partial
from types import FrameType

from lcmtools.arguments import NodeArguments, looks_special, misspelt, split_arguments
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import BusUrl, choose_url, misread_options
from lcmtools.errors import BusError, LcmtoolsError, UsageError, explained, os_errors_as
from lcmtools.messages.supply import has_supply
from lcmtools.node import checks
from lcmtools.node.context import Context
from lcmtools.packages import provide_user_types
from lcmtools.settings import read_user_file
from lcmtools.signals import Doubles, ending_signals

_GRACE = 0.5
"""Seconds that a running callback gets to return after Ctrl-C before it is interrupted."""


class _Process:
    """The one context of this process and its signal handlers.

    The package's only global state, because ``init`` and ``spin`` are functions, as in rclpy.
    """

    def __init__(self) -> None:
        self.context: Context | None = None
        self.note = ""
        self.handlers: dict[int, Callable[[int, FrameType | None], object] | int | None] = {}
        self.doubles = Doubles()


_process = _Process()


@explained
def init(
    args: Sequence[str] | None = None, *, url: str | None = None, handle_signals: bool = True
) -> list[str]:
    """Connect this process to the bus; the first thing a node's program does.

    Args:
        args: The command line without the program's name; None for ``sys.argv``. Names
            (``__ns:=``, ``a:=b``), parameters (``_gain:=2.0``) and the bus are taken from it.
        url: The bus, unless the command line gives one.
        handle_signals: On Ctrl-C, SIGTERM or a closed terminal, make ``spin`` return and ``ok``
            return False.

    Returns:
        The remaining arguments, which are the program's own.

    Raises:
        UsageError: The arguments, or the user's settings file, are wrong.
        BusError: The bus cannot be reached; the error says what to type.
    """
    checks.check_words(args)
    if _process.context is not None:
        raise LcmtoolsError("lcmtools.init() was called twice", "call lcmtools.shutdown() between")
    words = sys.argv[1:] if args is None else args
    arguments, rest = split_arguments(words)
    typed_url = arguments.lcm_url or (None if arguments.domain else url)
    domain, file = arguments.domain, read_user_file(os.environ)
    bus_url, source = choose_url(typed_url, domain, os.environ, file)
    _process.context = open_context(bus_url, arguments)
    _process.context.note, _process.note = _process.note, ""
    if not has_supply():
        provide_user_types()
    _process.context.notices += misread_options(bus_url, source)
    if file.problem:
        _process.context.notices.append(f"{file.problem}; there may be settings")
    if arguments.domain and source != "--domain":
        notice = f"--domain {arguments.domain} has no effect: {source} takes precedence"
        _process.context.notices.append(notice)
    _process.context.used.words = rest[: rest.index("--")] if "--" in rest else rest
    for word in filter(looks_special, _process.context.used.words):
        hint = misspelt(words, word) or "write from:=to without spaces"
        _process.context.notices.append(f"'{word}' names nothing; {hint}")
    if handle_signals and threading.current_thread() is threading.main_thread():
        _give_back_signals()  # after a ``shutdown`` on another thread
        _process.handlers = {
            number: signal.signal(number, _interrupted) for number in ending_signals()
        }
    atexit.register(shutdown)
    return rest


def set_note(text: str) -> None:
    """Let the first node that spins log a sentence about the program."""
    _process.note = text


def open_context(url: BusUrl, arguments: NodeArguments) -> Context:
    """Open an additional connection to a bus; the caller closes it.

    Raises:
        UsageError: The URL is a log's.
        BusError: The bus cannot be reached; the error says what to type.
    """
    from lcmtools.bus.open import open_bus

    if url.provider == "file" and url.options.get("mode", "r") == "r":
        hint = "read it with lcmtools echo --lcm-url, or give the node another bus"
        raise UsageError(f"{url} is a log, and nodes need a bus", hint)
    records = NodeRecords(url, os.environ)
    with os_errors_as(f"cannot open {url}", kind=BusError):
        context = Context(open_bus(url), arguments, os.environ, records, url)
    context.on_shutdown_request = partial(_end_as_by_signal, context)
    return context


def shutdown() -> None:
    """Say goodbye for all nodes and leave the bus. A second call does nothing."""
    context, _process.context = _process.context, None
    if context is None:
        return
    with contextlib.suppress(KeyboardInterrupt):  # a second Ctrl-C prevents no goodbye
        context.close()
    _give_back_signals()
    atexit.unregister(shutdown)


def ok() -> bool:
    """Return whether the program should go on: False after Ctrl-C, SIGTERM and ``shutdown``."""
    context = _process.context
    if context is None:
        return False
    context.is_ending = not context.ok()
    return not context.is_ending


def current_context() -> Context:
    """The process's context; LcmtoolsError if ``init`` has not been called."""
    if _process.context is None:
        raise LcmtoolsError("there is no bus yet", "call lcmtools.init() first")
    return _process.context


def _leave_to_parent() -> None:
    context, _process.context = _process.context, None
    if context is not None:
        context.leave_to_parent()
        _give_back_signals()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_leave_to_parent)


def _give_back_signals() -> None:
    """Restore the program's handlers; outside the main thread the next signal does it."""
    if threading.current_thread() is not threading.main_thread():
        return
    for number, handler in _process.handlers.items():
        if signal.getsignal(number) is _interrupted:
            signal.signal(number, handler)
    _process.handlers = {}


def _interrupted(number: int, _frame: FrameType | None) -> None:
    """Handle a signal: make all spin functions return; interrupt any that has not in 0.5 s."""
    context = _process.context
    if context is None and _process.handlers:  # ``shutdown`` was called on another thread
        _give_back_signals()
        signal.raise_signal(number)
        return
    if context is None or context.is_closed():
        return
    is_double = _process.doubles.is_double()
    if not context.ok():
        # SIGHUP comes twice, from an ending shell and from its terminal
        if is_double or number == signal.SIGHUP:
            return
        raise KeyboardInterrupt
    context.stop()
    thread = threading.Timer(_GRACE, _interrupt_again, [context])
    thread.daemon = True
    with contextlib.suppress(RuntimeError):  # no more threads: a second Ctrl-C interrupts it
        thread.start()


def _end_as_by_signal(context: Context) -> None:
    """End as if by SIGTERM if the program handles it, else stop; from any thread."""
    main = threading.main_thread().ident
    if main is not None and callable(signal.getsignal(signal.SIGTERM)):
        signal.pthread_kill(main, signal.SIGTERM)
    else:
        context.stop()


def _interrupt_again(context: Context) -> None:
    """Interrupt a callback that still runs, as a second Ctrl-C would.

    A program that is ending may take its time: to stop a robot, for example.
    """
    main = threading.main_thread().ident
    if main is None or context.is_ending or context.is_closed():
        return
    if _process.context is context:
        signal.pthread_kill(main, signal.SIGINT)
