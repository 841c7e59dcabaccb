"""The time that commands take from the shell, beside Python itself.

Each command runs in turn, round after round, on a bus with a talker at 10 Hz and a listener;
shown are medians of wall time and of processor time (user and system), and their ratios to
``python -c pass``. Bytecode is compiled before, as it is for every user after the first run.
``list``, ``info`` and ``type`` wait deliberately for nodes to answer, ``echo -n 1`` for a message.
"""

import sys
import tempfile
from collections.abc import Mapping, Sequence
from statistics import median

from commands import TOOL, Run, child_environment, run, talking
from common import isolate, rounds_asked, show

_COMMANDS = {
    "python -c pass": [sys.executable, "-c", "pass"],
    "python -c 'import click'": [sys.executable, "-c", "import click"],
    "lcmtools --help": [TOOL, "--help"],
    "lcmtools msg show": [TOOL, "msg", "show", "geometry_msgs/Twist"],
    "lcmtools list": [TOOL, "list"],
    "lcmtools node list": [TOOL, "node", "list"],
    "lcmtools info": [TOOL, "info", "/chatter"],
    "lcmtools type": [TOOL, "type", "/chatter"],
    "lcmtools pub -1": [TOOL, "pub", "-1", "/chatter", "std_msgs/String", "data: hello"],
    "lcmtools echo -n 1": [TOOL, "echo", "-n", "1", "/chatter"],
}


def measure(rounds: int) -> dict[str, list[Run]]:
    """Every command, round after round; the first round compiles and does not count."""
    runs: dict[str, list[Run]] = {label: [] for label in _COMMANDS}
    with tempfile.TemporaryDirectory() as cache:
        environment = child_environment(cache)
        with talking(environment):
            for _ in range(1 + rounds):
                for label, command in _COMMANDS.items():
                    runs[label].append(run(command, environment))
    return {label: found[1:] for label, found in runs.items()}


def rows(runs: Mapping[str, Sequence[Run]]) -> list[list[object]]:
    """The table: times in milliseconds, ratios to the first line."""
    table: list[list[object]] = []
    for label, found in runs.items():
        wall = median(one.wall for one in found) * 1000
        processor = median(one.processor for one in found) * 1000
        bare = table[0] if table else [label, wall, 1, processor]
        failures = sum(one.code != 0 for one in found)
        ratios = wall / float(str(bare[1])), processor / float(str(bare[3]))
        table.append([label, wall, ratios[0], processor, ratios[1], failures])
    return table


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 21)
    isolate()
    show(
        f"From the shell, medians of {rounds} runs",
        ["command", "wall ms", "ratio", "CPU ms", "ratio", "failed"],
        rows(measure(rounds)),
    )


if __name__ == "__main__":
    main()
