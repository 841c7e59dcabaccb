"""The simulator's services act as they say; on a node that is not on any bus."""

import math
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from lcmtools.errors import UsageError
from lcmtools.messages.codec import encode
from lcmtools.types import sim_msgs, std_srvs
from lcmtools_sim.control import Control
from lcmtools_sim.geometry import Pose, yaw_of
from lcmtools_sim.loop import Loop
from lcmtools_sim.scene import Scene, box
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation


class Offered:
    """A node that keeps the services it is given, and calls them."""

    def __init__(self):
        self.services = {}

    def create_service(self, pair, name, callback):
        """Keep it."""
        self.services[name] = pair, callback

    def call(self, name, **fields):
        """Call one with a request of these fields."""
        pair, callback = self.services[f"~{name}"]
        request = pair.Request()
        for field, value in fields.items():
            setattr(request, field, value)
        response = callback(request, pair.Response())
        encode(response)
        return response


class Outside:
    """Surroundings that count what is published."""

    def __init__(self):
        self.published = []

    def receive(self, timeout=0.0):
        """Nothing comes."""
        del timeout

    def find_subscribers(self):
        """Everything is heard here."""

    def publish(self, samples):
        """Keep them."""
        self.published.append(samples)

    def publish_clock(self):
        """Nobody looks at it here."""

    def warn(self, text):
        """No warning is expected."""
        raise AssertionError(text)


@pytest.fixture
def outside():
    return Outside()


@pytest.fixture
def simulation(simulate):
    crate = box("crate", (0.5, 0.5, 0.5), Pose(2, -3, 0.25), mass=5)
    return simulate(crate, box("wall", (0.5, 0.5, 0.5), Pose(-2, -3, 0.25)))


@pytest.fixture
def changes():
    """One entry for each time that robots have come or gone."""
    return []


@pytest.fixture
def node(simulation, outside, changes):
    offered = Offered()
    loop = Loop(simulation, outside, Pacer(0.0), go_on=lambda: True)
    Control(offered, simulation, loop, lambda: changes.append("changed"))
    return offered


def paused(node):
    node.call("pause")
    return node


def test_steps_are_done_at_once_and_only_while_it_is_paused(node, simulation, outside):
    refused = node.call("step", steps=5)
    assert (refused.success, simulation.steps) == (False, 0)
    assert refused.message == "the simulator is not paused; pause it first"
    response = paused(node).call("step", steps=48)
    assert (response.success, simulation.steps, response.time) == (True, 48, 200_000_000)
    assert len(outside.published) == 48


def test_a_request_for_steps_is_refused_while_those_of_another_wait(simulation, outside):
    offered, refused = Offered(), []

    def wait(_):
        """Answer another request between two steps, as a wait for followers does."""
        if simulation.steps == 3:
            refused.append(offered.call("step", steps=5))
        return False

    loop = Loop(simulation, outside, Pacer(0.0), go_on=lambda: True, let_step=wait)
    Control(offered, simulation, loop, lambda: None)
    done = [paused(offered).call("step", steps=6) for _ in range(2)]
    assert [(answer.success, answer.message) for answer in refused] == [
        (False, "the simulator is executing another request's steps; wait for them")
    ]
    assert [answer.message for answer in done] == [
        "did 6 steps, now at 0.025000 s",
        "did 6 steps, now at 0.050000 s",
    ]


@pytest.mark.parametrize("steps", [0, -3, 10**9])
def test_a_senseless_number_of_steps_is_refused(node, steps):
    response = paused(node).call("step", steps=steps)
    assert not response.success
    assert response.message == f"steps must be from 1 to 1000000, not {steps}"


def test_a_follower_has_no_time_of_its_own():
    offered = Offered()
    with Simulation(Scene("test"), leads=False) as simulation:
        Control(offered, simulation, Loop(simulation, Outside(), Pacer(0.0), go_on=bool), list)
        refused = [paused(offered).call("step", steps=5), offered.call("set_rate", rate=2.0)]
        assert simulation.steps == 0
    reason = "this simulator follows the /clock of another one; step that one, or set its rate"
    assert [(one.success, one.message) for one in refused] == [(False, reason)] * 2


