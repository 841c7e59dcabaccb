"""Edits of logs; each converts a stream of messages into a stream of messages.

A long log needs no more memory than a short one, except for sorting, which keeps the place of each
message.
"""

import heapq
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from lcmtools.clock import NANOSECONDS
from lcmtools.errors import DecodeError, LcmtoolsError, UsageError, ValueMismatch
from lcmtools.graph.protocol import NODE_CHANNEL, decode_announcement, encode_announcement
from lcmtools.messages.filter import Filter
from lcmtools.names import SELF_TEST_CHANNEL, Pattern, did_you_mean, is_hidden, unescaped
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.settings import parse_duration
from lcmtools.wire.log_index import RecordedNode
from lcmtools.wire.packet import Packet


@dataclass(frozen=True, slots=True)
class TopicChoice:
    """A selection of topics by names, namespaces and patterns; none for all."""

    wanted: Sequence[str] = ()
    excluded: Sequence[str] = ()

    def has(self, topic: str) -> bool:
        """Return whether a topic is selected."""
        return (not self.wanted or _covers(self.wanted, topic)) and not _covers(
            self.excluded, topic
        )

    def check(self, known: Iterable[str], hint: str = "lcmtools bag info shows them") -> None:
        """Raise LcmtoolsError for a name that matches none of the known topics."""
        known = list(known)
        for word in (*self.wanted, *self.excluded):
            if not any(_covers([word], topic) for topic in known):
                near = did_you_mean(word, known)
                raise LcmtoolsError(f"there is no topic {word} in the log", near or hint)


def chosen(packets: Iterable[Packet], topics: TopicChoice) -> Iterator[Packet]:
    """Yield the messages of some topics."""
    known: dict[str, bool] = {}
    for packet in packets:
        has = known.get(packet.channel)
        if has is None:
            has = known[packet.channel] = topics.has(packet.channel)
        if has:
            yield packet


def visible(packets: Iterable[Packet]) -> Iterator[Packet]:
    """Yield the messages of topics that are not hidden, except liblcm's self test."""
    for packet in packets:
        if not (is_hidden(packet.channel) or packet.channel == SELF_TEST_CHANNEL):
            yield packet


def between(packets: Iterable[Packet], first: int, last: int) -> Iterator[Packet]:
    """Yield the messages recorded from one time to another [ns since 1970], both included."""
    return (packet for packet in packets if first <= packet.time <= last)


def matching(
    packets: Iterable[Packet],
    condition: Filter,
    types_of: Callable[[str], Sequence[str]],
    topics: TopicChoice | None = None,
) -> Iterator[Packet]:
    """Yield the messages that meet a condition, leaving out those that cannot be decoded.

    If ``topics`` are given, it is a condition for these only: all others are yielded.

    Raises:
        ValueMismatch: A message has no such field.
    """
    decoder, judged = Decoder(types_of), dict[str, bool]()
    for packet in packets:
        channel = packet.channel
        if topics and not judged.setdefault(channel, topics.has(channel)):
            yield packet
            continue
        try:
            message = decoder.decode(packet)
        except DecodeError:
            continue
        try:
            is_match = condition.matches(message)
        except ValueMismatch as mismatch:
            hint = mismatch.hint or "-t chooses topics, -s and -e times"
            raise ValueMismatch(mismatch.what, hint) from None
        if is_match:
            yield packet


def parse_renames(
    words: Sequence[str], known: Iterable[str], announced: Iterable[str] = ()
) -> dict[str, str]:
    """Return the new names of topics, from words such as "/old:=/new".

    A name that ends in "/" is a namespace and renames its topics. ``known`` have messages.

    Raises:
        UsageError: A word is not a rename, or two topics would become one.
        LcmtoolsError: It is for no topic.
    """
    known = list(known)
    names: dict[str, str] = {}
    for word in words:
        old, sign, new = word.partition(":=")
        old = unescaped(old)
        if not (old and sign and new) or old.endswith("/") != new.endswith("/"):
            raise UsageError(f"'{word}' is not a rename", "write OLD:=NEW, or /old/:=/new/")
        is_all = old.endswith("/")
        every = dict.fromkeys((*known, *announced))
        found = [one for one in every if one == old or (is_all and one.startswith(old))]
        if not found:
            TopicChoice([old]).check(known)
        names |= {one: unescaped(new) + one[len(old) :] for one in found}
    kept = [names.get(one, one) for one in known]
    if twice := next((one for one in kept if kept.count(one) > 1), ""):
        raise UsageError(f"two topics would be called {twice}", "rename the other one too")
    return names


