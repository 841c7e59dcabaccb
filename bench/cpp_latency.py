"""The time from publish to a callback at 1 kHz in C++: of a node, and of a program on plain liblcm.

The two run in turns, each with a sender on plain liblcm (``cpp/latency.cpp``). Shown are, as
medians over the rounds, each one's median and 99th percentile, and of the processor time that the
receiver uses for a message.
"""

import os
import re
import subprocess
import tempfile
from pathlib import Path
from statistics import median

from common import bus, isolate, rounds_asked, show

from lcmtools.packages.cmake import compiler_flags

_SOURCE = Path(__file__).parent / "cpp" / "latency.cpp"
_FIGURES = ("median [us]", "99 % [us]", "CPU [us]")


def figures(program: Path, way: str) -> list[float]:
    """The three figures of one run, each in microseconds."""
    environment = {**os.environ, "LCM_DEFAULT_URL": bus(7798)}
    command = [program, way]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return [float(number) for number in re.findall(r"([\d.]+) us", done.stdout)]


def main() -> None:
    """Compile the program, run it in turns, and print the table."""
    rounds = rounds_asked(__doc__, 7)
    isolate()
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, "latency")
        command = ["g++", "-O2", _SOURCE, *compiler_flags(), "-o", program]
        subprocess.run(command, check=True)
        runs = [(figures(program, "node"), figures(program, "plain")) for _ in range(rounds)]
    rows = []
    for place, name in enumerate(_FIGURES):
        ours, theirs = (median(run[side][place] for run in runs) for side in (0, 1))
        rows.append([name, ours, theirs, ours / theirs])
    show("messages to callbacks in C++", ["figure", "node", "liblcm", "ratio"], rows)


if __name__ == "__main__":
    main()
