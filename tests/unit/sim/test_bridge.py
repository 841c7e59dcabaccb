"""The simulator's messages to the bus, and the commands from it."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest
from fixtures.fake_bus import FakeBus

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.mounted import Sample, Subscribers
from lcmtools_sim.robot import interpret
from lcmtools_sim.robots.husky import HUSKY


@dataclass
class FakePublisher:
    """Keeps what is published."""

    topic: str
    sent: list[bytes] = field(default_factory=list)

    def publish_payload(self, payload):
        """Keep it."""
        self.sent.append(payload)


@dataclass
class FakeSubscription:
    """A subscription."""

    types: tuple[type[Message], ...]
    callback: Callable[[Message], None]
    group: str


class FakeNode:
    """The part of Node that the bridge uses; it is its own logger."""

    def __init__(self):
        self.context = SimpleNamespace(bus=FakeBus())
        self.publishers = {}
        self.subscriptions = {}
        self.warnings = []
        self.repeated = []
        self.publishing = ()
        self.heard = frozenset()
        self.overheard = False
        self.overheard_of_late = False

    def create_publisher(self, _, topic):
        """Keep its topic."""
        return self.publishers.setdefault(topic, FakePublisher(topic))

    def create_subscription(self, types, topic, callback, *, group):
        """Keep everything."""
        self.subscriptions[topic] = FakeSubscription(types, callback, group)
        return self.subscriptions[topic]

    def resolve_name(self, name):
        """No remaps here."""
        return name

    def get_logger(self):
        """Itself."""
        return self

    def warning(self, text):
        """Keep it."""
        self.warnings.append(text)

    def repeat(self, text):
        """Keep it."""
        self.repeated.append(text)

    def graph(self):
        """One topic's publishers, by their names."""
        wheels = Endpoint("/husky0/wheel_cmd", Role.PUBLISHER)
        nodes = (NodeInfo(name, name, "here", 1, endpoints=(wheels,)) for name in self.publishing)
        return Graph(tuple(nodes))

    def subscribed_topics(self):
        """The test's value."""
        return self.heard

    def has_plain_listeners(self, *, at_once=False):
        """The test's value."""
        return self.overheard or (at_once and self.overheard_of_late)


class FakeRobot:
    """Understands commands as a Husky does, and does not move."""

    def __init__(self, namespace):
        self.namespace = namespace
        self.model = HUSKY
        self.targets = (0.0, 0.0)

    def command(self, message):
        """Keep what it asks for."""
        self.targets, reduced = interpret(message, HUSKY)
        return reduced


class FakeSimulation:
    """Two robots and a clock."""

    def __init__(self):
        self.robots = [FakeRobot("/husky0"), FakeRobot("/")]
        self.time = 0
        self.complaints = []

    @property
    def publishes_clock(self):
        """The value that was set."""
        return self.interest("/clock") is not Subscribers.NONE

    def tick(self):
        """The clock."""
        clock = Clock()
        clock.clock.nsec = self.time
        return Sample("/clock", Clock, encode(clock))

    def topics(self):
        """One topic."""
        return {"/clock": Clock}

    def select(self, interest):
        """Keep it."""
        self.interest = interest

    def warnings(self):
        """The test's value."""
        return self.complaints


@pytest.fixture(autouse=True)
def _nothing_comes(monkeypatch):
    """The node is no real one, that could spin."""
    monkeypatch.setattr("lcmtools_sim.bridge.spin_once", lambda *_: None)


@pytest.fixture
def node():
    return FakeNode()


@pytest.fixture
def simulation():
    return FakeSimulation()


@pytest.fixture
def bridge(node, simulation):
    return Bridge(node, simulation)


def efforts(*effort):
    message = JointState()
    message.effort = effort
    return message


@pytest.mark.usefixtures("bridge")
def test_a_robots_four_command_topics_are_one_group_that_takes_both_types(node):
    declared = {topic: subscription.types for topic, subscription in node.subscriptions.items()}
    assert list(declared.items())[:4] == [
        ("/husky0/velocity_cmd", (JointState, Twist)),
        ("/husky0/wheel_cmd", (JointState, Twist)),
        ("/husky0/wheel_velocity_cmd", (JointState, Twist)),
        ("/husky0/cmd_vel", (Twist, JointState)),
    ]
    groups = {topic: subscription.group for topic, subscription in node.subscriptions.items()}
    assert {groups[topic] for topic in list(groups)[:4]} == {"wheel command of /husky0"}
    assert groups["/wheel_cmd"] == "wheel command of /"


@pytest.mark.usefixtures("bridge")
def test_every_command_topic_steers_its_own_robot(node, simulation):
    for share, (topic, subscription) in enumerate(node.subscriptions.items(), 1):
        subscription.callback(efforts(share / 10, 0))
        robot = simulation.robots[0 if topic.startswith("/husky0/") else 1]
        assert robot.targets == (share / 10, 0)
    assert simulation.robots[0].targets == (0.4, 0)


def test_after_a_reset_the_same_subscriptions_steer_the_new_robots(node, simulation, bridge):
    before = list(node.subscriptions.values())
    simulation.robots = [FakeRobot("/husky0"), FakeRobot("/")]
    bridge.refresh()
    before[0].callback(efforts(0.1, 0))
    assert [*map(id, node.subscriptions.values())] == [*map(id, before)]
    assert simulation.robots[0].targets == (0.1, 0)


