"""What the simulator's command line says, checked before anything is started."""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools_sim.pose import Pose
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import RobotModel

DEFAULT_WORLD = "husky"
_MOST_ROBOTS = 1000
_FARTHEST = 1e5  # [m], as world files have it

_EXAMPLES = """\
names and the bus, as for every node:
  __name:=NAME, from:=to, --lcm-url URL, --domain N

examples:
  lcmtools run sim                         the lab's Husky in its yard, in real time
  lcmtools run sim --world ./yard.yaml --rate 4
  lcmtools run sim --world ./playground.world --robot husky@1,2,90deg
  lcmtools run sim multi --robots 20 --only husky10,husky11

--world takes a YAML file (--print-world husky is the start of one) or a world of Gazebo (.world,
.sdf), of which the simple shapes are read. With --only, the process that has the world's first
robot publishes /clock, and the others go by it.
"""


@dataclass(frozen=True, slots=True)
class Options:
    """What to do.

    Attributes:
        world: Name or file.
        rate: Simulated seconds in a second; 0 as many as possible.
        seed: Instead of the world file's; None keeps that.
        robots: So many like the world's first; None keeps the world's own.
        added: More robots: models, and where they start.
        only: The names of the robots that this process simulates; none means all.
        follow: Go by the /clock of another process.
        gui: Whether to show it.
        paused: Whether to wait for a call before the first step.
        duration: Simulated seconds to run; None runs until asked to end.
        list_worlds: Only name the worlds.
        print_world: Only print the file of this world.
        check: Only check this world file.
    """

    world: str
    rate: float
    seed: int | None
    robots: int | None
    added: tuple[tuple[RobotModel, Pose], ...]
    only: tuple[str, ...]
    follow: bool
    gui: bool
    paused: bool
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
        robots=said.robots,
        added=tuple(said.robot),
        only=said.only,
        follow=said.follow,
        gui=said.gui,
        paused=said.paused,
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
    add("--robots", type=_robots, metavar="N", help="so many robots like the world's first")
    add(
        "--robot",
        type=_robot,
        action="append",
        default=[],
        metavar="MODEL[@X,Y,YAW]",
        help="one more robot, called /MODEL0, /MODEL1, ... (YAW in radians, or 90deg)",
    )
    add("--only", type=_names, default=(), metavar="NAMES", help="simulate only these robots: a,b")
    add("--follow", action="store_true", help="go by the /clock of another process")
    add("--duration", type=_duration, metavar="S", help="end after S simulated seconds")
    add("--gui", action="store_true", help="show it in a window")
    add("--paused", action="store_true", help="wait for lcmtools sim resume, or step N")
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


def _robots(text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or not 1 <= int(text) <= _MOST_ROBOTS:
        wanted = f"a whole number from 1 to {_MOST_ROBOTS}"
        raise argparse.ArgumentTypeError(f"must be {wanted}, not '{text}'")
    return int(text)


def _robot(text: str) -> tuple[RobotModel, Pose]:
    """A model by name, and where it starts ("husky@1,2,90deg")."""
    name, at, place = text.partition("@")
    if name not in MODELS:
        hint = did_you_mean(name, MODELS) or f"known models: {', '.join(MODELS)}"
        raise argparse.ArgumentTypeError(f"unknown model '{name}'; {hint}")
    try:
        x, y, yaw = place.split(",") if at else ("0", "0", "0")
        pose = Pose(float(x), float(y), yaw=_angle(yaw.strip()))
    except ValueError:
        pose = Pose(math.nan)
    if not all(abs(number) <= _FARTHEST for number in (pose.x, pose.y, pose.yaw)):
        wanted = "MODEL or MODEL@X,Y,YAW, for example husky@1,2,90deg"
        raise argparse.ArgumentTypeError(f"must be {wanted}, not '{text}'")
    return MODELS[name], pose


def _angle(text: str) -> float:
    if text.endswith("deg"):
        return math.radians(float(text.removesuffix("deg")))
    return float(text)


def _names(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"must be names with commas between, not '{text}'")
    return names


def _seed(text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or int(text) >= 2**63:
        raise argparse.ArgumentTypeError(f"must be a whole number, 0 or more, not '{text}'")
    return int(text)
