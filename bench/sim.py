"""The speed of the simulator beside the bare engine with the same bodies, for each engine there.

Every row is a scene. Columns, whose sides take turns in slices, the slowest of at least so many
processor seconds: simulated seconds in a second of processor time
  bare        of the engine's step alone, with all bodies in it
  drive       of the simulation without its sensors
  sensors     of the simulation with all its sensors, including the encoding of messages
  alone       of the whole node on a bus without any subscriber
  subscribed  of the whole node with a plain LCM program, for which everything is sent
and the share of a whole node's time that is not the simulation's:
  loop        the schedule, the clock, the bus, alone
  sending     passing the messages to LCM, subscribed
Robots have room around them, and need no engine; those "side by side" do.
Then the time from the start to the first odometry, and memory.

    python bench/sim.py [--slice SECONDS] [--hours SIMULATED]
"""

import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import replace
from math import isnan, nan, pi
from multiprocessing.connection import Connection
from statistics import median

from common import bus, child, isolate, parser, show

import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.engines import ENGINES, VARIABLE, engine_version, is_installed
from lcmtools_sim.geometry import Pose
from lcmtools_sim.loop import Loop
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.robots.pioneer import PIONEER
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.sensors.laser import LaserSettings
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world import World
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world

URL = bus(7791)
SLICES = 15
SAMPLED = 48  # steps: a slice has a multiple, so that all of them publish the same
WARMING = 12  # steps before each slice: the side before has left the processor's caches to itself
SPEEDS = ("bare", "drive", "sensors", "alone", "subscribed")
LASER = SensorMount(
    "laser", "scan", 10.0, Pose(0.3, 0, 0.3), settings=LaserSettings(360, -0.75 * pi, 0.75 * pi)
)
WITH_LASER = replace(HUSKY, sensors=(LASER,))
WITH_KINECT = replace(
    PIONEER, sensors=tuple(m for m in PIONEER.sensors if m.kind == "depth_camera")
)