@pytest.mark.usefixtures("bridge")
def test_a_bad_command_is_warned_of_once_until_a_good_one_comes(node, simulation):
    command = node.subscriptions["/husky0/wheel_cmd"].callback
    command(efforts(0.5, 0.5))
    for _ in range(10):
        command(efforts(math.nan, 1))
    warning = "/husky0/wheel_cmd: command ignored: effort[0] is nan, which is not a finite number"
    assert node.warnings == [warning]
    assert simulation.robots[0].targets == (0.5, 0.5)
    command(efforts(1, 1))
    command(efforts(math.nan, 1))
    assert node.warnings == [warning] * 2


@pytest.mark.usefixtures("bridge")
def test_a_command_beyond_the_limits_is_warned_of_once_for_each_sender(
    node, simulation, monkeypatch
):
    now = [100.0]
    monkeypatch.setattr("lcmtools_sim.bridge.time.monotonic", lambda: now[0])
    command = node.subscriptions["/husky0/wheel_cmd"].callback
    for publishing in ((), ("/a",), ("/a",), ("/a", "/b")):
        node.publishing = publishing
        for value in (5, 0.5, 6):
            command(efforts(value, 0))
        now[0] += 1.0
    warning = "/husky0/wheel_cmd: command reduced: effort[0] is 5, the limit 1"
    assert node.warnings == [warning, f"{warning} (from /a or /b)"]
    assert node.repeated == [f"{warning} (from /a)"] * 2  # it had not been announced at first
    assert simulation.robots[0].targets == (1, 0)


@pytest.mark.usefixtures("bridge")
def test_what_is_wrong_with_commands_is_repeated_for_those_who_look_later(node, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("lcmtools_sim.bridge.time.monotonic", lambda: now[0])
    node.publishing = ("/student",)
    message = efforts(1, 1)
    message.name = ["l", "r"]
    for _ in range(100):
        node.subscriptions["/husky0/wheel_cmd"].callback(message)
        now[0] += 0.02
    (warning,) = node.warnings
    assert warning.startswith("/husky0/wheel_cmd: command ignored: unknown wheel 'l'; known names:")
    assert warning.endswith(" (from /student)")
    assert node.repeated == [warning] * 3


def test_samples_go_out_on_their_topics(bridge, node):
    payload = encode(Clock())
    bridge.publish([Sample("/clock", Clock, payload)])
    assert node.publishers["/clock"].sent == [payload]


@pytest.mark.parametrize(
    ("listening", "interest"),  # topics of nodes, and whether others may listen
    [
        (({"/clock"}, False), Subscribers.KNOWN),
        (({"/clock"}, True), Subscribers.KNOWN),
        ((set(), True), Subscribers.POSSIBLE),
        (({"/other"}, False), Subscribers.NONE),
    ],
)
def test_the_simulation_gets_the_state_of_subscribers(
    node, simulation, bridge, listening, interest
):
    node.heard, node.overheard = frozenset(listening[0]), listening[1]
    bridge.receive()
    assert simulation.interest("/clock") is interest


def test_the_nodes_are_asked_before_the_first_look(node, simulation, monkeypatch):
    answers = iter([frozenset(), frozenset({"/clock"})])
    monkeypatch.setattr(node, "subscribed_topics", lambda: next(answers))
    bridge = Bridge(node, simulation)
    bridge.receive()
    assert simulation.interest("/clock") is Subscribers.KNOWN


def test_finding_subscribers_at_once_counts_those_that_have_just_started(node, simulation, bridge):
    bridge.receive()
    node.overheard_of_late = True
    bridge.find_subscribers()
    assert simulation.interest("/clock") is Subscribers.POSSIBLE


def test_a_clock_without_subscribers_is_published_now_and_then_while_time_passes(
    node, simulation, bridge, monkeypatch
):
    walls = iter([10.0, 10.05, 10.11, 10.22, 10.33])
    monkeypatch.setattr("lcmtools_sim.bridge.time.monotonic", lambda: next(walls))
    for simulated in (1, 2, 3, 3, 4):  # paused once
        simulation.time = simulated
        bridge.receive()
    sent = [decode(Clock, payload).clock.nsec for payload in node.publishers["/clock"].sent]
    assert sent == [1, 3, 4]


def test_the_engines_warnings_are_logged(node, simulation, bridge):
    simulation.complaints = ["unstable"]
    bridge.receive()
    assert node.warnings == ["unstable"]


def test_a_clock_with_subscribers_comes_with_the_steps_alone(node, simulation, bridge):
    node.heard = frozenset({"/clock"})
    simulation.time = 1
    bridge.receive()
    assert node.publishers["/clock"].sent == []


def test_the_clock_is_published_once_for_each_time(node, simulation, bridge):
    simulation.time = 1
    bridge.publish([simulation.tick()])
    bridge.publish_clock()
    simulation.time = 2
    bridge.publish_clock()
    bridge.publish_clock()
    sent = [decode(Clock, payload).clock.nsec for payload in node.publishers["/clock"].sent]
    assert sent == [1, 2]


def test_the_clock_shows_a_reset_at_once(node, simulation, bridge):
    simulation.time = 7
    bridge.publish([simulation.tick()])
    simulation.time = 0
    bridge.refresh()
    sent = [decode(Clock, payload).clock.nsec for payload in node.publishers["/clock"].sent]
    assert sent == [7, 0]