def renamed(packets: Iterable[Packet], names: Mapping[str, str]) -> Iterator[Packet]:
    """Yield the messages with other names of topics; also in announcements."""
    for packet in packets:
        if packet.channel == NODE_CHANNEL:
            yield packet._replace(payload=_renamed_payload(packet.payload, names))
        elif packet.channel in names:
            yield packet._replace(channel=names[packet.channel])
        else:
            yield packet


def renamed_node(node: RecordedNode, names: Mapping[str, str]) -> RecordedNode:
    """Return an announcement with other names of topics."""
    return replace(node, payload=_renamed_payload(node.payload, names))


def parse_shift(text: str) -> int:
    """Return the time [ns] for a text such as "1.5s", or "-2m"; UsageError for others."""
    span = round(parse_duration(text.lstrip("+-")) * NANOSECONDS)
    return -span if text.startswith("-") else span


def shifted(packets: Iterable[Packet], by: int) -> Iterator[Packet]:
    """Yield the messages with later times of recording [ns]; stamps within them are not changed.

    Raises:
        UsageError: A time would be outside the range of logs.
    """
    for packet in packets:
        time = packet.time + by
        if not -(2**63) <= time // 1000 < 2**63:
            raise UsageError("a log cannot have times so far from 1970", f"one would be {time} ns")
        yield packet._replace(time=time)


def thinned(
    packets: Iterable[Packet], topics: TopicChoice, *, every: int = 1, rate: float = 0.0
) -> Iterator[Packet]:
    """Yield every ``every``-th message of the topics, at most at ``rate`` [Hz]; all of others."""
    counts: dict[str, int] = {}
    due: dict[str, int] = {}
    period = round(1e9 / rate) if rate else 0
    for packet in packets:
        name = packet.channel
        if not topics.has(name):
            yield packet
            continue
        counts[name] = count = counts.get(name, -1) + 1
        if count % every or packet.time < due.get(name, packet.time):
            continue
        # on a time grid: slightly late messages do not delay the next ones
        missed = (packet.time - due.get(name, packet.time)) // period if period else 0
        due[name] = due.get(name, packet.time) + (missed + 1) * period
        yield packet


def merged(logs: Sequence[LogFile]) -> Iterator[Packet]:
    """Yield the messages of several logs in the order of their times."""
    return heapq.merge(*map(in_order, logs), key=lambda packet: packet.time)


def in_order(log: LogFile, time_of: Callable[[Packet], int] | None = None) -> Iterator[Packet]:
    """Yield the messages of a log in the order of their times; equal times in the log's order.

    ``time_of`` gives other times than those of recording [ns since 1970], which they then have.
    """
    times, places, senders = array("q"), array("q"), array("l")
    known = [None, *log.senders.values()]
    numbers = {sender: number for number, sender in enumerate(known)}
    for event, sender in log.placed():
        time = time_of(event.packet(log.data)) if time_of else event.time
        times.append(time // 1000)  # a log has times in microseconds
        places.append(event.start)
        senders.append(numbers[sender])
    if not time_of and all(map(int.__le__, times, times[1:])):
        yield from log.packets()
        return
    for number in sorted(range(len(times)), key=times.__getitem__):
        event = next(log.events(places[number]))
        packet, time = event.packet(log.data), times[number] * 1000
        yield packet._replace(sender=known[senders[number]], time=time)


def _covers(words: Sequence[str], topic: str) -> bool:
    return any(Pattern(word, hidden=True).covers(topic) for word in words)


def _renamed_payload(payload: bytes, names: Mapping[str, str]) -> bytes:
    said = decode_announcement(payload)
    if said is None or not any(end.topic in names for end in said.node.endpoints):
        return payload
    ends = (end._replace(topic=names.get(end.topic, end.topic)) for end in said.node.endpoints)
    return encode_announcement(said._replace(node=said.node._replace(endpoints=tuple(ends))))
