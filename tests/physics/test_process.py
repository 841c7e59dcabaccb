"""The simulator as a process on a bus: it is steered, watched and ended from outside."""

import os
import re
import signal
import socket
import subprocess
import sys
import time

import pytest

import lcmtools
from lcmtools.errors import ServiceTimeout
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock, Log
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.sim_msgs import GetState, Step
from lcmtools.types.std_msgs import Header, String
from lcmtools.types.std_srvs import Trigger


@pytest.fixture
def url():
    """A bus of this test's own, which stays on this computer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("", 0))
        return f"udpm://239.255.76.67:{free.getsockname()[1]}?ttl=0"


@pytest.fixture
def start(url):
    """Starts simulators on the bus and ends those that still run."""
    running = []

    def run(*arguments, environment=None):
        command = [sys.executable, "-m", "lcmtools_sim", *arguments, "--lcm-url", url]
        merged = {**os.environ, **(environment or {})}
        running.append(subprocess.Popen(command, stdout=-1, stderr=-1, text=True, env=merged))
        return running[-1]

    yield run
    for process in running:
        process.kill()
        process.communicate()


@pytest.fixture
def node(url):
    """A node beside the simulator."""
    lcmtools.init([], url=url)
    with lcmtools.Node("test") as node:
        yield node
    lcmtools.shutdown()


def spin_until(node, done):
    deadline = time.monotonic() + 20
    while not done():
        assert time.monotonic() < deadline, "waited 20 s in vain"
        lcmtools.spin_once(node, 0.1)


def wait_for_start(process):
    """The line that it says when it is on the bus; a warning of a missing route may come before."""
    return next(line for line in process.stderr if "simulating" in line)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_on_a_signal_within_a_second_quietly_and_with_0(start, number, stopwatch):
    process = start()
    line = wait_for_start(process)
    watch = stopwatch(process.pid)
    process.send_signal(number)
    assert watch.until_end() < 1.0
    out, error = process.communicate(timeout=40)
    assert (process.returncode, out, error) == (0, "", "")
    assert re.search(
        r"\[/morse\]: simulating husky with (pybullet|mujoco) [\d.]+: husky /husky0; 11 obj", line
    )


def test_it_ends_after_its_duration_and_not_before(start):
    """Not after either, but for what the computer delays: see Pacer's tests, and bench/sim.py."""
    begun = time.monotonic()
    process = start("--duration", "2")
    process.communicate(timeout=100)
    assert process.returncode == 0
    assert time.monotonic() - begun > 2.0


def test_it_obeys_commands_warns_of_bad_ones_and_goes_on(start, node):
    process = start("--rate", "4", "__name:=driver")
    assert "[/driver]: simulating" in wait_for_start(process)
    speeds = []
    node.create_subscription(
        Odometry, "/husky0/odometry", lambda m: speeds.append(m.twist.twist.linear.x)
    )
    spin_until(node, lambda: speeds)
    command = JointState()
    command.name, command.effort = ["left", "right"], [1, 1]
    good = node.create_publisher(JointState, "/husky0/wheel_cmd")
    good.publish(command)
    spin_until(node, lambda: speeds[-1] > 0.98)
    command.effort = [float("nan"), 1.0]
    for _ in range(3):
        good.publish(command)
    node.create_publisher(String, "/husky0/wheel_velocity_cmd").publish(String())
    count = len(speeds)
    spin_until(node, lambda: len(speeds) > count + 20)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=40)
    assert speeds[-1] == pytest.approx(1.0, rel=0.02)
    assert process.returncode == 0
    # A busy computer may be too slow for the rate, which is a warning too.
    lines = [line for line in error.splitlines() if "the computer is too slow" not in line]
    first, second = sorted(line.partition("/driver]: ")[2] for line in lines)
    assert first.startswith("/husky0/wheel_cmd: command ignored: effort[0] is nan")
    assert "/husky0/wheel_velocity_cmd: message ignored: expected" in second