def test_reset_brings_the_same_start_to_the_bit(node, simulation, outside, twist):
    def course():
        simulation.robots[0].command(twist(0.5, 0.3))
        outside.published.clear()
        node.call("step", steps=480)
        return [encode(s.message) for samples in outside.published for s in samples]

    paused(node)
    first = course()
    node.call("spawn", model="dolly", robot="/dolly", pose=pose(-3, 0, 0))
    node.call("set_pose", robot="/husky0", pose=pose(1, 2, 0.3))
    node.call("step", steps=100)
    assert node.call("reset").success
    assert (simulation.steps, [r.namespace for r in simulation.robots]) == (0, ["/husky0"])
    assert course() == first


def pose(x, y, yaw):
    message = sim_msgs.SetPose_Request().pose
    message.position.x, message.position.y = x, y
    message.orientation.z, message.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return message


def test_a_robot_is_put_elsewhere_at_rest_and_its_state_says_so(node, simulation, twist):
    simulation.robots[0].command(twist(1.0, 0.0))
    paused(node).call("step", steps=480)
    assert node.call("set_pose", robot="husky0", pose=pose(-3, 4, 1.2)).success
    node.call("step", steps=1)
    state = node.call("get_state", robot="/husky0")
    assert (state.success, state.model) == (True, "husky")
    place = state.pose.position
    assert (place.x, place.y, place.z) == pytest.approx((-3, 4, 0), abs=1e-4)  # as it was set
    assert 2 * math.atan2(state.pose.orientation.z, state.pose.orientation.w) == pytest.approx(1.2)
    assert state.twist.linear.x == pytest.approx(0, abs=0.01)


def test_a_robot_is_not_put_inside_another_and_goes_on_as_it_was(node, simulation, twist):
    paused(node)
    node.call("spawn", model="husky", robot="/husky1", pose=pose(0, 3, 0))
    simulation.robots[0].command(twist(1.0, 0.0))
    node.call("step", steps=480)
    response = node.call("set_pose", robot="husky0", pose=pose(0.3, 3, 0))
    node.call("step", steps=240)
    assert not response.success
    assert response.message.startswith("/husky0 would be 0.")
    assert response.message.endswith(" m inside /husky1; choose another place")
    moved, stood = (robot.state(0) for robot in simulation.robots)
    assert moved.velocity[0] == pytest.approx(1.0, rel=0.01)
    assert moved.position[:2] == pytest.approx((2.8, 0.0), abs=0.01)
    assert stood.position[:2] == pytest.approx((0.0, 3.0), abs=1e-3)


def test_an_object_that_can_be_pushed_is_put_elsewhere_too(node, simulation):
    paused(node).call("set_pose", robot="crate", pose=pose(-3, 4, 1.2))
    node.call("step", steps=24)
    (crate,) = simulation.objects
    assert crate.frame.position == pytest.approx((-3, 4, 0), abs=1e-3)  # on the ground
    assert yaw_of(crate.frame.rotation) == pytest.approx(1.2, abs=1e-3)
    refused = node.call("set_pose", robot="crate", pose=pose(0.1, 0, 0))
    assert refused.message.endswith(" m inside /husky0; choose another place")
    assert crate.frame.position == pytest.approx((-3, 4, 0), abs=1e-3)
    refused = node.call("set_pose", robot="crat", pose=pose(0, 0, 0))
    assert refused.message == "there is no robot or movable object 'crat'; did you mean crate?"


def test_of_two_objects_with_one_name_the_second_has_a_number(simulate):
    crates = [box("crate", (0.5, 0.5, 0.5), Pose(x, 4, 0.25), mass=5) for x in (2, 4)]
    first, second = simulate(*crates).objects
    with pytest.raises(UsageError, match=r"crate_2 would be 0\.50 m inside crate;"):
        second.place(first.frame.pose())


def test_an_object_that_stands_for_ever_is_not_put_elsewhere(node):
    response = node.call("set_pose", robot="wall", pose=pose(-3, 4, 1.2))
    assert response.message == "there is no robot or movable object 'wall'; known: /husky0, crate"


