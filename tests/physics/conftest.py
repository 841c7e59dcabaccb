"""Fixtures of the physics tests: worlds in the engine, without a bus and without a wall clock."""

from contextlib import ExitStack

import pytest

from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots.husky import HUSKY
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.simulation import Simulation

START = Pose()


@pytest.fixture
def simulate():
    """Makes simulations of one Husky (or the scene given), ended with the test."""
    with ExitStack() as owned:

        def make(*things, pose=START, scene=None):
            robots = (RobotPlacement(HUSKY, "/husky0", pose),)
            scene = scene or Scene("test", objects=things, robots=robots)
            return owned.enter_context(Simulation(scene))

        yield make


@pytest.fixture
def unmeasured(simulate):
    """Makes simulations that measure nothing, for tests that read the robots' states."""

    def make(*things, **options):
        simulation = simulate(*things, **options)
        simulation.select(lambda _: Subscribers.NONE)
        return simulation

    return make


@pytest.fixture
def effort():
    """Makes effort commands for left and right."""

    def make(left, right):
        message = JointState()
        message.name, message.effort = ["left", "right"], [left, right]
        return message

    return make


@pytest.fixture
def twist():
    """Makes velocity commands of forward speed [m/s] and turn rate [rad/s]."""

    def make(forward, turn_rate):
        message = Twist()
        message.linear.x, message.angular.z = forward, turn_rate
        return message

    return make
