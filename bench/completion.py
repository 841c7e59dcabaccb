"""The time that a shell waits after TAB, beside Python itself.

Each question runs in turn, round after round; shown are medians and the slowest of wall time, and
of processor time, and their ratios to ``python -c pass``. The bus has a talker and a listener;
"images" is a bus with 60 MB/s of them besides, "nobody" one without nodes, and "wrong" a URL that
is none. "first" is the first completion of all: it reads the commands, for which click is needed.
"""

import os
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from multiprocessing.connection import Connection
from signal import SIGTERM, signal
from statistics import median

from commands import TOOL, Run, child_environment, run, talking
from common import bus, child, isolate, rounds_asked, show

_BREAKS = " \t\n\"'><=;|&(:"
_PORT = 7792  # of startup.child_environment
_IMAGE_BYTES = 640 * 480 * 3
_RATE = 65.0  # [Hz]
_QUESTIONS = {
    "a command": "lcmtools ec",
    "an option": "lcmtools echo --fi",
    "a type": "lcmtools msg show geometry_msgs/Tw",
    "a topic": "lcmtools echo /ch",
    "a field": "lcmtools echo /chatter.",
    "a prototype": "lcmtools pub /chatter std_msgs/String ",
    "a node": "lcmtools node info ",
    "a node to run": "lcmtools run ta",
}


def flood(connection: Connection, url: str) -> None:
    """Send images until asked to end."""
    from lcmtools.bus.multicast import sending_socket
    from lcmtools.bus.url import parse_url
    from lcmtools.wire.datagram import fragments

    where = parse_url(url)
    signal(SIGTERM, lambda *_: os._exit(0))
    connection.send("ready")
    with sending_socket(where) as camera:
        start, seqno = time.monotonic(), 0
        while True:
            seqno += 1
            for datagram in fragments(seqno, "/camera", bytes(_IMAGE_BYTES)):
                camera.sendto(datagram, (where.host, where.port))
            time.sleep(max(0.0, start + seqno / _RATE - time.monotonic()))


def ask(line: str, environment: Mapping[str, str]) -> Run:
    """One completion, as bash asks for it."""
    return run([TOOL, line, _BREAKS], {**environment, "_LCMTOOLS_COMPLETE": "bash"})


def measure(rounds: int) -> dict[str, list[Run]]:
    """Every question, round after round; the first round compiles and does not count."""
    runs: dict[str, list[Run]] = {}

    def note(label: str, one: Run) -> None:
        runs.setdefault(label, []).append(one)

    with tempfile.TemporaryDirectory() as cache:
        environment = {**child_environment(cache), "XDG_CACHE_HOME": f"{cache}/user"}
        with talking(environment):
            for _ in range(1 + rounds):
                note("python -c pass", run([sys.executable, "-c", "pass"], environment))
                for label, line in _QUESTIONS.items():
                    note(label, ask(line, environment))
                for label, url in (("nobody", bus(_PORT + 1)), ("wrong", "nonsense")):
                    other = {**environment, "LCM_DEFAULT_URL": url}
                    note(f"a topic, {label}", ask(_QUESTIONS["a topic"], other))
                shutil.rmtree(f"{cache}/new", ignore_errors=True)
                other = {**environment, "XDG_CACHE_HOME": f"{cache}/new"}
                note("a topic, first", ask(_QUESTIONS["a topic"], other))
            with child(flood, bus(_PORT)) as camera:
                camera.wait()
                for _ in range(1 + rounds):
                    note("a topic, images", ask(_QUESTIONS["a topic"], environment))
    return {label: found[1:] for label, found in runs.items()}


def rows(runs: Mapping[str, Sequence[Run]]) -> list[list[object]]:
    """The table: times in milliseconds, ratios to the first line."""
    table: list[list[object]] = []
    bare = next(iter(runs.values()))
    base = median(one.wall for one in bare) * 1000, median(one.processor for one in bare) * 1000
    for label, found in runs.items():
        wall = median(one.wall for one in found) * 1000
        slowest = max(one.wall for one in found) * 1000
        processor = median(one.processor for one in found) * 1000
        table.append([label, wall, wall / base[0], slowest, processor, processor / base[1]])
    return table


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 21)
    isolate()
    show(
        f"One completion, medians of {rounds}",
        ["question", "wall ms", "ratio", "slowest ms", "CPU ms", "ratio"],
        rows(measure(rounds)),
    )


if __name__ == "__main__":
    main()
