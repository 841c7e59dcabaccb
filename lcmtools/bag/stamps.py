"""Logs by the times in their messages, such as headers' stamps, instead of those of recording."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from lcmtools.bag.edits import in_order
from lcmtools.bag.summary import known_nodes
from lcmtools.bag.surgery import write_log
from lcmtools.bag.text_import import SUFFIXES, text_packets
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.observe.measuring.measure import TimeReader
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.wire.packet import Packet


class StampedLog:
    """The messages of a log by the times in them.

    One without a time of its own is moved as the last one with a time before it.

    Attributes:
        later: The first message's time in it, less that of its recording [ns].

    Raises:
        LcmtoolsError: No message has a time in it.
    """

    def __init__(self, log: LogFile) -> None:
        self._log = log
        self._reader = TimeReader(Decoder(known_nodes(log).types_of))
        found = ((self._time(packet), packet.time) for packet in log.packets())
        first = next((stamped - time for stamped, time in found if stamped), None)
        if first is None:
            raise LcmtoolsError(
                f"no message in {log.path} has a time in it", "leave out --by-stamp"
            )
        self.later = self._moved = first

    def packets(self) -> Iterator[Packet]:
        """Yield the messages in the order of these times, which are their times."""
        return in_order(self._log, self._stamped)

    def _stamped(self, packet: Packet) -> int:
        if time := self._time(packet):
            self._moved = time - packet.time
        return packet.time + self._moved

    def _time(self, packet: Packet) -> int:
        """Return the time in a message [ns since 1970]; 0 if there is none."""
        try:
            found = self._reader.read(packet)
        except LcmtoolsError:
            return 0
        return found.time if found else 0


@contextmanager
def by_stamp(
    paths: Sequence[str | Path],
    type_: str | None = None,
    topic: str | None = None,
    *,
    wanted: bool = True,
) -> Iterator[list[Path]]:
    """Give the paths of copies of logs that have the times in their messages; as long as needed.

    If not ``wanted``, the paths are those of the logs themselves. JSON lines and comma-separated
    values, which need a type and a topic, become logs.
    """
    if (type_ or topic) and not any(Path(one).suffix in SUFFIXES for one in paths):
        raise UsageError("--type and --as are for .csv and .jsonl", "leave them out")
    with TemporaryDirectory(prefix="lcmtools-") as folder:
        made = []
        for number, path in enumerate(map(Path, paths)):
            if path.suffix in SUFFIXES:
                copy = Path(folder, f"{number}.{path.name}.lcmlog")
                write_log(copy, text_packets(path, type_, topic), [])
                path = copy  # noqa: PLW2901 - a log from here on
            if not wanted:
                made.append(path)
                continue
            made.append(copy := Path(folder, f"{number}.{path.name}"))
            with LogFile(path) as log:
                stamped = StampedLog(log)
                write_log(copy, stamped.packets(), [log], later=stamped.later)
        yield made
