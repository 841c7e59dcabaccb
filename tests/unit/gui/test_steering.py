"""Steering: what pages let be published."""

from fixtures.says import assert_says

from lcmtools.errors import BusError
from lcmtools.gui.dead_man import Command
from lcmtools.gui.protocol import PageRequest
from lcmtools.gui.steering import SpeedLimits, Steering
from lcmtools.gui.steering_process import NoAnswer
from lcmtools.messages.codec import decode
from lcmtools.types.geometry_msgs import Twist

_TWIST = "geometry_msgs/Twist"


class FakeProcess:
    """Keeps the commands that it is told: the operation, forward and turn."""

    pid = 12

    def __init__(self):
        self.told = []
        self.is_gone = self.is_killed = self.is_closed = False

    def execute(self, command):
        """Keep a command."""
        if self.is_gone:
            raise NoAnswer("it has ended")
        self.told.append(command)
        return ""

    def kill(self):
        """Note it."""
        self.is_killed = True

    def close(self):
        """Note it."""
        self.is_closed = True


class FakePublishers:
    """Keeps what the server itself publishes."""

    def __init__(self):
        self.sent = []

    def publish_payload(self, topic, kind, payload):
        """Keep a message, and fail."""
        self.sent.append((topic, kind[0], _velocity(payload)[0]))
        raise BusError("the network is away")


def _velocity(payload):
    message = decode(Twist, payload)
    return message.linear.x, message.angular.z


def _steering():
    processes = []

    def start():
        processes.append(FakeProcess())
        return processes[-1]

    publishers = FakePublishers()
    limits = SpeedLimits(linear=2.0, angular=1.0)
    return Steering(publishers, limits, start), processes, publishers


def _request(op, **values):
    return PageRequest(op, 1, values={"topic": "/v", "type": _TWIST, **values})


_DRIVE = _request("drive", forward=0.5, turn=-0.25)


def test_each_command_is_told_with_its_own_stop_and_the_end_of_its_validity():
    steering, processes, _ = _steering()
    assert steering.execute(1, _DRIVE) == ""
    assert steering.execute(1, _DRIVE, late=0.2) == ""
    first, late = processes[0].told
    assert _velocity(first.payload) == (0.5, -0.25)
    assert _velocity(first.stop) == (0.0, 0.0)
    assert late.until < first.until


def test_no_page_drives_faster_than_the_server_lets_it():
    steering, processes, _ = _steering()
    steering.execute(1, _request("drive", forward=1000.0, turn=-9.0))
    assert _velocity(processes[0].told[0].payload) == (2.0, -1.0)


def test_what_a_process_drove_that_does_not_answer_is_stopped_and_another_one_is_started():
    steering, processes, publishers = _steering()
    steering.execute(1, _DRIVE)
    steering.execute(2, _request("drive", topic="/w", forward=1.0, turn=0.0))
    steering.execute(3, _request("drive", topic="/x", forward=1.0, turn=0.0))
    steering.execute(3, _request("release", topic="/x"))
    processes[0].is_gone = True
    assert "does not answer" in steering.execute(1, _DRIVE)
    assert processes[0].is_killed
    assert {*publishers.sent} == {("/v", _TWIST, 0.0), ("/w", _TWIST, 0.0)}
    assert steering.execute(1, _DRIVE) == ""
    assert steering.pids == {12}
    assert len(processes) == 2


def test_a_page_that_is_gone_releases_all_topics():
    steering, processes, _ = _steering()
    steering.leave(1)
    assert processes == []
    steering.execute(1, _DRIVE)
    steering.leave(1)
    assert processes[0].told[-1] == Command("release", 1)


def test_a_stop_is_told_though_nobody_drives():
    steering, processes, _ = _steering()
    assert steering.execute(1, _request("stop")) == ""
    (told,) = processes[0].told
    assert (told.payload, _velocity(told.stop)) == (b"", (0.0, 0.0))


def test_the_end_ends_the_process():
    steering, processes, _ = _steering()
    steering.prepare()
    steering.close()
    assert processes[0].is_closed
    assert steering.execute(1, _DRIVE) == "the server is ending"


def test_commands_that_cannot_be_published_are_refused_with_the_reason():
    steering, processes, _ = _steering()
    refusal = steering.execute(
        1, _request("drive", type="sensor_msgs/JointState", forward=1, turn=0)
    )
    assert_says(refusal, "JointState", "no velocity")
    refusal = steering.execute(1, _request("stop", type="no_msgs/Such"))
    assert_says(refusal, "type", "'no_msgs/Such'")
    assert_says(steering.execute(1, _request("stop", topic="/v" * 40)), "63")
    assert processes == []
