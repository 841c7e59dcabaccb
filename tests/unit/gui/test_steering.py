"""Steering: what pages let be published."""

import queue
from typing import cast

from fixtures.says import assert_says

from lcmtools.errors import BusError
from lcmtools.gui.page_publisher import Publishers
from lcmtools.gui.protocol import PageRequest
from lcmtools.gui.steering import SpeedLimits, Steering
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Twist

_TWIST = "geometry_msgs/Twist"
_LONG = 20.0  # [s] for what comes


class FakePublishers:
    """Keeps what is published: topic, forward and turn."""

    def __init__(self) -> None:
        self.sent: queue.SimpleQueue[tuple[str, float, float]] = queue.SimpleQueue()
        self.is_broken = False

    def publish(self, topic: str, kind: type[Message], payload: bytes) -> None:
        """Keep a Twist."""
        if self.is_broken:
            raise BusError("the network is away")
        assert kind is Twist
        message = decode(Twist, payload)
        self.sent.put((topic, message.linear.x, message.angular.z))

    def next(self) -> tuple[str, float, float]:
        """Return the next one."""
        return self.sent.get(timeout=_LONG)


def _steering(*, is_lossy: bool = False) -> tuple[Steering, FakePublishers]:
    publishers = FakePublishers()
    limits = SpeedLimits(linear=2.0, angular=1.0)
    return Steering(cast("Publishers", publishers), limits, is_lossy=is_lossy), publishers


def _request(op: str, **values: float | str) -> PageRequest:
    return PageRequest({"op": op, "id": 1, "topic": "/v", "type": _TWIST, **values})


def test_commands_are_published_until_the_page_lets_go_then_a_stop_and_silence() -> None:
    steering, publishers = _steering()
    assert steering.execute(1, _request("drive", forward=0.5, turn=-0.25)) == ""
    assert publishers.next() == ("/v", 0.5, -0.25)
    assert steering.execute(1, _request("release")) == ""
    assert publishers.next() == ("/v", 0.0, 0.0)
    steering.close()
    assert publishers.sent.empty()


def test_no_page_drives_faster_than_the_server_lets_it() -> None:
    steering, publishers = _steering()
    steering.drive(1, "/v", _TWIST, (1000.0, -9.0))
    assert publishers.next() == ("/v", 2.0, -1.0)
    steering.close()


def test_all_stops_have_been_sent_when_the_server_is_suspended() -> None:
    steering, publishers = _steering(is_lossy=True)
    steering.drive(1, "/v", _TWIST, (0.5, 0.0))
    steering.stop_all()
    assert publishers.sent.qsize() == 4
    steering.close()


def test_a_page_that_falls_silent_is_stopped() -> None:
    steering, publishers = _steering()
    steering.drive(1, "/v", _TWIST, (0.5, 0.0))
    assert publishers.next() == ("/v", 0.5, 0.0)
    assert publishers.next() == ("/v", 0.0, 0.0)
    steering.close()
    assert publishers.sent.empty()


def test_the_end_of_the_server_stops_everything_as_often_as_messages_may_be_lost() -> None:
    steering, publishers = _steering(is_lossy=True)
    steering.drive(1, "/v", _TWIST, (0.5, 0.0))
    steering.close()
    assert [publishers.next() for _ in range(4)] == [("/v", 0.5, 0.0), *[("/v", 0.0, 0.0)] * 3]
    assert publishers.sent.empty()
    assert steering.drive(1, "/v", _TWIST, (0.5, 0.0)) == "the server is ending"


def test_a_page_that_is_gone_is_stopped() -> None:
    steering, publishers = _steering()
    steering.drive(1, "/v", _TWIST, (0.5, 0.0))
    steering.leave(1)
    assert [publishers.next(), publishers.next()] == [("/v", 0.5, 0.0), ("/v", 0.0, 0.0)]
    steering.close()


def test_a_stop_is_published_though_nobody_drives() -> None:
    steering, publishers = _steering()
    assert steering.execute(1, _request("stop")) == ""
    assert publishers.next() == ("/v", 0.0, 0.0)
    steering.close()


def test_commands_that_cannot_be_published_are_refused_with_the_reason() -> None:
    steering, publishers = _steering()
    refusal = steering.drive(1, "/v", "sensor_msgs/JointState", (0.5, 0.0))
    assert_says(refusal, "JointState", "no velocity")
    assert_says(steering.drive(1, "/v", "no_msgs/Such", (0.5, 0.0)), "type", "'no_msgs/Such'")
    publishers.is_broken = True
    assert steering.drive(1, "/v", _TWIST, (0.5, 0.0)) == "the network is away"
    steering.close()
