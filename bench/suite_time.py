"""Run a command, such as the tests, and print its time as a multiple of a fixed reckoning's.

The reckoning is plain Python on one processor: the same on every computer, so that the ratio says
more of the tests than of the computer. It is done before and after, and the mean counts.
"""

import subprocess
import sys
import time

_STEPS = 20_000_000  # about a second on a computer of 2020


def reckon() -> float:
    """Return the time [s] that the fixed reckoning takes."""
    start, total = time.perf_counter(), 0
    for number in range(_STEPS):
        total += number & 3
    return time.perf_counter() - start


def main() -> int:
    """Run the command of the arguments; its exit code is the result."""
    before, start = reckon(), time.perf_counter()
    code = subprocess.run(sys.argv[1:], check=False).returncode
    seconds = time.perf_counter() - start
    mean = (before + reckon()) / 2
    print(f"{seconds:.0f} s, {seconds / mean:.0f} times the fixed reckoning of {mean:.2f} s")
    return code


if __name__ == "__main__":
    sys.exit(main())
