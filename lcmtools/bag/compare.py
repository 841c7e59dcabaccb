"""Comparing two logs, topic by topic."""

from array import array
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import blake2b

from lcmtools.observe.reading.log_file import LogFile
from lcmtools.text_table import plural


@dataclass(frozen=True, slots=True)
class TopicDifference:
    """The messages of a topic in two logs; equal messages have the same time and bytes."""

    topic: str
    first: int  # messages in the first log
    second: int
    only_first: int  # messages missing in the second one
    only_second: int
    is_reordered: bool = False  # the same messages, in another order

    @property
    def is_equal(self) -> bool:
        """True if the topic is the same in both."""
        return not (self.only_first or self.only_second or self.is_reordered)

    def __str__(self) -> str:
        """Return the difference as text."""
        if self.is_reordered:
            return f"{self.topic}: the same {self.first} messages in another order"
        if not self.first or not self.second:
            where = "first" if self.first else "second"
            count = plural(self.first or self.second, "message")
            return f"{self.topic}: only in the {where} log ({count})"
        parts = [f"{self.only_first} only in the first"] * bool(self.only_first)
        parts += [f"{self.only_second} only in the second"] * bool(self.only_second)
        equal = self.first - self.only_first
        return f"{self.topic}: {', '.join(parts)}, {equal} in both"


def differences(
    first: LogFile, second: LogFile, *, times: bool = True
) -> Iterator[TopicDifference]:
    """Yield the comparison of each topic; without ``times`` only the messages' bytes count.

    It keeps eight bytes of each message.
    """
    one, other = _digests(first, times=times), _digests(second, times=times)
    for topic in sorted({*one, *other}):
        left, right = one[topic], other[topic]
        if left == right:
            yield TopicDifference(topic, len(left), len(right), 0, 0)
            continue
        a, b = Counter(left), Counter(right)
        only = (a - b).total(), (b - a).total()
        yield TopicDifference(topic, len(left), len(right), *only, is_reordered=only == (0, 0))


def _digests(log: LogFile, *, times: bool) -> "defaultdict[str, array[int]]":
    found: defaultdict[str, array[int]] = defaultdict(lambda: array("Q"))
    for packet in log.packets():
        time = packet.time.to_bytes(12, "big", signed=True) if times else b""
        digest = blake2b(time + packet.payload, digest_size=8).digest()
        found[packet.channel].append(int.from_bytes(digest, "big"))
    return found
