"""Messages that command a velocity."""

import pytest

from lcmtools.gui.velocity import VelocityCommand, commands_velocity
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import message_class
from lcmtools.types.geometry_msgs import Twist, TwistStamped


def test_a_twist_has_the_velocity():
    command = VelocityCommand(Twist)
    message = decode(Twist, command.payload(0.5, -0.25, 0))
    stop = decode(Twist, command.payload(0.0, 0.0, 0))
    assert (stop.linear.x, stop.angular.z) == (0.0, 0.0)
    assert (message.linear.x, message.linear.y, message.angular.z) == (0.5, 0.0, -0.25)


def test_a_twist_with_a_header_has_the_time_of_sending():
    command = VelocityCommand(TwistStamped)
    command.payload(0.5, 0.0, 1)
    message = decode(TwistStamped, command.payload(0.0, 1.5, 3_000_000_004))
    assert (message.twist.linear.x, message.twist.angular.z) == (0.0, 1.5)
    assert (message.header.stamp.sec, message.header.stamp.nsec) == (3, 4)


@pytest.mark.parametrize(
    "name",
    [
        "sensor_msgs/JointState",
        "nav_msgs/Odometry",
        "geometry_msgs/Accel",
        "geometry_msgs/AccelStamped",
        "geometry_msgs/Pose",
        "std_msgs/String",
    ],
)
def test_other_types_command_no_velocity(name):
    kind = message_class(name)
    assert not commands_velocity(kind)
    with pytest.raises(ValueError, match="commands no velocity"):
        VelocityCommand(kind)
