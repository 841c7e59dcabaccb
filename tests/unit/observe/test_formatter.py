"""Output of echo for messages that differ in type, and its clock."""

import sys

import pytest
from fixtures.says import assert_says

from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import Path, parse_path
from lcmtools.observe.formatter import DisplayOptions, MessageFormatter
from lcmtools.observe.reading.arrivals import SelectedPacket
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.types.geometry_msgs import Point, PointStamped
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet


def _say(text):
    sys.stderr.write(f"{text}\n")


def formatter(look, *, many=False):
    return MessageFormatter(Decoder(lambda _: (), look.message_class), look, lambda: many, _say)


def match(message, path="", channel="/a"):
    return SelectedPacket(
        "/a", Packet(channel, encode(message), 7), 5_000_000_000, parse_path(path)
    )


def joints(*position):
    message = JointState()
    message.position = list(position)
    return message


def test_a_type_without_the_field_is_passed_over_when_another_had_it(capsys):
    one = formatter(DisplayOptions())
    assert one.text(match(PointStamped(), "header.seq")) == "0\n---"
    assert one.text(match(String(), "header.seq")) is None
    assert one.text(match(String(), "header.seq")) is None
    assert one.text(match(PointStamped(), "header.seq")) == "0\n---"
    (line,) = capsys.readouterr().err.splitlines()
    assert_says(line, "/a", "left out", "std_msgs/String", "'header'", "fields: data")


def test_arrays_that_are_too_short_at_times_are_said_once(capsys):
    one = formatter(DisplayOptions())
    assert one.text(match(joints(1, 2), "position[1]")) == "2.0\n---"
    assert one.text(match(joints(), "position[1]")) is None
    assert one.text(match(joints(1), "position[1]")) is None
    assert capsys.readouterr().err.count("\n") == 1


def test_a_slice_has_its_columns_before_an_array_is_as_long(capsys):
    one = formatter(DisplayOptions(form="csv"))
    assert one.text(match(joints(1), "position[0:3]")) == ("%time,field0,field1,field2\n0,1.0,,")
    assert one.text(match(joints(1, 2, 3, 4), "position[0:3]")) == "0,1.0,2.0,3.0"
    assert one.text(match(joints(), "position[0:3]")) == "0,,,"
    assert capsys.readouterr().err == ""


def test_the_first_message_without_the_field_is_a_mistake():
    with pytest.raises(ValueMismatch):
        formatter(DisplayOptions()).text(match(String(), "header"))
    with pytest.raises(ValueMismatch):
        formatter(DisplayOptions(condition=Filter("m.x > 0"))).text(match(String()))


def test_one_topic_of_many_without_the_field_is_none(capsys):
    one = formatter(DisplayOptions(), many=True)
    assert one.text(match(String(), "header")) is None
    assert_says(capsys.readouterr().err, "message on /a", "left out: ")


def test_raw_has_no_fields():
    with pytest.raises(UsageError, match="--raw shows whole messages"):
        formatter(DisplayOptions(form="raw"), many=True).text(match(String(), "data"))


def test_times_are_relative_to_the_clock_of_the_bus():
    message = PointStamped()
    message.header.stamp.sec = 3
    shown = formatter(DisplayOptions(is_relative=True)).text(match(message, "header.stamp"))
    assert shown == "sec: -2\nnsec:         0\n---"
    table = formatter(DisplayOptions(form="csv", is_relative=True)).text(
        match(message, "header.stamp")
    )
    assert table == "%time,field\n-2000000000,-2000000000"
    table = formatter(DisplayOptions(form="csv")).text(match(String()))
    assert table == "%time,field.data\n5000000000,"


def test_a_channel_cannot_write_to_the_terminal():
    shown = formatter(DisplayOptions(), many=True).text(match(String(), channel="a\x1b[2J\nb: 1"))
    assert shown == "# a\\x1b[2J\\x0ab: 1\ndata: ''\n---"


def test_several_fields_of_a_table_are_columns():
    look = DisplayOptions(form="csv", fields=(parse_path("x"), Path(("y",))))
    assert formatter(look).text(match(Point())) == "%time,field.x,field.y\n5000000000,0.0,0.0"
