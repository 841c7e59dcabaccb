"""What the simulator's command line says, checked before anything is started."""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

from lcmtools.errors import UsageError

DEFAULT_WORLD = "husky"

_EXAMPLES = """\
names and the bus, as for every node:
  __name:=NAME, from:=to, --lcm-url URL, --domain N

examples:
  lcmtools run sim                         the lab's Husky in its yard, in real time
  lcmtools run sim --world ./yard.yaml --rate 4
"""


@dataclass(frozen=True, slots=True)
class Options:
    """What to do.

    Attributes:
        world: Name or file.
        rate: Simulated seconds in a second; 0 as many as possible.
        seed: Instead of the world file's; None keeps that.
        gui: Whether to show it.
        duration: Simulated seconds to run; None runs until asked to end.
        list_worlds: Only name the worlds.
        print_world: Only print the file of this world.
        check: Only check this world file.
    """

    world: str
    rate: float
    seed: int | None
    gui: bool
    duration: float | None
    list_worlds: bool
    print_world: str | None
    check: str | None


def parse_options(arguments: Sequence[str]) -> Options:
    """Read the command line; ``--help`` prints and ends the program.

    Raises:
        UsageError: Something on it is wrong.
    """
    said = _parser().parse_args(arguments)
    if said.world and said.world_option and said.world != said.world_option:
        raise UsageError(f"two worlds are given, '{said.world}' and '{said.world_option}'")
    return Options(
        world=said.world or said.world_option or DEFAULT_WORLD,
        rate=said.rate,
        seed=said.seed,
        gui=said.gui,
        duration=said.duration,
        list_worlds=said.list_worlds,
        print_world=said.print_world,
        check=said.check,
    )


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, by raising it."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(message, "see lcmtools run sim --help")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="lcmtools run sim",
        description="Simulate robots, walls and boxes; they are steered and watched by topics.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("world", nargs="?", metavar="WORLD", help=f"name or file (default: {DEFAULT_WORLD})")
    add("--world", dest="world_option", metavar="WORLD", help="the same as an option")
    add("--rate", type=_rate, default=1.0, metavar="N", help="times real time; 0: no waiting")
    add("--seed", type=_seed, metavar="N", help="instead of the world file's seed")
    add("--duration", type=_duration, metavar="S", help="end after S simulated seconds")
    add("--gui", action="store_true", help="show it in a window")
    add("--list-worlds", action="store_true", help="list the worlds that are there, and end")
    add("--print-world", metavar="NAME", help="print its file, to start one of your own")
    add("--check", metavar="FILE", help="check a world file, and end")
    return parser


def _rate(text: str) -> float:
    return _number(text, 0.0, "times real time, 0 or more")


def _duration(text: str) -> float:
    return _number(text, 1e-3, "a number of seconds above 0")


def _number(text: str, minimum: float, wanted: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not minimum <= value < math.inf:
        raise argparse.ArgumentTypeError(f"must be {wanted}, not '{text}'")
    return value


def _seed(text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or int(text) >= 2**63:
        raise argparse.ArgumentTypeError(f"must be a whole number, 0 or more, not '{text}'")
    return int(text)
