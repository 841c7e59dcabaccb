"""Users' types: a tree of 2,187 files with 1,437 types, as many as 74 public projects have.

A type is looked up for the first time, when all files are parsed; then ``echo`` prints a message
of it from a log, also after a comment in one file has changed. All are beside an ``echo`` without
the tree, and in processor time, which a busy computer disturbs less than wall time.
"""

import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from statistics import median

import lcm
from commands import TOOL, Environment, Run, child_environment, in_turn, run
from common import rounds_asked, show

from lcmtools.messages.registry import fingerprint
from lcmtools.types.geometry_msgs import Point

_PROJECTS, _TYPES, _FILES = 74, 1437, 2187
_FIELDS = (
    "// [us] when it was measured",
    "int64_t utime;",
    "double position[3], covariance[6][6];",
    "int32_t num_values;",
    "float values[num_values]; // [m]",
    "boolean valid;",
)
_OWN = "p1/type75_t"
_CHANNEL = "OWN"
_PAYLOAD = 4000  # [B], more than it takes


def write_tree(root: Path) -> None:
    """Write the tree; the last files are copies of types, in folders of their own."""
    for number in range(_FILES):
        copied = number % _TYPES
        project = root / ("vendored" if number >= _TYPES else "projects") / f"p{copied % _PROJECTS}"
        project.mkdir(parents=True, exist_ok=True)
        (project / f"type{copied}_t.lcm").write_text(type_text(copied))


def type_text(number: int) -> str:
    """The content of a file: every second type contains others, and every fourth an enum."""
    lines = [f"package p{number % _PROJECTS};", "", "// A type."]
    fields = list(_FIELDS)
    if number % 4 == 0:
        lines.insert(1, f"enum mode{number}_t {{ IDLE=0, RUN=1 }}")
        fields.append(f"mode{number}_t mode;")
    if number // _PROJECTS % 2:
        other = number // 3
        fields += [
            f"type{number - _PROJECTS}_t previous;",
            f"p{other % _PROJECTS}.type{other}_t others[num_values];",
        ]
    return "\n".join((*lines, f"struct type{number}_t", "{", *fields, "}", ""))


def write_log(path: Path, number: int) -> None:
    """Write a log with a message of the type with a fingerprint: all its numbers are 0."""
    log = lcm.EventLog(str(path), "w", overwrite=True)
    log.write_event(1_000_000, _CHANNEL, number.to_bytes(8, "big") + bytes(_PAYLOAD))
    log.close()


def costs(environment: Environment, rounds: int) -> Iterator[tuple[str, float, float]]:
    """Yield what is measured: its name, and the processor time with and without a tree [s]."""
    with tempfile.TemporaryDirectory() as name:
        tree, cache = Path(name, "tree"), Path(name, "cache")
        write_tree(tree)
        own = {**environment, "LCMTOOLS_TYPE_PATH": str(tree), "XDG_CACHE_HOME": str(cache)}
        log, plain_log = Path(name, "own.lcmlog"), Path(name, "plain.lcmlog")
        first = run([TOOL, "msg", "fingerprint", _OWN], own)
        write_log(log, int(first.output, 16))
        write_log(plain_log, fingerprint(Point))
        echo = [TOOL, "echo", "-n", "1", _CHANNEL, "-b"]
        use = partial(run, [*echo, str(log)], own)

        def use_changed() -> Run:
            with (tree / "projects" / "p0" / "type0_t.lcm").open("a") as file:
                file.write("// changed\n")
            return use()

        ways: dict[str, Callable[[], Run]] = {
            "plain": partial(run, [*echo, str(plain_log)], environment),
            "use": use,
            "use after a change": use_changed,
        }
        found = in_turn(ways, rounds)
        times = {what: median(one.processor for one in some) for what, some in found.items()}
        times["first use"] = first.processor
        for what in ("first use", "use", "use after a change"):
            yield f"{what} of {_FILES} type files", times[what], times["plain"]


def main() -> None:
    """Print the table."""
    rounds = rounds_asked(__doc__, 10)
    with tempfile.TemporaryDirectory() as cache:
        rows = [
            (what, 1000 * ours, 1000 * plain, 1000 * (ours - plain))
            for what, ours, plain in costs(child_environment(cache), rounds)
        ]
    columns = ("what", "with the tree [ms]", "without [ms]", "more [ms]")
    show("Types of one's own, processor time", columns, rows)


if __name__ == "__main__":
    main()
