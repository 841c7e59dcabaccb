"""Several logs read as one, such as the files of a split recording."""

import heapq
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from itertools import chain
from pathlib import Path

from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.losses import Loss
from lcmtools.wire.log_index import RecordedType
from lcmtools.wire.packet import Packet, Sender


class Logs(AbstractContextManager["Logs"]):
    """Logs that are open for reading, the earliest first; their messages are merged by time.

    Attributes:
        files: The logs.
        between: The first and last time of the messages that count [ns since 1970]; None for all.

    Raises:
        BusError: A file cannot be read, or is not a log.
    """

    def __init__(self, paths: Iterable[str | Path]) -> None:
        self.files: list[LogFile] = []
        self.between: tuple[int, int] | None = None
        try:
            self.files += map(LogFile, dict.fromkeys(map(str, paths)))
        except BaseException:
            self.close()
            raise
        first = {one: next((event.time for event in one.events()), 0) for one in self.files}
        self.files.sort(key=first.__getitem__)

    def __exit__(self, *_: object) -> None:
        """Close the files."""
        self.close()

    def close(self) -> None:
        """Close the files."""
        for one in self.files:
            one.close()

    def packets(self) -> Iterator[Packet]:
        """Yield the messages, those of a log in its order."""
        parts: list[Iterator[Packet]] = [one.packets() for one in self.files]
        if self.between:
            first, last = self.between
            parts = [
                (packet for packet in packets if first <= packet.time <= last)
                for packets in (one.packets(one.offset_at(first)) for one in self.files)
            ]
        return parts[0] if len(parts) == 1 else heapq.merge(*parts, key=lambda one: one.time)

    def last(self, count: int) -> Iterator[Packet]:
        """Yield the last ``count`` messages of each channel; of nodes' announcements all."""
        kept: defaultdict[str, deque[tuple[int, Packet]]] = defaultdict(lambda: deque(maxlen=count))
        kept[NODE_CHANNEL] = deque()
        for number, packet in enumerate(self.packets()):
            kept[packet.channel].append((number, packet))
        for _, packet in sorted(chain(*kept.values()), key=lambda one: one[0]):
            yield packet

    def span(self) -> tuple[int, int]:
        """Return the times of the first and the last message [ns since 1970]; 0, 0 for none."""
        blocks = [block for one in self.files for block in one.blocks()]
        first = min((block.first_time for block in blocks), default=0)
        return first, max((block.last_time for block in blocks), default=0)

    def announcements(self) -> Iterator[Packet]:
        """Yield the announcements of nodes in the indexes."""
        return chain.from_iterable(one.announcements() for one in self.files)

    def types(self) -> list[RecordedType]:
        """Return the types that the indexes have."""
        return [kind for one in self.files for kind in one.index.types.values()]

    def losses(self) -> dict[Sender, Loss]:
        """Return the loss of each sender, as the recorders saw it."""
        found: dict[Sender, Loss] = {}
        for one in self.files:
            for sender, loss in one.losses(self.between).items():
                found[sender] = found.get(sender, Loss()) + loss
        return found

    def damage(self) -> str:
        """Return a sentence on the bytes that belong to no message; "" if there are none."""
        return "; ".join(filter(None, (one.damage() for one in self.files)))

    def damaged_bytes(self) -> int:
        """Return the number of bytes that belong to no message."""
        events = (event for one in self.files for event in one.events())
        return sum(one.size for one in self.files) - sum(one.end - one.start for one in events)
