"""The condition for writing a snapshot."""

import pytest

from lcmtools.bag.ring import Trigger
from lcmtools.errors import ValueMismatch
from lcmtools.observe.reading.find import GLOBAL
from lcmtools.types.sensor_msgs import JointState
from lcmtools.wire.packet import Packet


def joints(*efforts):
    return Packet("/joints", JointState(effort=efforts).encode(), 0)


def trigger(condition):
    return Trigger(f"/joints {condition}", GLOBAL, lambda _: ("sensor_msgs/JointState",))


def test_a_message_that_the_condition_cannot_be_judged_of_does_not_meet_it():
    is_wanted = trigger("m.effort[1] > 0.5")
    packets = joints(), joints(0.0, 0.9), joints(0.0, 0.1), Packet("/joints", b"other", 0)
    assert [is_wanted(packet) for packet in packets] == [False, True, False, False]


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        ("m.efort[0] > 0.5", "m.efort: sensor_msgs/JointState has no field 'efort'"),
        ("m.effort[0] > 'x'", "'>' not supported between instances of 'float' and 'str'"),
    ],
)
def test_a_condition_that_does_not_fit_the_messages_is_an_error(condition, words):
    with pytest.raises(ValueMismatch, match=words):
        trigger(condition)(joints(1.0))
