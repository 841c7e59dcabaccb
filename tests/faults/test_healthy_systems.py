"""Healthy systems, in which wtf finds nothing at all."""

import signal

import pytest

TWIST = "2e7c07d7cdf7e027"  # the fingerprint of geometry_msgs/Twist
STEER = ("pub", "-r", "10")


def test_talker_and_listener_and_commands_that_look_on(world):
    world.node("talker")
    world.node("listener")
    world.tool("echo", "/chatter")
    world.tool("hz", "/chatter")
    world.is_silent(wait="2s")


def test_programs_of_the_lcm_package(world):
    world.hears("A", "B")
    world.sends("bus.publish('A', Twist().encode()); bus.publish('B', String().encode())")
    world.lcm("lcm-sink")
    world.lcm("lcm-logger", "-q", "a.log")
    world.is_silent(wait="1s")


def test_c_programs(world):
    world.c("listens", "POSE")
    world.c("sends", "POSE", TWIST, "56", "50")
    world.is_silent(wait="1s")


def test_java_programs_beside_nodes(world):
    world.java("Listens", "/cmd_vel")
    world.java("Sends", "/cmd_vel", TWIST, "56", "20")
    world.node("talker")
    world.node("listener")
    world.is_silent(wait="1s")


def test_a_c_program_steers_a_node_and_python_listens(world):
    world.node("sim", "--world", "dolly")
    world.c("sends", "/dolly/cmd_vel", TWIST, "56", "10")
    world.hears("/dolly/odom", "/dolly/laser_scan")
    world.is_silent(wait="1s")


def test_the_husky_lab(world):
    world.node("sim", "--world", "husky")
    world.node("simple_controller", "__ns:=/husky0", "controlled_velocity:=velocity_cmd")
    world.node("evaluate_controller", "__ns:=/husky0")
    world.tool(*STEER, "/husky0/desired_velocity", "geometry_msgs/Twist", "{linear: {x: 0.1}}")
    world.tool("echo", "/husky0/evaluation_stat")
    world.is_silent(wait="1s")


def test_the_dolly_lab(world):
    world.node("sim", "--world", "dolly")
    world.node("moving_robot")
    world.node("reading_laser")
    world.is_silent(wait="1s")


def test_the_pioneer_lab(world):
    world.node("sim", "--world", "pioneer")
    world.tool(*STEER, "/RosAria/cmd_vel", "geometry_msgs/Twist", "{angular: {z: 0.5}}")
    world.tool("echo", "/camera/depth/camera_info")
    world.is_silent(wait="1s")


def test_a_listener_that_make_started(world):
    """It has make's pipe with a byte for each free job, like that of liblcm."""
    ear = "import lcm; b = lcm.LCM(); b.subscribe('A', print); print('listens', flush=True)"
    make = "import os, subprocess, sys\nends = os.pipe()\nos.write(ends[1], b'+')\n"
    source = f"{ear}; [b.handle() for _ in iter(int, 1)]"
    make += f"subprocess.run([sys.executable, '-c', {source!r}], pass_fds=ends)\n"
    world.node("talker")
    world.node("listener")
    world.script(make, ready="listens")
    world.is_silent()


def test_a_latched_message(world):
    world.tool("pub", "/map", "std_msgs/String", "here").wait_for("latching")
    world.tool("echo", "/map")
    world.is_silent()


_RESTARTS = """
import os, signal, sys, time
import lcmtools
from lcmtools.types.std_msgs import String

def run():
    lcmtools.init()
    with lcmtools.Node("talker") as node:
        publisher = node.create_publisher(String, "/chatter")
        node.create_timer(0.1, lambda: publisher.publish(String()))
        lcmtools.spin(node)

while True:
    program = os.fork()
    if not program:
        run()
        os._exit(0)
    print("runs", flush=True)
    time.sleep(6.0)
    os.kill(program, int(sys.argv[1]))
    os.waitpid(program, 0)
    time.sleep(0.2)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_node_that_is_started_again_and_again(world, number):
    world.script(_RESTARTS, str(number.value), ready="runs")
    world.node("listener").wait_for("I heard")
    for _ in range(6):
        world.is_silent(wait="1s")


def test_a_watch_in_another_terminal(world):
    world.start(world.command, "wtf", "--watch").wait_for("WARNING")
    listener = world.node("listener")
    world.until(lambda: listener.pid in world.pids())
    found = world.finds("unconnected-subscriptions", "/chatter")
    assert found.severity == "warning"
    assert "may-publish" not in found.everything


def test_nodes_that_ended_as_they_should(world):
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


def test_a_thousand_messages_a_second(world):
    world.hears("A")
    world.lcm("lcm-logger", "-q", "a.log")
    world.sends("bus.publish('A', Twist().encode())", 0.001)
    world.is_silent(wait="1s")


def test_an_imu_without_an_orientation(world):
    world.hears("IMU")
    world.sends(f"{IMU}; bus.publish('IMU', m.encode())")
    world.is_silent()


def test_events_that_come_by_chance(world):
    world.hears("A")
    world.sends(RANDOM, 0.0)
    for _ in range(3):
        world.is_silent(wait="1s")


def test_large_images_of_a_node(world):
    camera = world.script(IMAGES)
    world.until(lambda: camera.pid in world.pids())
    world.tool("hz", "/image")
    world.is_silent(wait="1s")


def test_a_simulator_that_runs_faster_than_real_time(world):
    world.node("sim", "--world", "dolly", "--rate", "3")
    world.node("moving_robot")
    world.node("reading_laser")
    world.is_silent(wait="1s")
