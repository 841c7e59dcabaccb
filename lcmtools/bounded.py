"""A dictionary with a bound, for what programs on the bus may make grow without end."""

import math
from collections import Counter, OrderedDict
from collections.abc import ItemsView, Iterator, MutableMapping, ValuesView
from typing import TypeVar

K = TypeVar("K")
V = TypeVar("V")


MOST_ENTRIES = 4000
"""The most entries of a table, if its kind of entries needs no other bound."""


def count(counts: Counter[str], channel: str) -> None:
    """Count a message of a channel; of too many, forget the channel that was silent longest."""
    counts[channel] = counts.pop(channel, 0) + 1
    if len(counts) > MOST_ENTRIES:
        del counts[next(iter(counts))]


class BoundedDict(MutableMapping[K, V]):
    """A dictionary that drops the entries that were not used for the longest time.

    Setting an entry uses it, and so does ``use``; reading it otherwise does not. The latest entry
    always stays.

    Args:
        most: The most entries.
        most_bytes: The most bytes of all entries together, by the sizes given to ``put``.
    """

    def __init__(self, most: int = MOST_ENTRIES, most_bytes: float = math.inf) -> None:
        self._most, self._most_bytes = most, most_bytes
        self.forgotten = 0  # number of entries that were dropped
        self._entries: OrderedDict[K, V] = OrderedDict()
        self._sizes: dict[K, int] = {}
        self._bytes = 0

    def __len__(self) -> int:
        """Return the number of entries."""
        return len(self._entries)

    def __contains__(self, key: object) -> bool:
        """Return whether a key has an entry, without using it."""
        return key in self._entries

    def __iter__(self) -> Iterator[K]:
        """Return the keys, the least recently used first."""
        return iter(self._entries)

    def __setitem__(self, key: K, value: V) -> None:
        """Set an entry, whose size stays as it was; a new one has none."""
        self.put(key, value, self._sizes.get(key, 0))

    def put(self, key: K, value: V, size: int) -> None:
        """Set an entry of a size [byte], and drop others if there are too many."""
        if key in self._entries:
            self._entries.move_to_end(key)
        self._entries[key] = value
        self._resize(key, size)
        while len(self._entries) > self._most or (
            self._bytes > self._most_bytes and len(self._entries) > 1
        ):
            self.drop_oldest()

    def __getitem__(self, key: K) -> V:
        """Return the value of a key, without using it."""
        return self._entries[key]

    def __delitem__(self, key: K) -> None:
        """Remove an entry."""
        del self._entries[key]
        self._resize(key, 0)

    def use(self, key: K) -> V | None:
        """Return the value of a key; None if there is none."""
        value = self._entries.get(key)
        if value is not None:
            self._entries.move_to_end(key)
        return value

    def drop_oldest(self) -> None:
        """Drop the least recently used entry."""
        key, _ = self._entries.popitem(last=False)
        self._resize(key, 0)
        self.forgotten += 1

    def clear(self) -> None:
        """Remove all entries."""
        self._entries.clear()
        self._sizes.clear()
        self._bytes = 0

    def oldest(self) -> V:
        """Return the value of the least recently used entry; StopIteration if there is none."""
        return next(iter(self._entries.values()))

    def values(self) -> ValuesView[V]:
        """Return the values, the least recently used first."""
        return self._entries.values()

    def items(self) -> ItemsView[K, V]:
        """Return keys and values, the least recently used first."""
        return self._entries.items()

    def _resize(self, key: K, size: int) -> None:
        self._bytes += size - self._sizes.pop(key, 0)
        if size:
            self._sizes[key] = size
