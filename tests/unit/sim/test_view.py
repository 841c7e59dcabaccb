"""The world is published while a node subscribes to it, and to no one else."""

from dataclasses import dataclass, field

import pytest

from lcmtools.messages.codec import decode
from lcmtools.messages.registry import Message
from lcmtools.types.std_msgs import String
from lcmtools_sim.geometry import Frame
from lcmtools_sim.scene import Scene
from lcmtools_sim.view import LatchedPublisher, View


@dataclass
class FakePublisher:
    """Keeps what is published."""

    message_type: type[Message]
    subscribers: set[str] = field(default_factory=set)
    sent: list[Message] = field(default_factory=list)

    def publish(self, message):
        """Keep it."""
        self.sent.append(message)

    def publish_payload(self, payload):
        """Keep the message."""
        self.sent.append(decode(self.message_type, payload))

    def subscriber_ids(self):
        """The test's."""
        return frozenset(self.subscribers)

    def subscriber_count(self):
        """The test's."""
        return len(self.subscribers)


class FakeNode:
    """The part of Node that is used: publishers, and timers that the test lets pass."""

    def __init__(self):
        self.publishers = {}
        self.timers = {}
        self.overheard = False

    def create_publisher(self, kind, topic):
        """Keep it."""
        return self.publishers.setdefault(topic, FakePublisher(kind))

    def create_timer(self, seconds, callback):
        """Keep it; the callback stands for it."""
        self.timers[callback] = seconds
        return callback

    def destroy_timer(self, timer):
        """Forget it."""
        del self.timers[timer]

    def has_plain_listeners(self):
        """The test's value."""
        return self.overheard

    def let_pass(self, periods=1):
        """Call all timers so often."""
        for _ in range(periods):
            for callback in list(self.timers):
                callback()


class FakeThing:
    """An object in the air, which the test moves."""

    name = "balloon"
    parts = ()
    frame = Frame()


class FakeSimulation:
    """Such an object, and no robot."""

    scene = Scene("air")
    time = 0
    robots = ()

    def __init__(self):
        self.objects = [FakeThing()]


@pytest.fixture
def node():
    return FakeNode()


@pytest.fixture
def simulation():
    return FakeSimulation()


def test_without_a_subscriber_nothing_is_sent_not_even_to_plain_programs(node, simulation):
    node.overheard = True
    View(node, simulation, whole=True)
    timers = len(node.timers)
    node.let_pass(50)
    assert [publisher.sent for publisher in node.publishers.values()] == [[], []]
    assert (len(node.timers), min(node.timers.values())) == (timers, 0.1)  # it hardly looks


def test_poses_are_sent_while_somebody_subscribes(node, simulation):
    View(node, simulation, whole=True)
    poses = node.publishers["~poses"]
    poses.subscribers.add("viewer")
    node.let_pass()
    assert min(node.timers.values()) == pytest.approx(1 / 30)
    for step in range(5):
        simulation.objects[0].frame = Frame((step, 0.0, 1.0))
        node.let_pass()
    assert len(poses.sent) == 5
    poses.subscribers.clear()
    node.let_pass()
    sent = len(poses.sent)
    node.let_pass(10)
    assert len(poses.sent) == sent


def test_poses_that_stay_are_sent_once_a_second(node, simulation):
    View(node, simulation, whole=True)
    poses = node.publishers["~poses"]
    poses.subscribers.add("viewer")
    node.let_pass()
    node.let_pass(90)
    assert 3 <= len(poses.sent) <= 4


def test_the_world_is_sent_to_each_new_subscriber_and_when_it_changes(node, simulation):
    view = View(node, simulation, whole=True)
    world = node.publishers["~world"]
    for subscriber in ("first", "second"):
        world.subscribers.add(subscriber)
        node.let_pass(3)
    assert len(world.sent) == 2
    view.refresh()
    node.let_pass(3)
    assert len(world.sent) == 3
    node.let_pass(10)
    assert len(world.sent) == 4  # once a second: one may be lost


def test_a_follower_shows_its_robots_alone(node, simulation):
    View(node, simulation, whole=False)
    for publisher in node.publishers.values():
        publisher.subscribers.add("viewer")
    node.let_pass(2)
    (world,), (poses,) = (node.publishers[name].sent for name in ("~world", "~poses"))
    assert [marker.action for marker in world.markers] == [3]
    assert poses.transforms == []


def test_a_path_is_repeated_every_second_for_plain_programs(node):
    LatchedPublisher(node, String, "a", String, node.has_plain_listeners)
    node.let_pass(20)
    assert node.publishers["a"].sent == []
    node.overheard = True
    node.let_pass(20)
    assert len(node.publishers["a"].sent) == 2
