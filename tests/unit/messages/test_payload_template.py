"""Payloads of which only some numbers change."""

import struct

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import Image, JointState, LaserScan
from lcmtools.types.tf2_msgs import TFMessage


def odometry():
    """With strings and a matrix between what changes."""
    message = Odometry()
    message.header.frame_id, message.child_frame_id = "Küche/odom", "\udcff"
    message.pose.covariance = [float(i) for i in range(36)]
    return message


def test_it_is_what_encoding_such_a_message_gives():
    template = PayloadTemplate(odometry(), "header.stamp", "pose.pose", "twist.twist.linear.x")
    message = odometry()
    message.header.stamp.sec, message.header.stamp.nsec = 7, 8
    pose = message.pose.pose
    pose.position.x, pose.position.y, pose.position.z = 1.0, 2.0, 3.0
    pose.orientation.x, pose.orientation.w = 0.6, 0.8
    message.twist.twist.linear.x = 0.5

    assert template.fill((7, 8), (1, 2, 3, 0.6, 0, 0, 0.8), (0.5,)) == encode(message)


def test_it_can_be_filled_again_and_nothing_of_before_stays():
    template = PayloadTemplate(odometry(), "twist.twist")

    template.fill((1, 2, 3, 4, 5, 6))

    assert template.fill((0,) * 6) == encode(odometry())


def test_holes_may_come_in_any_order():
    template = PayloadTemplate(odometry(), "twist.twist.angular.z", "header.stamp.sec")

    message = decode(Odometry, template.fill((0.3,), (9,)))

    assert (message.header.stamp.sec, message.twist.twist.angular.z) == (9, 0.3)


def test_arrays_of_numbers_keep_their_size():
    scan = LaserScan()
    scan.ranges, scan.intensities = [0.0] * 3, [7.0]

    message = decode(LaserScan, PayloadTemplate(scan, "ranges").fill((1.0, float("inf"), 3.0)))

    assert (message.ranges, message.intensities) == ((1.0, float("inf"), 3.0), (7.0,))


def test_holes_can_be_in_messages_in_an_array():
    tf = TFMessage()
    tf.transforms = [TransformStamped(), TransformStamped()]
    tf.transforms[0].child_frame_id = "a long name"
    template = PayloadTemplate(tf, "transforms[1].header.stamp", "transforms[0].transform.rotation")

    message = decode(TFMessage, template.fill((1, 2), (0, 0, 0, 1)))

    first, second = message.transforms
    assert (first.child_frame_id, first.transform.rotation.w) == ("a long name", 1.0)
    assert (second.header.stamp.sec, second.header.stamp.nsec) == (1, 2)


def test_what_comes_after_strings_and_bytes_is_found():
    joints, image = JointState(), Image()
    joints.name, joints.position = ["left", "", "ß"], [0.0, 0.0]
    image.encoding, image.data = "mono8", b"abc"

    filled = decode(JointState, PayloadTemplate(joints, "position").fill((1.0, 2.0)))

    assert (filled.name, filled.position) == (["left", "", "ß"], (1.0, 2.0))
    assert decode(Image, PayloadTemplate(image, "data").fill(b"xyz")).data == b"xyz"


def test_without_holes_it_is_the_message():
    assert PayloadTemplate(odometry()).fill() == encode(odometry())


@pytest.mark.parametrize(
    ("holes", "what"),
    [
        (["pose.pase"], "nav_msgs/Odometry has no field pose.pase"),
        (["pose.pos"], "nav_msgs/Odometry has no field pose.pos"),
        ([""], "nav_msgs/Odometry has no field "),
        (["header"], "nav_msgs/Odometry: header.frame_id can change its size: it is no hole"),
        (
            ["header.stamp", "header.stamp.nsec"],
            "nav_msgs/Odometry: the hole header.stamp.nsec is in another one",
        ),
        (
            ["pose.covariance", "pose.covariance"],
            "nav_msgs/Odometry: the hole pose.covariance is in another one",
        ),
    ],
)
def test_wrong_holes_are_refused(holes, what):
    with pytest.raises(ValueMismatch) as error:
        PayloadTemplate(odometry(), *holes)

    assert str(error.value) == what


def test_an_arrays_length_is_no_hole():
    with raises_saying(ValueMismatch, "ranges_length", "size"):
        PayloadTemplate(LaserScan(), "ranges_length")


def test_a_message_that_does_not_fit_its_type_is_refused():
    message = odometry()
    message.pose.covariance = [0.0]

    with raises_saying(ValueMismatch, "pose.covariance: ", "36 numbers", "got 1"):
        PayloadTemplate(message, "header.stamp")


@pytest.mark.parametrize("row", [(1,), (1, 2, 3), (1.5, 2), ("1", 2), (2**40, 0)])
def test_a_row_that_does_not_fit_raises(row):
    with pytest.raises(struct.error):
        PayloadTemplate(odometry(), "header.stamp").fill(row)


def test_every_hole_needs_a_row():
    with pytest.raises(ValueError, match="shorter"):
        PayloadTemplate(odometry(), "header.stamp", "twist.twist").fill((1, 2))
