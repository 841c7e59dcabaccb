"""Things fall, slide, roll and stand as mechanics says. Metres, m/s, kg, g = 9.81."""

import math
from contextlib import ExitStack
from dataclasses import replace

import pytest

from lcmtools_sim.engines.engine import RigidBody
from lcmtools_sim.geometry import Pose, add, axes, components, rotate, scaled, to_euler
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, SceneObject, box
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere, inertials_of, moments
from lcmtools_sim.world import World
from lcmtools_sim.world_file import read_scene

G = 9.81
NOWHERE = (0.0, 0.0, 0.0)
LYING = math.pi / 2
CRATE = (0.4, 0.4, 0.2)


@pytest.fixture
def put():
    """Makes worlds of things, without robots."""
    with ExitStack() as owned:

        def make(*things, dt=1 / 240, gravity=G):
            return owned.enter_context(World(Scene("t", dt=dt, gravity=gravity, objects=things)))

        yield make


def body(world, number=0):
    return world._objects[number][1]


def let_pass(world, seconds, dt=1 / 240):
    for _ in range(round(seconds / dt)):
        world.step()


def on_slope(angle, shape, height, friction):
    """A ramp, and a thing on it whose centre is so high above it."""
    ramp = Pose(0, 0, 10, pitch=angle)
    up = rotate((0.0, 0.0, 1.0), ramp.rotation)
    place = add(ramp.position, scaled(up, 0.1 + height))
    roll = LYING if isinstance(shape, Cylinder) else 0.0
    thing = SceneObject(
        "it", (Part(shape),), Pose(*place, roll, 0 if roll else angle), 5.0, friction
    )
    return box("ramp", (40, 40, 0.2), ramp, friction=1.0), thing


@pytest.mark.parametrize("gravity", [G, 1.62, 0.0])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 240, 1 / 1000])
def test_a_crate_falls_as_galileo_says_and_comes_to_rest_on_the_ground(put, dt, gravity):
    world = put(box("crate", (0.4, 0.4, 0.4), Pose(0, 0, 6.2), mass=3), dt=dt, gravity=gravity)
    let_pass(world, 1.0, dt)
    falling = world.motion(body(world))
    let_pass(world, 8.0, dt)
    height = world.motion(body(world)).position[2]
    assert 6.2 - falling.position[2] == pytest.approx(gravity * (1 + dt) / 2)  # of n steps
    assert falling.velocity[2] == pytest.approx(-gravity)
    assert height == pytest.approx(0.2 if gravity else 6.2, abs=1e-4)


def test_nothing_slows_what_flies_and_its_angular_momentum_stays(put):
    size = (0.4, 0.6, 0.9)
    inertia = moments(inertials_of([Part(Cuboid(size))], 3.0), (0.0, 0.0, 0.0))
    world = put(box("crate", size, Pose(0, 0, 9), mass=3), gravity=0.0)
    world.set_velocity(body(world), (2, 0, 0), (0.2, 0.3, 2.0))

    def momentum():
        motion = world.motion(body(world))
        frame = axes(motion.rotation)
        x, y, z = components(motion.angular_velocity, frame)
        own = inertia[0] * x, inertia[1] * y, inertia[2] * z
        return add(
            add(scaled(frame[0], own[0]), scaled(frame[1], own[1])), scaled(frame[2], own[2])
        )

    before = momentum()
    let_pass(world, 10.0)
    assert world.motion(body(world)).position[0] == pytest.approx(20.0)
    assert momentum() == pytest.approx(before, abs=0.02 * math.hypot(*before))


@pytest.mark.parametrize("mass", [0.01, 20, 1000])
@pytest.mark.parametrize("friction", [0.3, 0.6, 1.0])
def test_a_crate_slides_as_far_as_coulomb_says(put, friction, mass):
    world = put(box("crate", CRATE, Pose(0, 0, 0.1), mass=mass, friction=friction))
    world.set_velocity(body(world), (2, 0, 0), NOWHERE)
    let_pass(world, 4.0)
    end = world.motion(body(world))
    assert end.position[0] == pytest.approx(2 * 2 / (2 * friction * G), rel=0.05)
    assert end.position[1:] == pytest.approx((0, 0.1), abs=0.01)
    assert end.velocity == pytest.approx(NOWHERE, abs=1e-6)


