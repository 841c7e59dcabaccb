"""Timing of a log that is played: lcmtools bag play beside lcm-logplayer.

A log of small messages at irregular times is played by each in turn, at rate 1. The kernel's time
of each message's arrival, less its time in the log, is how late it is; the earliest message of a
run counts as in time. Shown are the median and the 99th percentile of the rounds, in milliseconds,
the share of messages that arrived, and the processor time of the player by the time that it played.
"""

import random
import resource
import subprocess
import sys
import sysconfig
import tempfile
import time
from pathlib import Path
from statistics import median

from common import bus, isolate, quantile, rounds_asked, show

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.wire.log_events import encode_head
from lcmtools.wire.packet import Packet

_URL = bus(7798)
_CHANNEL = "MEASURED"
_MESSAGES = 1000
_LONGEST_GAP = 0.01  # [s]
_START = 1_795_000_000_000_000_000
_TAIL = 0.5  # [s] after the last message
_PROGRAMS = Path(sysconfig.get_paths()["purelib"]) / "bin"


def write_log(path: Path) -> list[int]:
    """Write a log, and return the times in it [ns]."""
    gaps = random.Random(7)  # noqa: S311 - the same log each time
    now, times = _START, []
    with path.open("wb") as file:
        for number in range(_MESSAGES):
            packet = Packet(_CHANNEL, number.to_bytes(8, "big"), now)
            file.write(encode_head(number, packet) + packet.payload)
            times.append(now // 1000 * 1000)
            now += round(gaps.uniform(0, _LONGEST_GAP) * 1e9)
    return times


def play(command: list[str], times: list[int]) -> tuple[list[float], float]:
    """Play the log; return how late each message came [ms], and the share of a core."""
    arrivals: dict[int, int] = {}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with (
        Tap(parse_url(_URL)) as tap,
        subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as player,
    ):
        ended = 0.0
        while not ended or time.monotonic() < ended + _TAIL:
            for packet in tap.receive(0.05):
                if packet.channel == _CHANNEL:
                    arrivals[int.from_bytes(packet.payload, "big")] = packet.time
            if not ended and player.poll() is not None:
                ended = time.monotonic()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    offsets = [arrival - times[number] for number, arrival in arrivals.items()]
    first = min(offsets, default=0)
    return [(offset - first) / 1e6 for offset in offsets], used / ((times[-1] - times[0]) / 1e9)


def main() -> None:
    """Measure, and print a table."""
    rounds = rounds_asked(__doc__, 5)
    isolate()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "measured.lcmlog"
        times = write_log(path)
        commands = {
            "lcmtools bag play": [
                *(sys.executable, "-m", "lcmtools", "bag", "play", str(path), "--lcm-url", _URL)
            ],
            "lcm-logplayer": [str(_PROGRAMS / "lcm-logplayer"), "-l", _URL, str(path)],
        }
        found: dict[str, list[tuple[list[float], float]]] = {name: [] for name in commands}
        for _ in range(rounds):
            for name, command in commands.items():
                found[name].append(play(command, times))
    rows = [
        (
            name,
            median(quantile(late, 0.5) for late, _ in runs),
            median(quantile(late, 0.99) for late, _ in runs),
            median(len(late) for late, _ in runs) / _MESSAGES,
            median(used for _, used in runs),
        )
        for name, runs in found.items()
    ]
    columns = ("player", "median [ms]", "99 % [ms]", "arrived", "of a core")
    show("Lateness of messages at rate 1", columns, rows)


if __name__ == "__main__":
    main()
