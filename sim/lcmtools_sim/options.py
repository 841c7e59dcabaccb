"""The simulator's command line, checked before anything is started."""

import argparse
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import NoReturn

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools_sim.engines import ENGINES
from lcmtools_sim.geometry import Pose
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import RobotModel

DEFAULT_WORLD = "husky"
_MOST_ROBOTS = 1000
_FARTHEST = 1e5  # [m], as in world files

_EXAMPLES = """\
names and the bus, as for every node:
  __name:=NAME, from:=to, --lcm-url URL, --domain N

examples:
  lcmtools run sim                         the lab's Husky in its yard, in real time
  lcmtools run sim --world ./yard.yaml --rate 4
  lcmtools run sim --world ./playground.world --robot husky@1,2,90deg
  lcmtools run sim multi --robots 20 --only husky10,husky11

--world takes a YAML file (--print-world husky is the start of one) or a world of Gazebo (.world,
.sdf), from which simple shapes are read. With --only, the process that has the world's first
robot publishes /clock, and the others follow it.
"""


@dataclass(frozen=True, slots=True)
class Options:
    """The options; see the parser's help. ``added`` has the robots from --robot."""

    world: str
    rate: float
    seed: int | None
    robots: int | None
    added: tuple[tuple[RobotModel, Pose], ...]
    only: tuple[str, ...]
    follow: bool
    engine: str
    view: bool
    version: bool
    paused: bool
    duration: float | None
    list_worlds: bool
    print_world: str | None
    check: str | None


def parse_options(arguments: Sequence[str]) -> Options:
    """Parse the command line; UsageError if it is wrong; ``--help`` prints and ends the program."""
    values = vars(_parser().parse_args(arguments))
    world, option = values["world"], values.pop("world_option")
    if world and option and world != option:
        raise UsageError(f"two worlds are given, '{world}' and '{option}'")
    values |= {"world": world or option or DEFAULT_WORLD, "added": tuple(values.pop("robot"))}
    return Options(**{field.name: values[field.name] for field in fields(Options)})


class _Parser(argparse.ArgumentParser):
    """Raises one-line errors."""

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
    rate = _number(float, 0.0, math.inf, "times real time, 0 or more")
    seed = _number(int, 0, 2**63, "a whole number, 0 or more")
    robots = _number(int, 1, _MOST_ROBOTS + 1, f"a whole number from 1 to {_MOST_ROBOTS}")
    duration = _number(float, 1e-3, math.inf, "a number of seconds above 0")
    add("world", nargs="?", metavar="WORLD", help=f"name or file (default: {DEFAULT_WORLD})")
    add("--world", dest="world_option", metavar="WORLD", help="the same as an option")
    add("--rate", type=rate, default=1.0, metavar="N", help="times real time; 0: no waiting")
    add("--seed", type=seed, metavar="N", help="instead of the world file's seed")
    add("--robots", type=robots, metavar="N", help="this many robots like the world's first")
    more = "one more robot, called /MODEL0, /MODEL1, ... (YAW in radians, or 90deg)"
    add("--robot", type=_robot, action="append", default=[], metavar="MODEL[@X,Y,YAW]", help=more)
    add("--only", type=_names, default=(), metavar="NAMES", help="simulate only these robots: a,b")
    add("--follow", action="store_true", help="follow the /clock of another process")
    add("--duration", type=duration, metavar="S", help="end after S simulated seconds")
    engine = "of physics (default: $LCMTOOLS_ENGINE, else bullet where pybullet is installed)"
    add("--engine", choices=ENGINES, default="", help=engine)
    view = "show it in the browser, by lcmtools gui world"
    add("--view", "--gui", action="store_true", help=view)
    add("--paused", action="store_true", help="wait for lcmtools sim resume, or step N")
    add("--version", action="store_true", help="print the versions of lcmtools and the engine")
    add("--list-worlds", action="store_true", help="list the worlds and exit")
    add("--print-world", metavar="NAME", help="print its file, as a start for your own")
    add("--check", metavar="FILE", help="check a world file, and exit")
    return parser


def _number(
    kind: Callable[[str], float], least: float, end: float, wanted: str
) -> Callable[[str], float]:
    """Return a reader of numbers from ``least`` to below ``end``."""

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value < end or (kind is int and not (text.isascii() and text.isdecimal())):
            raise argparse.ArgumentTypeError(f"must be {wanted}, not '{text}'")
        return value

    return read


def _robot(text: str) -> tuple[RobotModel, Pose]:
    """Read a model's name and its start ("husky@1,2,90deg")."""
    name, at, place = text.partition("@")
    if name not in MODELS:
        hint = did_you_mean(name, MODELS) or f"known models: {', '.join(MODELS)}"
        raise argparse.ArgumentTypeError(f"unknown model '{name}'; {hint}")
    try:
        x, y, yaw = place.split(",") if at else ("0", "0", "0")
        yaw = yaw.strip()
        turn = float(yaw.removesuffix("deg"))
        pose = Pose(float(x), float(y), yaw=math.radians(turn) if yaw.endswith("deg") else turn)
    except ValueError:
        pose = Pose(math.nan)
    if not all(abs(number) <= _FARTHEST for number in (pose.x, pose.y, pose.yaw)):
        wanted = "MODEL or MODEL@X,Y,YAW, for example husky@1,2,90deg"
        raise argparse.ArgumentTypeError(f"must be {wanted}, not '{text}'")
    return MODELS[name], pose


def _names(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"must be names with commas between, not '{text}'")
    return names
