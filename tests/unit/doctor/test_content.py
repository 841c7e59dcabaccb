"""Oddities within messages, and what only looks odd."""

import math

import pytest

from lcmtools.doctor.content import _field, oddities
from lcmtools.doctor.evidence import FrameParent, LogLine
from lcmtools.doctor.listening import Listening
from lcmtools.messages.codec import encode
from lcmtools.messages.fields import Field
from lcmtools.messages.message_time import MessageTime
from lcmtools.messages.registry import message_class, type_names
from lcmtools.types.geometry_msgs import PoseStamped, TransformStamped, Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock, Log
from lcmtools.types.sensor_msgs import Imu, JointState, LaserScan, NavSatFix
from lcmtools.types.std_msgs import String
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet, Sender

ALICE, BOB, CAROL, ERIN = (Sender("127.0.0.1", port) for port in range(4000, 4004))
NOW = 1_700_000_000_000_000_000


def odometry():
    message = Odometry()
    message.pose.pose.orientation.w = 1.0
    return message


def test_good_messages_are_not_odd():
    assert list(oddities(odometry())) == []
    assert list(oddities(Twist())) == []


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_found_with_their_path(value):
    message = Twist()
    message.linear.x = value
    assert list(oddities(message)) == [("not-finite", f"linear.x is {value}")]


def test_numbers_in_arrays_are_found_too():
    message = JointState()
    message.velocity = [1.0, math.nan, math.inf]
    assert list(oddities(message)) == [("not-finite", "velocity[1] is nan and 1 more")]


def test_a_laser_may_see_nothing():
    scan = LaserScan()
    scan.ranges = [math.inf, math.nan]
    assert list(oddities(scan)) == []


def test_only_what_a_laser_measures_may_be_no_number():
    scan = LaserScan()
    scan.angle_min = math.nan
    assert list(oddities(scan)) == [("not-finite", "angle_min is nan")]
    fix = NavSatFix()
    fix.altitude = math.nan
    assert list(oddities(fix)) == []
    fix.latitude = math.nan
    assert list(oddities(fix)) == [("not-finite", "latitude is nan")]


def test_a_second_has_a_thousand_million_nanoseconds():
    message = stamped(NOW / 1e9)
    message.header.stamp.nsec = 1_500_000_000
    expected = "header.stamp.nsec is 1500000000, and a second has 1000000000"
    assert list(oddities(message)) == [("nsec", expected)]
    assert heard(("/a", message)) == [("nsec", expected, 1)]


def test_numbers_in_rows_of_rows_are_found():
    rows = Field("m", "float64", None, (2, 2), is_length=False)
    assert list(_field([[0.0, 1.0], [2.0, math.nan]], rows, "m")) == [
        ("not-finite", "m[1][1] is nan")
    ]


def test_a_rotation_that_was_forgotten_or_has_a_wrong_length():
    message = odometry()
    message.pose.pose.orientation.w = 0.0
    ((kind, text),) = oddities(message)
    assert (kind, text.partition(" ")[0]) == ("quaternion", "pose.pose.orientation")
    message.pose.pose.orientation.w = 0.5
    ((kind, text),) = oddities(message)
    assert text == "pose.pose.orientation has the length 0.5 instead of 1"


def test_what_an_imu_does_not_measure_is_not_judged():
    imu = Imu()
    imu.orientation_covariance = [-1.0, *[0.0] * 8]
    assert list(oddities(imu)) == []


def test_covariances_are_symmetric_with_variances_that_are_not_negative():
    message = odometry()
    covariance = [0.0] * 36
    covariance[1] = 0.5
    message.pose.covariance = covariance
    assert list(oddities(message)) == [
        ("covariance", "pose.covariance is not symmetric: [6] and [1] are 0 and 0.5")
    ]
    message.pose.covariance = [0.0] * 7 + [-2.0] + [0.0] * 28
    assert list(oddities(message)) == [("covariance", "pose.covariance[7], a variance, is -2")]


def test_every_type_can_be_looked_into():
    for name in type_names():
        assert len(list(oddities(message_class(name)()))) < 100, name


