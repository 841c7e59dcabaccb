"""Signals that end a node in an orderly way, if it drives a robot or uses the terminal."""

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType

from lcmtools import Node

_ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


@contextlib.contextmanager
def ended_by_signals(node: Node) -> Iterator[None]:
    """Let signals that end a program only stop the node's context.

    A second signal interrupts nothing, so that a robot is stopped in any case.
    """

    def end(_number: int, _frame: FrameType | None) -> None:
        node.context.stop()

    before = {number: signal.signal(number, end) for number in _ENDING_SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            # the end of a terminal is reported twice, by the kernel and by the shell
            is_repeated = number == signal.SIGHUP and not node.context.ok()
            signal.signal(number, signal.SIG_IGN if is_repeated else handler)