def yard(model: RobotModel, count: int, gap: float = 6.0) -> Scene:
    """The lab's yard with so many robots in rows; the engine does not mind that they leave it."""
    poses = [Pose(-40.0 - gap * (i // 10), gap * (i % 10)) for i in range(count)]
    if count == 1:
        poses = [Pose()]
    robots = tuple(RobotPlacement(model, f"/r{i}", pose) for i, pose in enumerate(poses))
    return replace(read_scene(*find_world("husky")), robots=robots)


def scenes() -> dict[str, tuple[Scene, Callable[[str], bool]]]:
    """The scenes, and which of their topics are wanted for "sensors"."""

    def everything(_: str) -> bool:
        return True

    def depth(topic: str) -> bool:
        return topic.endswith("depth/image_raw")

    return {
        "1 Husky": (yard(HUSKY, 1), everything),
        "10 Huskies": (yard(HUSKY, 10), everything),
        "10 side by side": (yard(HUSKY, 10, 1.0), everything),
        "100 Huskies": (yard(HUSKY, 100), everything),
        "100 side by side": (yard(HUSKY, 100, 1.0), everything),
        "1000 without sensors": (yard(replace(HUSKY, sensors=()), 1000), everything),
        "1 with a laser, 360 rays, 10 Hz": (yard(WITH_LASER, 1), everything),
        "10 with such lasers": (yard(WITH_LASER, 10), everything),
        "100 with such lasers": (yard(WITH_LASER, 100), everything),
        "world dolly, 200 rays, 100 Hz": (read_scene(*find_world("dolly")), everything),
        "Kinect 640x480, 30 Hz, depth": (yard(WITH_KINECT, 1), depth),
    }


def circle() -> Twist:
    """The lab's circle of 1.667 m radius."""
    message = Twist()
    message.linear.x, message.angular.z = 0.5, 0.3
    return message


def processor_seconds(advance: "Advance", steps: int) -> float:
    """Seconds that this thread works on so many steps; other programs disturb them little."""
    advance(WARMING)
    begun = time.thread_time()
    advance(steps)
    return time.thread_time() - begun


Advance = Callable[[int], object]
"""Lets so many steps pass."""


@contextmanager
def bare(scene: Scene) -> Iterator[Advance]:
    """The engine alone."""
    with World(scene) as world:
        bodies = [world.add_robot(r.namespace, r.model.body, r.pose) for r in scene.robots]
        for body in bodies:
            world.set_velocity(body, (0.5, 0.0, 0.0), (0.0, 0.0, 0.3))
        yield lambda steps: [world.step() for _ in range(steps)]


@contextmanager
def simulation(scene: Scene, wanted: Callable[[str], bool]) -> Iterator[Advance]:
    """The simulation without a bus."""
    with Simulation(scene) as simulated:
        simulated.select(lambda topic: Subscribers.KNOWN if wanted(topic) else Subscribers.NONE)
        for robot in simulated.robots:
            robot.command(circle())
        yield lambda steps: [simulated.step() for _ in range(steps)]


@contextmanager
def whole(scene: Scene) -> Iterator[Advance]:
    """The whole node, on the thread that simulates."""
    lcmtools.init([], url=URL)
    try:
        with Simulation(scene) as simulated, lcmtools.Node("bench") as node:
            for robot in simulated.robots:
                robot.command(circle())
            bridge = Bridge(node, simulated)
            settled = time.monotonic() + 1.5  # until the subscribers are known
            while time.monotonic() < settled:
                bridge.receive(0.1)
            pacer = Pacer(0.0)
            yield lambda steps: Loop(
                simulated, bridge, pacer, go_on=lcmtools.ok, last_step=simulated.steps + steps
            ).run()
    finally:
        lcmtools.shutdown()


def listen(connection: Connection) -> None:
    """Subscribe as any LCM program can, and announce nothing."""
    import lcm

    listener = lcm.LCM(URL)
    listener.subscribe("/nothing", lambda *_: None)
    connection.send("ready")
    while True:
        listener.handle_timeout(1000)


def race(shortest: float, *sides: AbstractContextManager[Advance]) -> list[float]:
    """Seconds that each side takes for a step.

    They take turns, a slice each, so that what disturbs one disturbs all; and the slice in the
    middle counts, so that what disturbs for a moment does not. The slowest side's slices last
    ``shortest`` [s] at least: in some milliseconds the scheduler and a few messages decide.
    """
    with ExitStack() as stack:
        advances = [stack.enter_context(side) for side in sides]
        steps = SAMPLED
        while max(processor_seconds(advance, steps) for advance in advances) < shortest:
            steps *= 2
        slices = [
            [processor_seconds(advance, steps) for advance in advances] for _ in range(SLICES)
        ]
    return [median(spent) / steps for spent in zip(*slices, strict=True)]


def measure(scene: Scene, wanted: Callable[[str], bool], shortest: float) -> dict[str, float]:
    """Seconds a step of each column of speeds."""

    def nothing(_: str) -> bool:
        return False

    sides = (bare(scene), simulation(scene, nothing), simulation(scene, wanted))
    spent = dict(zip(SPEEDS, [*race(shortest, *sides, whole(scene)), nan], strict=True))
    if wanted("/r0/camera/depth/points"):  # eight pictures at once are another measurement
        with child(listen) as listener:
            listener.wait()
            sensed, subscribed = race(shortest, simulation(scene, wanted), whole(scene))
            spent["subscribed"] = (
                subscribed * spent["sensors"] / sensed
            )  # as if all had run at one time
    return spent


def compare(shortest: float) -> None:
    """The table of speeds."""
    rows = []
    for name, (scene, wanted) in scenes().items():
        spent = measure(scene, wanted, shortest)
        parts = (
            (spent["alone"] - spent["drive"]) / spent["alone"],
            (spent["subscribed"] - spent["sensors"]) / spent["subscribed"],
        )
        speeds = [scene.dt / part for part in spent.values()]
        rows.append((name, *speeds, *("-" if isnan(part) else f"{part:.0%}" for part in parts)))
    show("times real time", ("", *SPEEDS, "loop", "sending"), rows)


def first_odometry() -> float:
    """Seconds from the command to the first odometry on the bus."""
    came: list[float] = []
    lcmtools.init([], url=URL)
    with lcmtools.Node("waiting") as node:
        node.create_subscription(
            Odometry, "/husky0/odometry", lambda _: came.append(time.perf_counter())
        )
        begun = time.perf_counter()
        command = [sys.executable, "-m", "lcmtools_sim", "husky", "--lcm-url", URL]
        with subprocess.Popen(command, stderr=subprocess.DEVNULL) as simulator:
            while not came and simulator.poll() is None:
                lcmtools.spin_once(node, 0.1)
            simulator.terminate()
    lcmtools.shutdown()
    return came[0] - begun if came else nan


def memory(hours: float) -> None:
    """The growth of the process while everything is measured."""
    rows = []
    with Simulation(yard(HUSKY, 1)) as simulated:
        simulated.robots[0].command(circle())
        for part in range(5):
            rows.append((f"{part * hours / 4:.2f} h", _resident()))
            for _ in range(round(hours * 3600 / 4 / simulated.scene.dt) if part < 4 else 0):  # noqa: PLR2004
                simulated.step()
    show("greatest resident size after so long", ("simulated", "MB"), rows)


def _resident() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    """Measure and print the tables."""
    arguments = parser(__doc__)
    arguments.add_argument("--slice", type=float, default=0.2, help="seconds, the slowest side's")
    arguments.add_argument("--hours", type=float, default=0.25, help="simulated, for memory")
    said = arguments.parse_args()
    isolate()
    for name in filter(is_installed, ENGINES):
        os.environ[VARIABLE] = name
        print(f"\n{engine_version(name)}")
        memory(said.hours)
        compare(said.slice)
        times = sorted(first_odometry() for _ in range(5))
        print(f"start to first odometry: {times[0]:.2f} s at best, {times[2]:.2f} s mostly")


if __name__ == "__main__":
    main()