@pytest.mark.parametrize("degrees", [10, 20, 30])
@pytest.mark.parametrize("share", [0.5, 0.95, 1.02])
def test_a_crate_holds_on_a_slope_below_the_angle_of_friction_and_slides_above(put, degrees, share):
    angle = math.radians(degrees)
    friction = share * math.tan(angle)
    world = put(*on_slope(angle, Cuboid(CRATE), 0.1, friction))
    start = world.motion(body(world, 1)).position
    let_pass(world, 2.0)
    end = world.motion(body(world, 1))
    pulled = G * (math.sin(angle) - friction * math.cos(angle))
    slack = 2 * G * math.cos(angle) * friction * 0.004  # of friction
    if pulled > 0:
        assert math.hypot(*end.velocity) == pytest.approx(2 * pulled, abs=slack)
    else:
        assert math.dist(start, end.position) < 0.001


@pytest.mark.parametrize(("shape", "share"), [(Sphere(0.2), 2 / 5), (Cylinder(0.2, 0.4), 1 / 2)])
def test_what_is_round_rolls_down_a_slope_by_its_inertia(put, shape, share):
    angle = math.radians(10)
    world = put(*on_slope(angle, shape, 0.2, 0.6))
    let_pass(world, 2.0)
    speed = math.hypot(*world.motion(body(world, 1)).velocity)
    assert speed == pytest.approx(2 * G * math.sin(angle) / (1 + share), rel=0.01)


@pytest.mark.parametrize("speed", [0.1, 1.0])
@pytest.mark.parametrize("shape", [Sphere(0.2), Cylinder(0.2, 0.5)])
def test_what_is_round_rolls_on_as_it_does_on_level_ground(put, shape, speed):
    world = put(SceneObject("it", (Part(shape),), Pose(0, 0, 0.2, LYING), 5.0))
    world.set_velocity(body(world), (speed, 0, 0), (0, speed / 0.2, 0))
    let_pass(world, 10.0)
    end = world.motion(body(world))
    assert end.velocity == pytest.approx((speed, 0, 0), abs=0.01 * speed)
    assert end.position[1] == pytest.approx(0, abs=0.01)


def test_a_ball_that_slides_ends_up_rolling_at_five_sevenths(put):
    world = put(SceneObject("ball", (Part(Sphere(0.2)),), Pose(0, 0, 0.2), 5.0))
    world.set_velocity(body(world), (1.4, 0, 0), NOWHERE)
    let_pass(world, 2.0)
    assert world.motion(body(world)).velocity[0] == pytest.approx(1.0, rel=0.005)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_stack_stands_still_for_a_minute(put, dt):
    size = (0.5, 0.5, 0.5)
    stack = [box(f"crate{i}", size, Pose(0, 0, 0.25 + 0.5 * i), mass=5) for i in range(3)]
    world = put(*stack, dt=dt)
    let_pass(world, 5.0, dt)
    before = [world.motion(body(world, i)).position for i in range(3)]
    let_pass(world, 60.0, dt)
    after = [world.motion(body(world, i)).position for i in range(3)]
    assert max(map(math.dist, before, after)) < 1e-4
    assert [place[2] for place in after] == pytest.approx([0.25, 0.75, 1.25], abs=1e-3)


def test_nothing_that_falls_springs_back(put):
    world = put(
        box("crate", (0.4, 0.4, 0.4), Pose(0, 0, 2), mass=3),
        SceneObject("ball", (Part(Sphere(0.2)),), Pose(3, 0, 2), 3.0),
    )
    let_pass(world, 0.7)  # they have arrived
    for _ in range(240):
        world.step()
        assert max(world.motion(body(world, i)).position[2] for i in (0, 1)) < 0.201


@pytest.mark.parametrize("dt", [1 / 240, 1 / 1000])
@pytest.mark.parametrize("mass", [2, 8])
@pytest.mark.parametrize("shape", [Cuboid((0.4, 0.4, 0.4)), Sphere(0.2)])
def test_things_that_collide_go_on_with_nearly_one_speed(put, shape, mass, dt):
    things = [SceneObject("it", (Part(shape),), Pose(x, 0, 5), 2.0) for x in (0, 1.007)]
    world = put(things[0], replace(things[1], mass=mass), dt=dt, gravity=0.0)
    world.set_velocity(body(world), (2.0, 0, 0), NOWHERE)
    let_pass(world, 1.0, dt)
    first, second = (world.motion(body(world, i)).velocity[0] for i in (0, 1))
    assert 2 * first + mass * second == pytest.approx(2 * 2.0, rel=1e-6)
    assert 0 <= second - first < 0.1 * 2.0