def test_after_requested_steps_the_clock_shows_the_time_that_is_answered(start, node):
    wait_for_start(start("--paused"))
    times = []
    node.create_subscription(
        Clock, "/clock", lambda c: times.append(c.clock.sec * 10**9 + c.clock.nsec)
    )
    client = node.create_client(Step, "/morse/step")
    for steps in (1, 3, 7, 240, 2):
        request = Step.Request()
        request.steps = steps
        answered = client.call(request, 20.0).time
        spin_until(node, lambda: times and times[-1] >= answered)  # noqa: B023 - called here
        assert times[-1] == answered


def test_a_bad_world_and_a_bad_option_are_one_line_and_exit_code_2(start, tmp_path):
    world = tmp_path / "bad.yaml"
    world.write_text("robots:\n- {model: husky, namespace: a}\nobjekts: []\n")
    for arguments, reason in (
        ([str(world)], f"{world}:3: unknown key 'objekts' in 'world'; did you mean objects?"),
        (["--rate", "x"], "argument --rate: must be times real time, 0 or more, not 'x'; "),
    ):
        process = start(*arguments)
        out, error = process.communicate(timeout=40)
        assert (process.returncode, out, error.count("\n")) == (2, "", 1)
        assert error.startswith(f"lcmtools run sim: {reason}")


class Fleet:
    """A leader with the first Husky and a follower with the second one, watched step by step."""

    def __init__(self, start, node):
        self.leader = start("multi", "--robots", "2", "--only", "husky0")
        self.follower = start("multi", "--robots", "2", "--only", "husky1")
        self.times = {"/husky0": [], "/husky1": []}
        for robot, times in self.times.items():
            node.create_subscription(
                Odometry,
                f"{robot}/odometry",
                lambda o, seen=times: seen.append(utime(o.header.stamp)),
            )
        # until the first one, the leader knows neither of the follower nor of its end
        acknowledged = []
        node.create_subscription(Header, "/clock/_followed", acknowledged.append)
        self._node = node
        spin_until(node, lambda: acknowledged and all(self.times.values()))

    def later(self, seconds):
        """Return if the leader's robot comes so far by the simulation's time."""
        end = self.times["/husky0"][-1] + round(seconds * 1e9)
        spin_for(self._node, 2.0, lambda: self.times["/husky0"][-1] >= end)
        return self.times["/husky0"][-1] >= end


def utime(stamp):
    return int(stamp.sec * 10**9 + stamp.nsec)


def spin_for(node, seconds, done):
    """Handle messages until ``done``, or for so long."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and not done():
        lcmtools.spin_once(node, 0.05)


def test_a_leader_is_never_more_than_a_step_ahead_of_a_follower(start, node):
    fleet = Fleet(start, node)
    node.create_client(Trigger, "/sim/pause").call(Trigger.Request(), 5.0)
    step = node.create_client(Step, "/sim/step")
    request = Step.Request()
    request.steps = 3
    reached = step.call(request, 5.0).time
    spin_until(node, lambda: time_of(node, "/sim_husky1", "husky1") == reached)
    fleet.follower.send_signal(signal.SIGSTOP)
    with pytest.raises(ServiceTimeout):
        step.call(request, 1.5)
    assert time_of(node, "/sim", "husky0") == pytest.approx(reached + 1e9 / 240, abs=1)
    fleet.follower.send_signal(signal.SIGCONT)
    for simulator, robot in (("/sim", "husky0"), ("/sim_husky1", "husky1")):
        spin_until(node, lambda: time_of(node, simulator, robot) >= reached + 2.9e9 / 240)  # noqa: B023 - called here
    assert fleet.leader.poll() is None


def time_of(node, simulator, robot):
    """The time that a simulator has reached [ns]."""
    question = GetState.Request()
    question.robot = robot
    return int(node.create_client(GetState, f"{simulator}/get_state").call(question, 5.0).time)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_followers_end_is_told_once_and_lets_the_leader_go_on(start, node, number):
    fleet = Fleet(start, node)
    told = []
    node.create_subscription(Log, "/rosout", lambda log: told.append(log.msg))
    fleet.follower.send_signal(number)  # and is not waited for: a zombie has ended
    spin_until(node, lambda: any("has ended" in text for text in told))
    assert fleet.later(0.5)
    assert fleet.later(0.5)
    assert [text for text in told if "has ended" in text] == [
        "/sim_husky1 has ended: the simulation goes on without it"
    ]
