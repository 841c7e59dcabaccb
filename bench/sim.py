"""How fast the simulator runs beside the bare engine with the same bodies.

Rows: numbers of driving Huskies in the lab's yard. Columns: simulated seconds per second of
Bullet's stepSimulation alone, of the simulation (tyres, encoders and sensors too), and of the
whole loop with a node on a bus of its own (commands and messages too); ratios to the first.

    python bench/sim.py [--seconds SIMULATED] [--robots N ...]
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace

import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.loop import Loop
from lcmtools_sim.pose import Pose
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world import World
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world

BUS = "udpm://239.255.76.67:7791?ttl=0"
COLUMNS = 5  # robots in a row


def scene_of(robots: int) -> Scene:
    """The lab's yard with so many Huskies; the engine does not mind that they leave it."""
    poses = [Pose(-40.0 - 6 * (i % COLUMNS), 6.0 * (i // COLUMNS)) for i in range(robots)]
    placements = [RobotPlacement(HUSKY, f"/husky{i}", pose) for i, pose in enumerate(poses)]
    return replace(read_scene(*find_world("husky")), robots=tuple(placements))


def circle() -> Twist:
    """The lab's circle of 1.667 m radius."""
    message = Twist()
    message.linear.x, message.angular.z = 0.5, 0.3
    return message


def bare(scene: Scene, steps: int) -> float:
    """Seconds that the engine alone takes."""
    with World(scene) as world:
        for robot in scene.robots:
            body = world.add_robot(robot.namespace, robot.model.body, robot.pose)
            world.set_velocity(body, (0.5, 0.0, 0.0), (0.0, 0.0, 0.3))
        return seconds_of(lambda: [world.step() for _ in range(steps)])


def simulation(scene: Scene, steps: int) -> float:
    """Seconds that the simulation without a bus takes."""
    with Simulation(scene) as simulated:
        for robot in simulated.robots:
            robot.command(circle())
        return seconds_of(lambda: [simulated.step() for _ in range(steps)])


def whole(scene: Scene, steps: int) -> float:
    """Seconds that the whole loop takes, publishing everything."""
    lcmtools.init([], url=BUS)
    try:
        with Simulation(scene) as simulated, lcmtools.Node("bench") as node:
            for robot in simulated.robots:
                robot.command(circle())
            bridge = Bridge(node, simulated)
            loop = Loop(simulated, bridge, Pacer(0.0), go_on=lcmtools.ok, last_step=steps)
            return seconds_of(loop.run)
    finally:
        lcmtools.shutdown()


def seconds_of(work: Callable[[], object]) -> float:
    """Wall seconds that a function takes."""
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=20.0, help="simulated, a measurement")
    parser.add_argument("--robots", type=int, nargs="+", default=[1, 5, 20])
    said = parser.parse_args()
    print("simulated seconds per second, and ratio to the bare engine")
    print(f"{'robots':>6} {'bare engine':>12} {'simulation':>18} {'with the bus':>18}")
    for robots in said.robots:
        scene = scene_of(robots)
        steps = round(said.seconds / scene.dt)
        times = [measure(scene, steps) for measure in (bare, simulation, whole)]
        rates = [said.seconds / seconds for seconds in times]
        cells = [f"{rate:9.1f} ({rate / rates[0]:5.0%})" for rate in rates[1:]]
        print(f"{robots:>6} {rates[0]:>12.1f} {cells[0]:>18} {cells[1]:>18}")


if __name__ == "__main__":
    main()
