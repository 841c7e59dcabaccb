"""Healthy systems, in which wtf finds nothing at all."""

from typing import Any

TWIST = "2e7c07d7cdf7e027"  # the fingerprint of geometry_msgs/Twist
STEER = ("pub", "-r", "10")


def test_talker_and_listener_and_commands_that_look_on(world: Any) -> None:
    world.node("talker")
    world.node("listener")
    world.tool("echo", "/chatter")
    world.tool("hz", "/chatter")
    world.is_silent(wait="2s")


def test_programs_of_the_lcm_package(world: Any) -> None:
    world.hears("A", "B")
    world.sends("bus.publish('A', Twist().encode()); bus.publish('B', String().encode())")
    world.lcm("lcm-sink")
    world.lcm("lcm-logger", "-q", "a.log")
    world.is_silent(wait="1s")


def test_c_programs(world: Any) -> None:
    world.c("listens", "POSE")
    world.c("sends", "POSE", TWIST, "56", "50")
    world.is_silent(wait="1s")


def test_java_programs_beside_nodes(world: Any) -> None:
    world.java("Listens", "/cmd_vel")
    world.java("Sends", "/cmd_vel", TWIST, "56", "20")
    world.node("talker")
    world.node("listener")
    world.is_silent(wait="1s")


def test_a_c_program_steers_a_node_and_python_listens(world: Any) -> None:
    world.node("sim", "--world", "dolly")
    world.c("sends", "/dolly/cmd_vel", TWIST, "56", "10")
    world.hears("/dolly/odom", "/dolly/laser_scan")
    world.is_silent(wait="1s")


def test_the_husky_lab(world: Any) -> None:
    world.node("sim", "--world", "husky")
    world.node("simple_controller", "__ns:=/husky0", "controlled_velocity:=velocity_cmd")
    world.node("evaluate_controller", "__ns:=/husky0")
    world.tool(*STEER, "/husky0/desired_velocity", "geometry_msgs/Twist", "{linear: {x: 0.1}}")
    world.tool("echo", "/husky0/evaluation_stat")
    world.is_silent(wait="1s")


def test_the_dolly_lab(world: Any) -> None:
    world.node("sim", "--world", "dolly")
    world.node("moving_robot")
    world.node("reading_laser")
    world.is_silent(wait="1s")


def test_the_pioneer_lab(world: Any) -> None:
    world.node("sim", "--world", "pioneer")
    world.tool(*STEER, "/RosAria/cmd_vel", "geometry_msgs/Twist", "{angular: {z: 0.5}}")
    world.tool("echo", "/camera/depth/camera_info")
    world.is_silent(wait="1s")


def test_a_latched_message(world: Any) -> None:
    world.tool("pub", "/map", "std_msgs/String", "here").wait_for("latching")
    world.tool("echo", "/map")
    world.is_silent()


def test_nodes_that_ended_as_they_should(world: Any) -> None:
    talker = world.node("talker")
    world.node("listener")
    world.end(talker)
    world.node("talker")
    world.is_silent()


IMU = "m = Imu(); m.header.stamp.sec = int(time.time()); m.orientation_covariance[0] = -1.0"
RANDOM = "time.sleep(__import__('random').expovariate(8)); bus.publish('A', String().encode())"
IMAGES = """
import lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node, image = lcmtools.Node("camera"), String()
image.data = 300_000 * "x"
publisher = node.create_publisher(String, "/image")
node.create_timer(0.1, lambda: publisher.publish(image))
lcmtools.spin(node)
"""


def test_a_thousand_messages_a_second(world: Any) -> None:
    world.hears("A")
    world.lcm("lcm-logger", "-q", "a.log")
    world.sends("bus.publish('A', Twist().encode())", 0.001)
    world.is_silent(wait="1s")


def test_an_imu_without_an_orientation(world: Any) -> None:
    world.hears("IMU")
    world.sends(f"{IMU}; bus.publish('IMU', m.encode())")
    world.is_silent()


def test_events_that_come_by_chance(world: Any) -> None:
    world.hears("A")
    world.sends(RANDOM, 0.0)
    for _ in range(3):
        world.is_silent(wait="1s")


def test_large_images_of_a_node(world: Any) -> None:
    camera = world.script(IMAGES)
    world.until(lambda: camera.pid in world.pids())
    world.tool("hz", "/image")
    world.is_silent(wait="1s")


def test_a_simulator_that_runs_faster_than_real_time(world: Any) -> None:
    world.node("sim", "--world", "dolly", "--rate", "3")
    world.node("moving_robot")
    world.node("reading_laser")
    world.is_silent(wait="1s")
