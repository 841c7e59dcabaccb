"""Robots that the engine does not move, and their way back into it. Metres, seconds."""

import math
from dataclasses import replace

import pytest

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.messages.plain import to_plain
from lcmtools_sim import fleet
from lcmtools_sim.geometry import Pose, yaw_of
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, SceneObject, box
from lcmtools_sim.sensors.laser import LaserSettings
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.shapes import Part, Sphere
from lcmtools_sim.simulation import Simulation

LENGTH = HUSKY.body.parts[0].shape.size[0]


def scene(*poses, things=()):
    robots = tuple(RobotPlacement(HUSKY, f"/r{i}", pose) for i, pose in enumerate(poses))
    return Scene("fleet", objects=things, robots=robots)


def steps(simulation, seconds):
    for _ in range(round(seconds * 240)):
        simulation.step()


def run(given, command, seconds):
    with Simulation(given) as simulation:
        for robot in simulation.robots:
            robot.command(command)
        steps(simulation, seconds)
        return [robot.state(simulation.time) for robot in simulation.robots]


@pytest.mark.parametrize(
    ("count", "command"), [(1, (1.0, 0.0)), (1, (0.0, 2.0)), (15, (0.5, 0.3)), (15, (-0.7, 1.0))]
)
def test_it_moves_as_the_engine_would_move_it(count, command, twist, monkeypatch):
    given = scene(*(Pose(0, 20 * i, yaw=0.1 * i) for i in range(count)))
    free = run(given, twist(*command), 5.0)
    monkeypatch.setattr(fleet, "_MARGIN", math.inf)  # something is always near
    held = run(given, twist(*command), 5.0)
    for one, other in zip(free, held, strict=True):
        assert math.dist(one.position, other.position) < 1e-4
        assert math.dist(one.velocity, other.velocity) < 1e-4
        assert math.dist(one.wheel_angles, other.wheel_angles) < 1e-9


def test_it_is_free_between_walls_and_held_beside_one(simulate, twist):
    simulation = simulate(box("wall", (0.2, 8, 1), Pose(5, 0, 0.5)))
    (robot,) = simulation.robots
    simulation.step()
    assert robot.is_free
    robot.command(twist(1.0, 0.0))
    steps(simulation, 8.0)
    assert not robot.is_free
    assert robot.state(0).position[0] == pytest.approx(4.9 - LENGTH / 2, abs=0.01)
    robot.command(twist(-1.0, 0.0))
    steps(simulation, 3.0)
    assert robot.is_free


