"""The engines give the same runs within bounds, scene by scene. Metres, radians, seconds."""

import math
from itertools import chain, pairwise

import pytest

from lcmtools.errors import MissingExtra, UsageError
from lcmtools.types.geometry_msgs import Twist
from lcmtools_sim import engines, fleet
from lcmtools_sim.engines import ENGINES, chosen_engine, is_installed
from lcmtools_sim.geometry import Pose, yaw_of
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene, SceneObject, box
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world, world_names

mujoco_only = pytest.mark.skipif(not is_installed("mujoco"), reason="MuJoCo is not installed")
both = pytest.mark.skipif(
    not all(map(is_installed, ENGINES)), reason="only one engine is installed"
)
HUSKY_ALONE = (RobotPlacement(HUSKY, "/husky0"),)


def driven(scene, engine, forward, turn_rate):
    """The states of all robots, each second of five, all with this command."""
    command = Twist()
    command.linear.x, command.angular.z = forward, turn_rate
    found = []
    with Simulation(scene, engine=engine) as simulation:
        simulation.select(lambda _: Subscribers.NONE)
        for robot in simulation.robots:
            robot.command(command)
        for _ in range(5):
            for _ in range(round(1 / scene.dt)):
                simulation.step()
            found.append([robot.state(simulation.time) for robot in simulation.robots])
    return found


def steps(simulation, count):
    for _ in range(count):
        simulation.step()


def pushed(thing, engine):
    """Forward ways of a Husky and of the thing before it after five seconds at 1 m/s."""
    scene = Scene("push", objects=(thing,), robots=HUSKY_ALONE)
    command = Twist()
    command.linear.x = 1.0
    with Simulation(scene, engine=engine) as simulation:
        simulation.robots[0].command(command)
        for _ in range(5 * 240):
            simulation.step()
        world = simulation._world
        return simulation.robots[0].state(0).position[0], world.motion(
            world._objects[0][1]
        ).position[0]


@both
@pytest.mark.parametrize("world", world_names())
def test_robots_drive_alike_in_each_world(world, monkeypatch):
    scene = read_scene(*find_world(world))
    monkeypatch.setattr(fleet, "_MARGIN", math.inf)  # so that the engine moves them all the time
    bullet, mujoco = (driven(scene, engine, 0.2, 0.3) for engine in ENGINES)
    for one, other in zip(chain(*bullet), chain(*mujoco), strict=True):
        assert math.dist(one.position, other.position) < 0.001
        assert math.dist(one.velocity, other.velocity) < 0.001
        assert yaw_of(one.rotation) == pytest.approx(yaw_of(other.rotation), abs=0.002)


@both
@pytest.mark.parametrize(
    "thing",
    [
        box("crate", (0.5, 0.5, 0.5), Pose(1.5, 0, 0.25), mass=5),
        box("heavy", (0.6, 0.6, 0.6), Pose(1.5, 0, 0.3), mass=40),
        SceneObject("barrel", (Part(Cylinder(0.3, 0.8)),), Pose(1.5, 0, 0.4), 20.0),
        box("wall", (0.2, 4, 1), Pose(2.0, 0, 0.5)),
    ],
    ids=lambda thing: thing.name,
)
def test_what_is_pushed_comes_as_far(thing):
    (robot, ahead), (other_robot, other_ahead) = (pushed(thing, engine) for engine in ENGINES)
    assert other_robot == pytest.approx(robot, rel=0.01)
    assert other_ahead == pytest.approx(ahead, rel=0.01)


@both
def test_a_ball_that_is_hit_rolls_on_before_the_robot():
    ball = SceneObject("ball", (Part(Sphere(0.2)),), Pose(1.5, 0, 0.2), 2.0)
    for engine in ENGINES:
        robot, ahead = pushed(ball, engine)
        assert ahead - robot > HUSKY.body.base_height


def test_the_option_beats_the_variable_which_beats_what_is_installed(monkeypatch):
    installed = {"pybullet", "mujoco", "PIL"}
    monkeypatch.setattr(engines, "find_spec", lambda name: name in installed or None)
    monkeypatch.delenv("LCMTOOLS_ENGINE", raising=False)
    assert chosen_engine() == "bullet"
    monkeypatch.setenv("LCMTOOLS_ENGINE", "mujoco")
    assert (chosen_engine(), chosen_engine("bullet")) == ("mujoco", "bullet")
    monkeypatch.delenv("LCMTOOLS_ENGINE")
    installed.remove("pybullet")
    assert chosen_engine() == "mujoco"


