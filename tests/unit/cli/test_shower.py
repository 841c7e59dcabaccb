"""What echo shows of messages that differ in type, and by which clock."""

import pytest

from lcmtools.cli.topic.look import Look
from lcmtools.cli.topic.shown import Shower
from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import Path, parse_path
from lcmtools.messages.registry import Message
from lcmtools.observe.decoding import Decoder
from lcmtools.observe.stream import Match
from lcmtools.types.geometry_msgs import Point, PointStamped
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet


def shower(look: Look) -> Shower:
    return Shower(Decoder(lambda _: (), look.message_class), look)


def match(message: Message, path: str = "", channel: str = "/a", *, many: bool = False) -> Match:
    return Match(Packet(channel, encode(message), 7), parse_path(path), 5_000_000_000, many)


def joints(*position: float) -> JointState:
    message = JointState()
    message.position = list(position)
    return message


def test_a_type_without_the_field_is_passed_over_when_another_had_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    one = shower(Look())
    assert one.show(match(PointStamped(), "header.seq")) == "0\n---"
    assert one.show(match(String(), "header.seq")) is None
    assert one.show(match(String(), "header.seq")) is None
    assert one.show(match(PointStamped(), "header.seq")) == "0\n---"
    assert capsys.readouterr().err == (
        "lcmtools echo: a message on /a is left out: header: std_msgs/String has no field 'header'"
        " (fields: data)\n"
    )


def test_arrays_that_are_too_short_at_times_are_said_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    one = shower(Look())
    assert one.show(match(joints(1, 2), "position[1]")) == "2.0\n---"
    assert one.show(match(joints(), "position[1]")) is None
    assert one.show(match(joints(1), "position[1]")) is None
    assert capsys.readouterr().err.count("\n") == 1


def test_the_first_message_without_the_field_is_a_mistake() -> None:
    with pytest.raises(ValueMismatch):
        shower(Look()).show(match(String(), "header"))
    with pytest.raises(ValueMismatch):
        shower(Look(condition=Filter("m.x > 0"))).show(match(String()))


def test_one_topic_of_many_without_the_field_is_none(capsys: pytest.CaptureFixture[str]) -> None:
    one = shower(Look())
    assert one.show(match(String(), "header", many=True)) is None
    assert capsys.readouterr().err.startswith("lcmtools echo: a message on /a is left out: ")


def test_raw_has_no_fields() -> None:
    with pytest.raises(UsageError, match="--raw shows whole messages"):
        shower(Look(form="raw")).show(match(String(), "data", many=True))


def test_times_are_relative_to_the_clock_of_the_bus() -> None:
    message = PointStamped()
    message.header.stamp.sec = 3
    shown = shower(Look(is_relative=True)).show(match(message, "header.stamp"))
    assert shown == "sec: -2\nnsec:         0\n---"
    table = shower(Look(form="csv", is_relative=True)).show(match(message, "header.stamp"))
    assert table == "%time,field\n-2000000000,-2000000000"
    table = shower(Look(form="csv")).show(match(String()))
    assert table == "%time,field.data\n5000000000,"


def test_a_channel_cannot_write_to_the_terminal() -> None:
    shown = shower(Look()).show(match(String(), channel="a\x1b[2J\nb: 1", many=True))
    assert shown == "# 'a\\x1b[2J\\nb: 1'\ndata: ''\n---"


def test_several_fields_of_a_table_are_columns() -> None:
    look = Look(form="csv", fields=(parse_path("x"), Path(("y",))))
    assert shower(look).show(match(Point())) == "%time,field.x,field.y\n5000000000,0.0,0.0"
