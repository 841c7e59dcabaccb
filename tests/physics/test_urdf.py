"""Robots from URDF files drive as their geometry says."""

import math
from dataclasses import replace

import pytest

from lcmtools_sim.engines import ENGINES, is_installed
from lcmtools_sim.geometry import yaw_of
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world_file import read_scene

WHEEL = """
  <link name="{side}">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.0016" izz="0.001"/></inertial>
    <collision>
      <origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.08" length="0.04"/></geometry>
    </collision>
  </link>
  <joint name="{side}_joint" type="continuous">
    <parent link="base_link"/><child link="{side}"/>
    <origin xyz="0.05 {y} 0"/><axis xyz="0 1 0"/>
  </joint>"""
CART = f"""<robot name="cart">
  <link name="base_link">
    <inertial><mass value="6"/><inertia ixx="0.05" iyy="0.085" izz="0.125"/></inertial>
    <collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision>
  </link>
  <link name="caster"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>
  <joint name="caster_joint" type="fixed">
    <parent link="base_link"/><child link="caster"/><origin xyz="-0.15 0 -0.05"/>
  </joint>{WHEEL.format(side="left", y=0.17)}{WHEEL.format(side="right", y=-0.17)}
</robot>"""


@pytest.fixture
def cart(tmp_path, simulate):
    (tmp_path / "cart.urdf").write_text(CART)
    text = (
        "robots: [{model: cart.urdf, namespace: a,"
        " drive: {left: [left_joint], right: [right_joint], max_acceleration: 2}}]"
    )
    simulation = simulate(scene=read_scene(text, str(tmp_path / "yard.yaml")))
    return simulation, simulation.robots[0]


def test_it_stands_still_and_level_on_its_wheels(cart):
    simulation, robot = cart
    for _ in range(480):
        simulation.step()
    state = robot.state(0)
    assert state.position == pytest.approx((0.0, 0.0, 0.08), abs=1e-3)
    assert state.rotation == pytest.approx((0.0, 0.0, 0.0, 1.0), abs=1e-4)


def test_a_commanded_circle_comes_out_within_a_hundredth(cart, twist):
    simulation, robot = cart
    robot.command(twist(0.5, 0.3))
    for _ in range(480):
        simulation.step()
    places = []
    for _ in range(round(2 * math.pi / 0.3 * 240)):
        simulation.step()
        places.append(robot.state(0).position)
    for axis in (0, 1):
        values = [place[axis] for place in places]
        assert (max(values) - min(values)) / 2 == pytest.approx(0.5 / 0.3, rel=0.01)
    assert math.dist(places[0], places[-1]) < 0.02
    assert max(place[2] for place in places) - min(place[2] for place in places) < 1e-3


def test_it_turns_on_the_spot_about_the_middle_between_its_wheels(cart, twist):
    simulation, robot = cart
    robot.command(twist(0.0, 1.0))
    for _ in range(240):
        simulation.step()
    before = yaw_of(robot.state(0).rotation)
    for _ in range(240):
        simulation.step()
    state = robot.state(0)
    assert yaw_of(state.rotation) - before == pytest.approx(1.0, rel=0.01)
    assert math.hypot(*state.position[:2]) < 1e-3


def test_a_crate_of_a_gazebo_world_can_be_pushed(tmp_path, cart, simulate, twist):
    crate = (
        "<sdf version='1.6'><world name='w'><model name='crate'><pose>1 0 0.15 0 0 0</pose>"
        "<link name='link'><inertial><mass>1</mass></inertial><collision name='c'><geometry><box>"
        "<size>0.3 0.3 0.3</size></box></geometry><surface><friction><ode><mu>0.3</mu></ode>"
        "</friction></surface></collision></link></model></world></sdf>"
    )
    scene = read_scene(crate, str(tmp_path / "crate.world"))
    simulation = simulate(scene=replace(scene, robots=cart[0].scene.robots))
    robot = simulation.robots[0]
    robot.command(twist(0.5, 0.0))
    for _ in range(240 * 5):
        simulation.step()
    (pushed,) = robot.world.moving_parts(robot.body)
    assert robot.state(0).position[0] > 1.5
    assert pushed.position[0] > robot.state(0).position[0] + 0.2


@pytest.mark.parametrize("engine", [name for name in ENGINES if is_installed(name)])
def test_moments_of_inertia_that_no_body_has_end_no_engine(tmp_path, engine):
    (tmp_path / "cart.urdf").write_text(CART.replace('izz="0.125"', 'izz="9"'))
    text = (
        "robots: [{model: cart.urdf, namespace: a,"
        " drive: {left: [left_joint], right: [right_joint]}}]"
    )
    scene = read_scene(text, str(tmp_path / "yard.yaml"))
    with Simulation(scene, engine=engine) as simulation:
        simulation.step()
        assert simulation.robots[0].stands