@pytest.mark.parametrize("count", [2, 16])
def test_robots_that_meet_stop_each_other(count, twist):
    pairs = [
        Pose(-2, 10 * (i // 2)) if i % 2 else Pose(2, 10 * (i // 2), yaw=math.pi)
        for i in range(count)
    ]
    ends = run(scene(*pairs), twist(1.0, 0.0), 5.0)
    for one, other in zip(ends[::2], ends[1::2], strict=True):
        assert math.dist(one.position, other.position) == pytest.approx(LENGTH, abs=0.02)


def test_a_ball_that_is_thrown_at_a_standing_robot_hits_it(simulate):
    ball = SceneObject("ball", (Part(Sphere(0.3)),), Pose(-8, 0, 0.31), 30.0)
    simulation = simulate(ball)
    (robot,) = simulation.robots
    steps(simulation, 0.2)
    assert robot.is_free
    world = simulation._world
    world.set_velocity(world._objects[0][1], (10.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    steps(simulation, 2.0)
    x = robot.state(0).position[0]
    assert x > 0.05
    assert world.motion(world._objects[0][1]).position[0] < x - LENGTH / 2


def test_a_robot_on_its_side_or_in_the_air_stays_with_the_engine(simulate):
    lying = simulate(pose=Pose(z=0.6, roll=1.5))
    falling = simulate(pose=Pose(z=2.0))
    steps(lying, 3.0)
    steps(falling, 0.2)
    assert not lying.robots[0].is_free
    assert falling.robots[0].state(0).position[2] < 2.0 + HUSKY.body.base_height
    assert not falling.robots[0].is_free


def test_nothing_is_placed_or_added_inside_a_free_robot(twist):
    with Simulation(scene(Pose(), Pose(10, 0))) as simulation:
        simulation.robots[0].command(twist(1.0, 0.0))
        steps(simulation, 5.0)
        x = simulation.robots[0].state(0).position[0]
        with pytest.raises(UsageError, match="inside /r0"):
            simulation.place(simulation.robots[1], Pose(x, 0.3))
        with pytest.raises(InvalidFile, match="inside /r0"):
            simulation.add(RobotPlacement(HUSKY, "/r2", Pose(x, 0.3), where="spawn"))
        steps(simulation, 0.2)
        first, second = simulation.robots
        assert first.is_free
        assert second.state(0).position[0] == pytest.approx(10)
        assert first.state(0).position[0] == pytest.approx(x + 0.2, abs=0.01)


def test_a_robot_keeps_its_way_when_others_come_and_go(twist):
    with Simulation(scene(*(Pose(0, 10 * i) for i in range(14)))) as simulation:
        for robot in simulation.robots:
            robot.command(twist(0.5, 0.3))
        steps(simulation, 1.0)
        yaw = yaw_of(simulation.robots[5].state(0).rotation)
        for robot in simulation.robots[:5]:
            simulation.remove(robot)
        steps(simulation, 1.0)
        simulation.add(RobotPlacement(HUSKY, "/new", Pose(-20, 0)))
        steps(simulation, 1.0)
        sixth = simulation.robots[0].state(0)
        assert yaw_of(sixth.rotation) - yaw == pytest.approx(0.6, abs=0.001)
        assert sixth.odometry_speed == pytest.approx((0.5, 0.3))
        assert simulation.robots[-1].state(0).position[:2] == pytest.approx((-20, 0))


@pytest.mark.parametrize("margin", [fleet._MARGIN, math.inf])
def test_sensors_of_many_robots_measure_what_each_alone_does(twist, margin, monkeypatch):
    monkeypatch.setattr(fleet, "_MARGIN", margin)  # at inf the engine moves all
    poses = [Pose(0, 10 * i, yaw=0.3 * i) for i in range(14)]
    poses[1] = Pose(0, 11.0)  # beside the third, so that the engine moves both
    poses[2] = Pose(0, 12.1)

    def samples(given):
        with Simulation(given) as simulation:
            for robot in simulation.robots:
                robot.command(twist(0.5, 0.3))
            steps(simulation, 0.5)
            while len(found := simulation.step()) < 3:
                pass
            return {sample.topic: sample.message for sample in found}

    front = SensorMount(
        "laser", "scan", 50.0, Pose(0.3, 0, 0.3), settings=LaserSettings(noise=0.01)
    )
    model = replace(HUSKY, sensors=(*HUSKY.sensors, front))
    many = scene(*poses, things=(box("wall", (0.2, 200, 1), Pose(5, 60, 0.5)),))
    many = replace(many, robots=tuple(replace(robot, model=model) for robot in many.robots))
    together = samples(many)
    for index in (0, 2, 13):
        one = replace(many, robots=many.robots[index : index + 1])
        for topic, message in samples(one).items():
            if topic != "/tf":  # of all robots
                assert numbers(together[topic]) == pytest.approx(numbers(message), abs=2e-4), topic
                assert texts(together[topic]) == texts(message)


def test_sensors_measure_their_own_robot_whoever_moves_it(twist):
    walls = tuple(box(f"w{i}", (0.2, 2, 1), Pose(3 + i, 10 * i, 0.5)) for i in range(0, 12, 3))
    seen = set()
    with Simulation(scene(*(Pose(0, 10 * i) for i in range(12)), things=walls)) as simulation:

        def drive(seconds):
            for robot in simulation.robots:
                robot.command(twist(1.0, 0.0))
            for _ in range(round(seconds * 240)):
                found = {sample.topic: sample for sample in simulation.step()}
                for robot in simulation.robots if found else ():
                    state = robot.state(simulation.time)
                    truth = found[f"{robot.namespace}/ground_truth"].message
                    place = truth.pose.pose.position
                    assert (place.x, place.y, place.z) == pytest.approx(state.position, abs=1e-9)
                    assert (truth.header.stamp.sec, truth.header.stamp.nsec) == state.stamp
                    seen.add((robot.namespace, robot.is_free))

        drive(1.5)
        simulation.remove(simulation.robots[4])
        drive(0.5)
        simulation.add(RobotPlacement(HUSKY, "/another", Pose(-20, 0)))
        drive(1.0)
    assert {free for name, free in seen if name == "/r0"} == {True, False}  # it reached its wall
    assert {free for name, free in seen if name == "/another"} >= {True}


def test_many_robots_in_the_engine_push_and_fall_by_arrays_as_one_by_one(twist, monkeypatch):
    kinds = Pose(), Pose(z=0.3), Pose(z=0.6, roll=1.5)
    poses = [replace(kinds[i % 3], y=10.0 * i) for i in range(15)]
    crates = [box(f"c{i}", (0.5, 0.5, 0.5), Pose(1.5, 10 * i, 0.25), mass=20) for i in range(15)]
    given = scene(*poses, things=tuple(crates))
    by_arrays = run(given, twist(0.5, 0.2), 4.0)
    monkeypatch.setattr(fleet, "_MANY", math.inf)
    one_by_one = run(given, twist(0.5, 0.2), 4.0)
    for robot, other in zip(by_arrays, one_by_one, strict=True):
        assert math.dist(robot.position, other.position) < 1e-3
        assert math.dist(robot.velocity, other.velocity) < 1e-3
        assert math.dist(robot.rotation, other.rotation) < 1e-3


@pytest.mark.parametrize("gap", [1.0, 6.0])  # in the engine, and without it
def test_a_subscriber_of_one_of_many_that_joins_late_gets_the_same_measurements(gap, twist):
    laser = SensorMount(
        "laser", "scan", 10.0, Pose(0.3, 0, 0.3), settings=LaserSettings(noise=0.01)
    )
    model = replace(HUSKY, sensors=(*HUSKY.sensors, laser))
    given = scene(*(Pose(0, gap * i) for i in range(15)))
    given = replace(given, robots=tuple(replace(robot, model=model) for robot in given.robots))

    def samples(wanted):
        found = {}
        with Simulation(given) as simulation:
            for robot in simulation.robots:
                robot.command(twist(0.5, 0.3))
            for step in range(240):
                simulation.select(lambda topic, now=step: list(Subscribers)[2 * wanted(now, topic)])
                found.update({(step, s.topic): s.payload for s in simulation.step()})
        return found

    late = samples(lambda step, topic: step > 150 and topic.startswith("/r2/"))
    always = samples(lambda *_: True)
    assert {topic for _, topic in late} >= {"/r2/scan", "/r2/odometry", "/r2/ground_truth"}
    assert {key: always[key] for key in late} == late


def leaves(value):
    """All that is in a plain message, one after the other."""
    if isinstance(value, dict):
        value = [*value.values()]
    if isinstance(value, (list, tuple)):
        return [leaf for part in value for leaf in leaves(part)]
    return [value]


def numbers(message):
    return [leaf for leaf in leaves(to_plain(message)) if isinstance(leaf, (int, float))]


def texts(message):
    return [leaf for leaf in leaves(to_plain(message)) if isinstance(leaf, str)]
