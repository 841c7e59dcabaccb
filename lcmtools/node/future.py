"""A future as in rclpy: the response to a request that is under way.

Must not know services or the bus.
"""

from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Future(Generic[T]):
    """The result of a call that has not ended. Made by ``Client.call_async``.

    It is completed by the thread that spins, which also runs the callbacks.
    """

    def __init__(self) -> None:
        self._result: T | None = None
        self._error: Exception | None = None
        self._is_done = self._is_cancelled = False
        self._callbacks: list[Callable[[Future[T]], object]] = []

    def done(self) -> bool:
        """Return whether there is a result or an error, or ``cancel`` was called."""
        return self._is_done

    def cancelled(self) -> bool:
        """Return whether ``cancel`` ended it."""
        return self._is_cancelled

    def cancel(self) -> None:
        """Wait for the result no longer; a call that has ended is not changed."""
        self._is_cancelled = not self._is_done
        self._end()

    def result(self) -> T | None:
        """Return the result, or raise the call's error; None while it is not done."""
        if self._error is not None:
            raise self._error
        return self._result

    def exception(self) -> Exception | None:
        """Return the call's error; None if there is none."""
        return self._error

    def add_done_callback(self, callback: "Callable[[Future[T]], object]") -> None:
        """Call a function with this future once it is done; at once if it is."""
        if self._is_done:
            callback(self)
        else:
            self._callbacks.append(callback)

    def set_result(self, result: T) -> None:
        """Complete it, unless it is done."""
        if not self._is_done:
            self._result = result
            self._end()

    def set_exception(self, error: Exception) -> None:
        """Complete it with an error, unless it is done."""
        if not self._is_done:
            self._error = error
            self._end()

    def _end(self) -> None:
        self._is_done = True
        while self._callbacks:
            self._callbacks.pop(0)(self)