def test_an_engine_that_is_unknown_or_not_there_is_named_with_the_remedy(monkeypatch):
    installed = {"mujoco", "PIL"}
    monkeypatch.setattr(engines, "find_spec", lambda name: name in installed or None)
    monkeypatch.setenv("LCMTOOLS_ENGINE", "mujoko")
    with pytest.raises(UsageError, match="LCMTOOLS_ENGINE: unknown engine 'mujoko'; did you mean"):
        chosen_engine()
    missing = "--engine: the engine bullet is not installed"
    monkeypatch.setattr(engines, "_has_bullet_wheel", lambda: True)
    with pytest.raises(MissingExtra, match=f"{missing}; type: pip install pybullet; or"):
        chosen_engine("bullet")
    monkeypatch.setattr(engines, "_has_bullet_wheel", lambda: False)
    with pytest.raises(MissingExtra, match=f"{missing}; pybullet has wheels .* only; take mujoco"):
        chosen_engine("bullet")
    installed.clear()
    monkeypatch.delenv("LCMTOOLS_ENGINE")
    with pytest.raises(MissingExtra, match="needs numpy, pillow, and pybullet or mujoco"):
        chosen_engine()


def test_bodies_keep_their_motion_when_others_come_and_go():
    for engine in filter(is_installed, ENGINES):
        robots = tuple(RobotPlacement(HUSKY, f"/h{i}", Pose(0, 3 * i)) for i in range(3))
        with Simulation(Scene("three", robots=robots), engine=engine) as simulation:
            command = Twist()
            command.linear.x = 0.5
            simulation.robots[2].command(command)
            ways = []
            for second in range(4):
                for _ in range(240):
                    simulation.step()
                ways.append(simulation.robots[-1 if second < 2 else 1].state(0).position[0])
                if second == 1:
                    simulation.remove(simulation.robots[0])
                    simulation.add(RobotPlacement(HUSKY, "/late", Pose(0, 9)))
            steps = [after - before for before, after in pairwise(ways)]
            assert steps == pytest.approx([0.5] * 3, abs=0.01)


@pytest.mark.parametrize("engine", [name for name in ENGINES if is_installed(name)])
def test_a_thing_of_hardly_any_mass_falls_as_others_do(engine):
    crumb = SceneObject("crumb", (Part(Sphere(0.001)),), Pose(0, 0, 2), mass=1e-10)
    with Simulation(Scene("crumb", objects=(crumb,)), engine=engine) as simulation:
        for _ in range(120):
            simulation.step()
        height = simulation.objects[0].frame.position[2]
    assert 2 - height == pytest.approx(9.81 / 8, abs=0.03)


@mujoco_only
def test_mujoco_has_memory_for_more_contacts_than_it_expects_of_so_few_bodies(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    bricks = [
        Part(Cuboid((0.1, 0.1, 0.1)), (0.2 * (i % 20), 0.2 * (i // 20), 0)) for i in range(400)
    ]
    layers = (
        SceneObject(f"layer{i}", tuple(bricks), Pose(0, 0, 0.05 + i / 10), 50.0) for i in range(5)
    )
    scene = Scene("layers", objects=tuple(layers))
    with Simulation(scene, engine="mujoco") as simulation:
        simulation.step()
        assert simulation._world._engine._data.ncon == 5 * 400 * 4
        steps(simulation, 24)
        assert simulation.warnings() == []
        heights = [thing.frame.position[2] + 0.05 for thing in simulation.objects]
        assert heights == pytest.approx([0.05, 0.15, 0.25, 0.35, 0.45], abs=1e-3)
    assert [*tmp_path.iterdir()] == []


@mujoco_only
def test_a_warning_of_mujoco_is_told_once_a_kind_and_not_in_a_file(tmp_path, monkeypatch):
    import mujoco

    monkeypatch.chdir(tmp_path)
    things = [box(str(i), (1, 1, 1), Pose(3 * i, 0, 0.5), mass=1) for i in range(2)]
    with Simulation(Scene("two", objects=tuple(things)), engine="mujoco") as simulation:
        engine, told = simulation._world._engine, []
        for number in range(2):
            simulation.step()
            engine._qpos[7 * number] = math.nan
            mujoco.mj_checkPos(engine._model, engine._data)
            told += simulation.warnings()
            simulation.add(RobotPlacement(HUSKY, f"/h{number}", Pose(0, 5 + 5 * number)))
    (line,) = told
    assert line.startswith("MuJoCo: Nan, Inf or huge value in QPOS at DOF 0.")
    assert [*tmp_path.iterdir()] == []


@pytest.mark.skipif(not is_installed("bullet"), reason="pybullet is not installed")
def test_robots_that_come_and_go_leave_no_shapes_in_bullet(monkeypatch):
    with Simulation(Scene("one", robots=HUSKY_ALONE), engine="bullet") as simulation:
        engine = simulation._world._engine
        monkeypatch.setattr(engine, "_compound", None)  # makes one, which Bullet never gives up
        for _ in range(3):
            late = simulation.add(RobotPlacement(HUSKY, "/late", Pose(0, 9)))
            simulation.remove(late)
