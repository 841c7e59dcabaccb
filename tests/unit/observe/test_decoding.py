"""The type that a channel's messages are taken for, and what cannot be decoded."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import DecodeError
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import type_name
from lcmtools.observe.reading.decoding import Decoder, UnknownFingerprint
from lcmtools.types.geometry_msgs import Point, Vector3
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet

VECTOR = Packet("/a", encode(Vector3()), 7)


def decoder(*announced, named=None):
    return Decoder(lambda _: announced, named)


def test_the_announced_type_is_meant_where_several_have_the_fingerprint():
    for name in ("geometry_msgs/Point", "geometry_msgs/Vector3"):
        assert type_name(decoder(name).decode(VECTOR)) == name


def test_the_likeliest_is_meant_where_none_is_announced_or_another_type_is():
    assert isinstance(decoder().decode(VECTOR), Vector3)
    assert isinstance(decoder("std_msgs/String").decode(VECTOR), Vector3)


def test_the_type_that_the_person_names_wins():
    assert isinstance(decoder("geometry_msgs/Vector3", named=Point).decode(VECTOR), Point)
    with raises_saying(DecodeError, "not std_msgs/String", "geometry_msgs/Vector3"):
        decoder(named=String).decode(VECTOR)


def test_the_type_is_settled_once_for_a_channel():
    asked = []
    one = Decoder(lambda channel: asked.append(channel) or ())
    for channel in ("/a", "/a", "/b"):
        one.decode(VECTOR._replace(channel=channel))
    assert asked == ["/a", "/b"]


def test_what_is_no_message_of_a_known_type_says_why():
    with pytest.raises(UnknownFingerprint, match="unknown type, fingerprint 0x0000000000000000"):
        decoder().decode(Packet("/a", bytes(20), 7))
    with raises_saying(DecodeError, "too short"):
        decoder().decode(Packet("/a", b"short", 7))
    with pytest.raises(DecodeError, match="Vector3"):
        decoder().decode(Packet("/a", VECTOR.payload[:12], 7))
