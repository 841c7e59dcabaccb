"""Time that `bag info` takes for a log of 10 GB: by its index, and for a smaller one without.

The log of 10 GB is a sparse file with a synthetic index, of 20 topics and 100 MB a second, in
blocks as the recorder makes them. The one without an index has messages of 1 kB, and is compared
with reading the file's bytes.
"""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from common import rounds_asked

from lcmtools.bag.summary import summarize
from lcmtools.bag.summary_report import to_lines
from lcmtools.bag.writer import LogWriter
from lcmtools.observe.reading.log_file import LogFile, index_path
from lcmtools.wire import log_index
from lcmtools.wire.log_events import SYNC
from lcmtools.wire.packet import Packet, Sender

SIZE = 10 * 10**9
PAYLOAD = 50_000  # bytes
TOPICS = 20
MESSAGES = 200_000


def main() -> None:
    """Measure both."""
    rounds = rounds_asked(__doc__, 10)
    with tempfile.TemporaryDirectory() as folder:
        large, small = Path(folder, "large.lcmlog"), Path(folder, "small.lcmlog")
        blocks = make_large(large)
        make_small(small)
        size = index_path(large).stat().st_size
        best = min(timed(lambda: info(large)) for _ in range(rounds))
        print(f"10 GB, {blocks} blocks, index of {size / 1e3:.0f} kB: {1e3 * best:.1f} ms")
        index_path(small).unlink()
        best = min(timed(lambda: info(small)) for _ in range(rounds))
        read = min(timed(small.read_bytes) for _ in range(rounds))
        mb = small.stat().st_size / 1e6
        print(f"without an index, 1 kB messages: {mb / best:.0f} MB/s; read alone {mb / read:.0f}")


def info(path: Path) -> None:
    """Do what `bag info` does, but for printing."""
    with LogFile(path) as log:
        summary = summarize(log)
        to_lines(summary)


def timed(work: Callable[[], object]) -> float:
    """Return how long some work takes [s]."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def make_large(path: Path) -> int:
    """Write a sparse log with the index of a full one; return the number of its blocks."""
    count = number = end = 0
    with path.open("wb") as file, index_path(path).open("w") as index:
        index.write(log_index.index_line())
        for one in range(TOPICS):
            sender = log_index.RecordedSender(Sender("127.0.0.1", 4000 + one), f"/node{one}")
            index.write(log_index.sender_line(one, sender))
        while end < SIZE:
            file.seek(end)
            file.write(SYNC)
            block = log_index.Block(end)
            while not block.is_full(end):
                topic = number % TOPICS
                time = number * PAYLOAD * 10  # 100 MB/s
                name = f"/robot/topic{topic}"
                block.add(Packet(name, b"\1" * 8, time, whole_bytes=PAYLOAD), topic)
                number += 1
                end += PAYLOAD
            block.end = end
            count += 1
            index.write(log_index.block_line(block))
        file.truncate(end)
        index.write(log_index.end_line(end))
    return count


def make_small(path: Path) -> None:
    """Write a log of small messages."""
    with LogWriter(path) as log:
        for number in range(MESSAGES):
            log.add(Packet(f"/topic{number % 5}", bytes(1000), number * 1_000_000))
            if number % 1000 == 0:
                log.flush()


if __name__ == "__main__":
    main()