def test_robots_come_and_go(node, simulation, changes):
    paused(node)
    assert node.call("spawn", model="dolly", robot="/dolly", pose=pose(-3, 0, 0)).success
    assert "/dolly/laser_scan" in simulation.topics()
    node.call("step", steps=240)
    assert node.call("get_state", robot="dolly").pose.position.x == pytest.approx(-3.0, abs=1e-3)
    assert node.call("delete", robot="/dolly").success
    assert "/dolly/laser_scan" not in simulation.topics()
    assert changes == ["changed", "changed"]
    assert node.call("delete", robot="/husky0").success
    assert node.call("step", steps=10).success


@pytest.mark.parametrize(
    ("service", "fields", "message"),
    [
        ("delete", {"robot": "/husky1"}, "there is no robot '/husky1'; did you mean /husky0?"),
        ("get_state", {"robot": "r2d2"}, "there is no robot 'r2d2'; known: /husky0"),
        (
            "set_pose",
            {"robot": ""},
            "there is no robot or movable object ''; known: /husky0, crate",
        ),
        (
            "spawn",
            {"model": "huski", "robot": "/a"},
            "unknown model 'huski'; did you mean husky?",
        ),
        (
            "spawn",
            {"model": "husky", "robot": "/husky0"},
            "there is already a robot /husky0",
        ),
        ("set_rate", {"rate": -1.0}, "the rate must be 0 or more, not -1"),
        ("set_rate", {"rate": math.nan}, "the rate must be 0 or more, not nan"),
        ("set_rate", {"rate": math.inf}, "the rate must be 0 or more, not inf"),
        (
            "set_pose",
            {"robot": "/husky0", "pose": pose(math.nan, 0, 0)},
            "the pose is not finite, or farther than 100000 m",
        ),
    ],
)
def test_what_cannot_be_done_is_said_and_changes_nothing(
    node, simulation, changes, service, fields, message
):
    before = simulation.robots[0].state(0)
    response = node.call(service, **fields)
    assert (response.success, response.message) == (False, message)
    assert simulation.robots[0].state(0) == before
    assert changes == []


def test_a_pose_without_a_rotation_is_refused(node):
    request = sim_msgs.SetPose_Request()
    response = node.call("set_pose", robot="/husky0", pose=request.pose)
    assert response.message == "the orientation is all zeros; w: 1 for none"


@pytest.mark.parametrize("length", [1e-9, 1e6])
def test_a_quaternion_has_any_length(node, simulation, length):
    turned = pose(-3, 4, 1)
    turned.orientation.z *= length
    turned.orientation.w *= length
    response = node.call("set_pose", robot="/husky0", pose=turned)
    assert response.success, response.message
    assert yaw_of(simulation.robots[0].frame.rotation) == pytest.approx(1)


def test_a_robot_is_not_put_up_inside_another(node, simulation):
    response = node.call("spawn", model="dolly", robot="/dolly", pose=pose(0.2, 0, 0))
    assert not response.success
    assert "starts" in response.message
    assert [robot.namespace for robot in simulation.robots] == ["/husky0"]


def test_pause_and_resume_say_what_was(node):
    assert [node.call(s).message for s in ("resume", "pause", "pause", "resume")] == [
        "was not paused",
        "paused",
        "was already paused",
        "resumed",
    ]
    assert isinstance(node.call("pause"), std_srvs.Trigger_Response)


@pytest.mark.parametrize("robot", ["", "/husky0"])
def test_a_snapshot_is_a_png_of_the_size_that_is_asked_for(node, robot):
    response = node.call("snapshot", robot=robot, width=320, height=200)
    picture = np.asarray(Image.open(BytesIO(response.image.data)))
    assert (response.success, response.image.format) == (True, "png")
    assert picture.shape == (200, 320, 3)
    yellow = (picture[:, :, 0] > 120) & (picture[:, :, 1] > 120) & (picture[:, :, 2] < 60)
    assert 0.002 < yellow.mean() < 0.3  # the Husky is in it


def test_a_snapshot_of_a_senseless_size_is_refused(node):
    response = node.call("snapshot", width=100_000)
    assert response.message == "a picture has 1 to 4096 columns and rows"
