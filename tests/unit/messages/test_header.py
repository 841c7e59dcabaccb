"""The stamp in a message's header."""

from lcmtools.messages.fields import stamp
from lcmtools.types.geometry_msgs import PoseStamped, Twist
from lcmtools.types.std_msgs import Header


def test_a_stamp_is_nanoseconds_since_1970() -> None:
    message = PoseStamped()
    message.header.stamp.sec, message.header.stamp.nsec = 1_795_244_479, 5
    assert stamp(message) == 1_795_244_479_000_000_005


def test_a_message_without_a_header_has_no_stamp() -> None:
    assert stamp(Twist()) is None
    assert stamp(Header()) is None
