"""Which outputs of a sensor are measured, by who listens."""

from collections.abc import Mapping
from types import SimpleNamespace

import pytest

from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.types.std_msgs import String
from lcmtools_sim.mounted import MountedSensor, Subscribers
from lcmtools_sim.sensors.sensor import SensorMount


class Outputs:
    """A sensor that gives what it is asked for."""

    outputs: Mapping[str, type[Message]] = {"small": String, "large": String}

    def sample(self, state, wanted):
        """An empty text for each."""
        del state
        return {name: encode(String()) for name in wanted}


@pytest.fixture
def robot():
    return SimpleNamespace(namespace="/r")


def measured(reading, times):
    return [sample.topic for _ in range(times) for sample in reading.measure(None)]


def make(robot, *, always=False):
    mount = SensorMount("camera", "eye", 10.0, always=always)
    return MountedSensor(robot, mount, Outputs(), frozenset(("large",)))


def test_everything_is_measured_before_a_selection(robot):
    assert measured(make(robot), 1) == ["/r/eye/small", "/r/eye/large"]


def test_only_what_nodes_listen_to_is_measured(robot):
    reading = make(robot)
    reading.select(lambda topic: Subscribers.KNOWN if topic == "/r/eye/large" else Subscribers.NONE)
    assert measured(reading, 3) == ["/r/eye/large"] * 3


def test_nothing_is_measured_without_possible_subscribers(robot):
    reading = make(robot)
    reading.select(lambda _: Subscribers.NONE)
    assert reading.is_idle
    assert measured(reading, 30) == []


def test_what_is_bulky_comes_once_a_second_to_those_who_may_only_be_listening(robot):
    reading = make(robot)
    reading.select(lambda _: Subscribers.POSSIBLE)
    topics = measured(reading, 30)
    assert not reading.is_idle
    assert (topics.count("/r/eye/small"), topics.count("/r/eye/large")) == (30, 3)


def test_always_means_always(robot):
    reading = make(robot, always=True)
    reading.select(lambda _: Subscribers.NONE)
    assert measured(reading, 2) == ["/r/eye/small", "/r/eye/large"] * 2