def heard(*messages, time=NOW):
    listening = Listening(lambda _: ())
    for channel, message in messages:
        listening.add_packet(Packet(channel, encode(message), time, ALICE))
    return [(odd.kind, odd.text, odd.count) for odd in listening.oddities(str)]


def stamped(seconds):
    message = PoseStamped()
    message.pose.orientation.w = 1.0
    message.header.stamp.sec = int(seconds)
    return message


def test_stamps_of_now_are_not_odd_and_none_is_no_stamp():
    assert heard(("/p", stamped(NOW / 1e9)), ("/q", stamped(0))) == []


def test_stamps_in_the_future_and_of_long_ago():
    later = heard(("/p", stamped(NOW / 1e9 + 60)))
    assert later == [("future", "header.stamp is 60.0 s in the future", 1)]
    old = stamped(NOW / 1e9 - 3600)
    assert heard(("/p", old), ("/p", old)) == [("old", "header.stamp is 3600.0 s old", 2)]


def test_old_stamps_that_advance_as_the_clock_does_are_of_a_log_that_is_played():
    listening = Listening(lambda _: ())
    for seconds in range(4):
        for channel, stamp in (("/played", seconds - 86400), ("/stuck", -86400)):
            message = encode(stamped(NOW / 1e9 + stamp))
            listening.add_packet(Packet(channel, message, NOW + seconds * 10**9, ALICE))
    kinds = {odd.topic: odd.kind for odd in listening.oddities(str)}
    assert kinds == {"/played": "replayed", "/stuck": "old"}


def test_simulated_stamps_are_judged_by_the_clock_and_only_by_it():
    clock = Clock()
    clock.clock.sec = 100
    assert heard(("/p", stamped(5))) == [("boot", "header.stamp is 5.0 s since a start", 1)]
    assert heard(("/p", stamped(100)), ("/clock", clock)) == []
    assert heard(("/clock", clock), ("/p", stamped(100))) == []
    assert heard(("/clock", clock), ("/p", stamped(5)))[0][:2] == (
        "old",
        "header.stamp is 95.0 s old",
    )


def test_a_clock_jumps_back_unless_two_send_it():
    for senders, jumps in (((ALICE, ALICE, ALICE), 1), ((ALICE, BOB, ALICE), 0)):
        listening = Listening(lambda _: ())
        for sender, second in zip(senders, (1, 2, 1), strict=True):
            clock = Clock()
            clock.clock.sec = second
            listening.add_packet(Packet("/clock", encode(clock), NOW + second, sender))
        assert listening.clock_jumps() == jumps


def test_what_cannot_be_decoded_is_odd_once():
    listening = Listening(lambda _: ())
    for _ in range(3):
        listening.add_packet(Packet("/a", encode(String())[:-3], NOW, ALICE))
    (odd,) = listening.oddities(str)
    assert (odd.kind, odd.count) == ("undecodable", 3)


