"""Forks: a lock that another thread holds at a fork is never released in the child."""

import os
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar, overload

_T = TypeVar("_T")


class _Lock(Protocol):
    def acquire(self) -> bool: ...
    def release(self) -> None: ...


def free_in_child(lock: _Lock) -> None:
    """Let a module's lock be free in every child: a fork waits until no other thread holds it."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(
            before=lock.acquire, after_in_parent=lock.release, after_in_child=lock.release
        )


class cached_property(Generic[_T]):  # noqa: N801 - as in functools
    """A property that is computed when it is first asked for, as functools' is, but without a lock.

    Before Python 3.12 that has one for all instances, and a child would wait for it forever.
    """

    def __init__(self, compute: Callable[[Any], _T]) -> None:
        self._compute = compute
        self.__doc__ = compute.__doc__

    def __set_name__(self, _: type, name: str) -> None:
        """Keep the name, under which instances keep their values."""
        self._name = name

    @overload
    def __get__(self, instance: None, owner: type) -> "cached_property[_T]": ...
    @overload
    def __get__(self, instance: object, owner: type) -> _T: ...
    def __get__(self, instance: object | None, owner: type) -> "cached_property[_T] | _T":
        """Compute the value, which from then on is an attribute of the instance."""
        if instance is None:
            return self
        value = instance.__dict__[self._name] = self._compute(instance)
        return value