@pytest.mark.parametrize(("dt", "speed"), [(1 / 60, 20), (1 / 240, 80)])
@pytest.mark.parametrize("shape", [Cuboid((0.1, 0.1, 0.1)), Sphere(0.05)])
def test_what_is_thrown_does_not_go_through_a_thin_wall(put, shape, dt, speed):
    # A third of a metre in each step: it would be before the wall and then behind it.
    wall = box("wall", (0.01, 10, 4), Pose(2, 0, 2))
    world = put(wall, SceneObject("it", (Part(shape),), Pose(1.17, 0, 0.051), 1.0, 0.0), dt=dt)
    world.set_velocity(body(world, 1), (speed, 0, 0), NOWHERE)
    let_pass(world, 1.0, dt)
    assert 1.5 < world.motion(body(world, 1)).position[0] < 2.0


def test_the_centre_of_mass_of_a_table_is_where_its_parts_have_it():
    text = "objects: [{type: table, size: [1.2, 0.8, 0.75], pose: [1, 2, 90 deg], mass: 12}]"
    (table,) = read_scene(text, "hall.yaml").objects
    top, legs = 1.2 * 0.8 * 0.03, 4 * 0.05 * 0.05 * 0.72
    height = (top * 0.735 + legs * 0.36) / (top + legs)
    assert table.pose.position == pytest.approx((1, 2, height))
    assert min(part.position[2] for part in table.parts) == pytest.approx(0.36 - height)
    assert table.pose.yaw == pytest.approx(math.pi / 2)


def test_a_thing_of_several_parts_resists_as_they_do(put, monkeypatch):
    parts = tuple(Part(Sphere(0.1), (0.0, y, 0.0)) for y in (-0.5, 0.5))
    world, made = put(), list[RigidBody]()
    monkeypatch.setattr(world._engine, "add", made.append)
    world.add(SceneObject("dumbbell", parts, Pose(0, 0, 5), 10.0))
    ball = 10 * 0.4 * 0.01
    assert made[0].mass == pytest.approx(10.0)
    assert made[0].inertia == pytest.approx((ball + 2.5, ball, ball + 2.5))


@pytest.mark.parametrize("mass", [0.1, 5, 20])
@pytest.mark.parametrize("friction", [0.2, 0.6])
def test_a_crate_that_is_pushed_goes_straight_ahead(simulate, twist, mass, friction):
    crate = box("crate", (0.5, 0.5, 0.5), Pose(1.5, 0, 0.25), mass=mass, friction=friction)
    simulation = simulate(crate)
    simulation.select(lambda _: Subscribers.NONE)
    simulation.robots[0].command(twist(1.0, 0.0))
    for _ in range(5 * 240):
        simulation.step()
    world = simulation._world
    end = world.motion(body(world))
    gap = end.position[0] - 0.25 - simulation.robots[0].state(0).position[0] - 0.9874 / 2
    assert end.position[0] > 5.0
    assert end.position[1] == pytest.approx(0, abs=0.1)
    assert math.degrees(to_euler(end.rotation)[2]) == pytest.approx(0, abs=2)
    assert gap == pytest.approx(0, abs=0.005)


def test_who_rested_for_long_is_pushed_and_drives_as_before(simulate, twist):
    simulation = simulate(box("crate", (0.5, 0.5, 0.5), Pose(1.5, 0, 0.25), mass=10))
    simulation.select(lambda _: Subscribers.NONE)
    world, robot = simulation._world, simulation.robots[0]
    for _ in range(60 * 240):
        simulation.step()
    assert math.dist(robot.state(0).position, (0, 0, 0.13228)) < 1e-4
    assert math.dist(world.motion(body(world)).position, (1.5, 0, 0.25)) < 1e-4
    robot.command(twist(1.0, 0.0))
    for _ in range(5 * 240):
        simulation.step()
    assert robot.state(0).velocity[0] == pytest.approx(1.0, rel=0.02)
    assert world.motion(body(world)).position[0] > 5.0


@pytest.mark.parametrize("is_deleted", [True, False])
def test_what_stands_on_a_robot_falls_when_it_goes(simulate, *, is_deleted):
    load = box("load", (0.3, 0.3, 0.3), Pose(0, 0, 0.53), mass=5)
    robots = (RobotPlacement(HUSKY, "/a"), RobotPlacement(HUSKY, "/b", Pose(0, 5)))
    simulation = simulate(scene=Scene("load", objects=(load,), robots=robots))
    simulation.select(lambda _: Subscribers.NONE)
    world = simulation._world
    for _ in range(20 * 240):
        simulation.step()
    assert world.motion(body(world)).position == pytest.approx((0, 0, 0.53), abs=1e-3)
    if is_deleted:
        simulation.remove(simulation.robots[0])
    else:
        simulation.robots[0].place(Pose(5, 5))
    for _ in range(2 * 240):
        simulation.step()
    assert world.motion(body(world)).position[2] == pytest.approx(0.15, abs=1e-3)
