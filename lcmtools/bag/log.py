"""A log for Python programs: its content and its messages.

with lcmtools.bag.open("ride.lcmlog") as log:
    print(log.duration, list(log.topics))
    for arrival in log.messages("/husky0/odometry", start="10s", end="end-1m"):
        print(arrival.time, arrival.sender, arrival.message.pose.pose.position.x)
"""

import sys
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

from lcmtools.bag.columns import table, with_times
from lcmtools.bag.summary import LogSummary, TopicSummary, known_nodes, summarize
from lcmtools.bag.times import time_of, time_window
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.forks import cached_property
from lcmtools.messages.supply import has_supply
from lcmtools.names import did_you_mean
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.received import Arrival, messages, usual_names
from lcmtools.packages import provide_user_types

if TYPE_CHECKING:
    from lcmtools.bag.columns import Array

_ALL_TOPICS = "**"


class Log(AbstractContextManager["Log"]):
    """A log that is open for reading; iterating over it yields all messages except hidden ones.

    Attributes:
        path: The file.

    Raises:
        BusError: The file cannot be read, or is not a log.
    """

    def __init__(self, path: str | Path) -> None:
        if not has_supply():
            provide_user_types()
        self.path = Path(path)
        self._file = LogFile(path)

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __iter__(self) -> Iterator[Arrival]:
        """Yield the messages of all topics, as ``messages`` does."""
        return self.messages()

    @cached_property
    def summary(self) -> LogSummary:
        """Everything that ``bag info`` shows; a log without an index is read for this."""
        return summarize(self._file)

    @property
    def topics(self) -> dict[str, TopicSummary]:
        """The topics by name: their types, counts, rates, sizes and times."""
        return {topic.name: topic for topic in self.summary.topics}

    @property
    def start(self) -> int:
        """The time of the first message [ns since 1970]; 0 for an empty log."""
        return self.summary.start

    @property
    def end(self) -> int:
        """The time of the last message [ns since 1970]; 0 for an empty log."""
        return self.summary.end

    @property
    def duration(self) -> float:
        """The time from the first to the last message [s]."""
        return self.summary.duration

    def messages(
        self,
        *topics: str | Iterable[str],
        start: str | float | None = None,
        end: str | float | None = None,
        where: str | None = None,
        on_error: Callable[[DecodeError], None] | None = None,
        undecoded: bool = False,
    ) -> Generator[Arrival, None, None]:
        """Yield the messages of topics, as ``lcmtools.observe.messages`` does on a bus.

        Args:
            *topics: Names or patterns, or lists of these; none for all.
            start: The time at which to begin: "10s", "end-1m", "12:30:05", "2026-11-22 12:30:05";
                seconds after the start, or since 1970; or an int in ns since 1970, as ``start``
                and the times of arrivals are.
            end: The time at which to end.
            where: Yield only messages for which this expression is true.
            on_error: Called for each message that is left out because it cannot be decoded; None
                for a Python warning, once for each error.
            undecoded: Yield an arrival for such a message, too; its ``message`` raises the error.

        Raises:
            UsageError: A time, a topic or the expression is wrong.
            LcmtoolsError: The log has no message on the topics.
        """
        words = [word for one in topics for word in ([one] if isinstance(one, str) else one)]
        return messages(
            *(words if topics else (_ALL_TOPICS,)),
            log=self.path,
            where=where,
            on_error=on_error,
            undecoded=undecoded,
            between=self._between(start, end),
        )

    def to_numpy(
        self, topic: str, *, start: str | float | None = None, end: str | float | None = None
    ) -> "Mapping[str, Array]":
        """Return the messages of a topic as arrays, with a row for each message.

        They have the paths of fields as keys: ``"pose.pose.position.x"``, with more axes for an
        array (see ``columns.Table``); and ``"%time"``, the times of arrival [ns since 1970].
        Messages of another type than the first, and damaged ones, are left out. Names and times are
        as in ``messages``.

        Raises:
            UsageError: A time is wrong.
            LcmtoolsError: The log has no message on the topic, or none of a type that is known and
                does not contain itself.
        """
        first, last = self._between(start, end) or (-sys.maxsize, sys.maxsize)
        decoder = Decoder(known_nodes(self._file).types_of)
        spelled = set(usual_names().spellings(topic))
        packets = (one for one in self._file.packets() if one.channel in spelled)
        found = [one for one in packets if first <= one.time <= last]
        if not found:
            near = did_you_mean(topic, self.topics)
            raise LcmtoolsError(f"{self.path} has no messages of {topic} between these times", near)
        long = (one for one in found if one.fingerprint is not None)
        made = table(
            decoder.message_class(next(long, found[0])), [packet.payload for packet in found]
        )
        return with_times([packet.time for packet in found], made)

    def _between(
        self, start: str | float | None, end: str | float | None
    ) -> tuple[int, int] | None:
        if start is None and end is None:
            return None
        first, last = (None if one is None else time_of(one) for one in (start, end))
        return time_window((self.start, self.end), first, last)


def open_log(path: str | Path) -> Log:
    """Open a log written by lcmtools, lcm-logger, or any other LCM program.

    Raises:
        BusError: The file cannot be read, or is not a log.
    """
    return Log(path)