@pytest.mark.parametrize(
    ("microseconds", "advances", "found"),
    [
        (NOW // 1000, True, []),
        (NOW // 1000 + 7_200_000_000, True, [("future", "utime is 7200.0 s in the future", 3)]),
        (NOW // 1000 - 7_200_000_000, True, [("replayed", "utime is 7200.0 s old", 3)]),
        (NOW // 1000 - 7_200_000_000, False, []),  # of a message that is sent again and again
        (NOW, True, [("unit", f"utime is {NOW}: nanoseconds, not microseconds", 3)]),
        (NOW // 10**9, False, [("unit", f"utime is {NOW // 10**9}: seconds, not microseconds", 3)]),
        (71_965_300_000, True, []),  # of a clock of its own
        (0, False, []),
    ],
)
def test_a_utime_is_microseconds_of_now(microseconds, *, advances, found, monkeypatch):
    listening = Listening(lambda _: ())
    for second in range(3):
        now = microseconds + advances * second * 10**6
        time = MessageTime("utime", now, now * 1000, "microseconds")
        monkeypatch.setattr("lcmtools.doctor.listening.message_time", lambda _, time=time: time)
        listening.add_packet(Packet("U", encode(String()), NOW + second * 10**9, ALICE))
    assert [(odd.kind, odd.text, odd.count) for odd in listening.oddities(str)] == found


def test_what_comes_again_is_told_from_what_is_the_same():
    """Of a, each datagram twice, and of e, which always sends the same, as c does.

    b repeats what a sent; d numbers nothing.
    """
    listening = Listening(lambda _: ())
    for number in range(5):
        for sender, said, seqno in (
            *((ALICE, f"a{number}", number),) * 2,
            (BOB, f"a{number}", number),
            (CAROL, "hello", number),
            *((ERIN, "stop", number),) * 2,
            (None, f"d{number}", None),
            (None, f"d{number}", None),
        ):
            message = String()
            message.data = said
            listening.add_packet(Packet("/a", encode(message), NOW, sender, seqno))
    found = {one.sender: (one.doubled, one.repeated) for one in listening.streams()}
    assert found == {ALICE: (5, 0), BOB: (0, 5), CAROL: (0, 0), ERIN: (5, 0), None: (0, 0)}


def test_warnings_and_errors_on_rosout_are_counted():
    listening = Listening(lambda _: ())
    for level, text in ((Log.INFO, "fine"), (Log.WARN, "slow\nmore"), (Log.WARN, "slow\nother")):
        message = Log()
        message.name, message.level, message.msg = "/arm", level, text
        listening.add_packet(Packet("/rosout", encode(message), NOW, ALICE))
    assert listening.logs() == (LogLine("/arm", "warning", "slow", 2),)


def test_a_small_covariance_is_compared_by_its_own_size():
    message = Imu()
    message.orientation.w = 1.0
    message.angular_velocity_covariance[1] = 1e-8
    message.angular_velocity_covariance[0] = 1e-8
    (odd,) = oddities(message)
    assert "angular_velocity_covariance is not symmetric: [3] and [1] are 0 and 1e-08" in odd[1]
    message.angular_velocity_covariance[3] = 1e-8
    assert list(oddities(message)) == []


@pytest.mark.parametrize(("speed", "turn", "count"), [(0.5, 0, 1), (0, -0.3, 1), (0.01, 0.01, 0)])
def test_odometry_tells_that_a_robot_drives(speed, turn, count):
    message = Odometry()
    message.twist.twist.linear.y, message.twist.twist.angular.z = speed, turn
    assert len([kind for kind, _ in oddities(message) if kind == "drives"]) == count


def test_frames_of_transforms_are_taken_once_each_without_slashes():
    listening = Listening(lambda _: ())
    for sender, parent, child in ((ALICE, "map", "/odom"), (BOB, "map", "odom")):
        transform = TransformStamped()
        transform.header.frame_id, transform.child_frame_id = parent, child
        transform.transform.rotation.w = 1.0
        message = TFMessage(transforms=[transform])
        listening.add_packet(Packet("/a/tf", encode(message), NOW, sender))
    assert listening.frames(str) == (FrameParent("/a", "odom", "map", str(ALICE)),)


@pytest.mark.parametrize(
    ("ratios", "found"),
    [
        ([1.0] * 5, 1.0),
        ([0.7, 0.7, 0.7, 0.7, 2.0], 0.7),  # behind real time, although it catches up at times
        ([1.0, 1.0, 0.1, 1.0, 1.0], 1.0),  # a single pause
    ],
)
def test_the_pace_of_simulated_time_is_that_of_most_parts_of_a_look(ratios, found):
    listening, arrival, simulated = Listening(lambda _: ()), NOW, 0
    for ratio in ratios:
        for _ in range(10):
            arrival, simulated = arrival + 20_000_000, simulated + round(ratio * 20_000_000)
            message = Clock()
            message.clock.sec, message.clock.nsec = divmod(simulated, 10**9)
            listening.add_packet(Packet("/clock", encode(message), arrival, ALICE))
    assert listening.clock_ratio() == pytest.approx(found, rel=0.1)
