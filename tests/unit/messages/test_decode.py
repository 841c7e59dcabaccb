"""Payloads to messages: nothing believed that cannot be."""

import struct

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import DecodeError
from lcmtools.messages.codec import decode, encode
from lcmtools.types import geometry_msgs, sensor_msgs, std_msgs, std_srvs
from lcmtools.types.tf2_msgs import TFMessage


def joint_state():
    message = sensor_msgs.JointState()
    message.name = ["left", "right"]
    message.position = [1.0, 2.0]
    return message


def test_decoded_arrays_are_as_lcm_gen_gives_them():
    payload = encode(joint_state())
    message = decode(sensor_msgs.JointState, payload)
    assert message.name == ["left", "right"]
    assert message.position == (1.0, 2.0)
    assert message.velocity == ()


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_a_payload_may_be_anything_bytes_like(kind):
    assert decode(sensor_msgs.JointState, kind(encode(joint_state()))).name == ["left", "right"]


def test_bytes_after_the_end_are_ignored():
    assert decode(sensor_msgs.JointState, encode(joint_state()) + b"more").name[0] == "left"


def test_what_is_not_utf_8_becomes_a_replacement_character():
    payload = encode(joint_state()).replace(b"left", b"l\xfft\xfe")
    assert decode(sensor_msgs.JointState, payload).name[0] == "l\ufffdt\ufffd"


def test_a_string_without_even_a_nul_is_empty():
    payload = std_msgs.String().encode()[:8] + bytes(4)
    assert decode(std_msgs.String, payload).data == ""


def string_payload(text, length):
    return std_msgs.String().encode()[:8] + struct.pack(">I", length) + text


def image_payload(length):
    payload = encode(sensor_msgs.Image())
    return payload[:8] + struct.pack(">i", length) + payload[12:]


@pytest.mark.parametrize(
    ("cls", "payload", "line"),
    [
        (std_msgs.Int32, b"", "expected std_msgs/Int32, got 0 bytes, which are not an LCM message"),
        (
            std_msgs.Int32,
            b"abc",
            "expected std_msgs/Int32, got 3 bytes, which are not an LCM message",
        ),
        (
            std_msgs.Int32,
            geometry_msgs.Twist().encode(),
            "expected std_msgs/Int32, got geometry_msgs/Twist",
        ),
        (
            std_msgs.Int32,
            b"12345678",
            "expected std_msgs/Int32, got an unknown type (fingerprint 0x3132333435363738)",
        ),
        (
            geometry_msgs.Twist,
            geometry_msgs.Twist().encode()[:-1],
            "broken geometry_msgs/Twist: 48 bytes wanted at geometry_msgs/Twist.linear.x, 47 left",
        ),
        (
            std_msgs.String,
            string_payload(b"hello", 100),
            "broken std_msgs/String: 100 bytes wanted at std_msgs/String.data, 5 left",
        ),
        (
            std_msgs.String,
            string_payload(b"", 0)[:10],
            "broken std_msgs/String: 4 bytes wanted at std_msgs/String.data, 2 left",
        ),
        (
            std_msgs.String,
            string_payload(b"hello", 5),
            "broken std_msgs/String: no NUL at the end of std_msgs/String.data",
        ),
        (
            sensor_msgs.Image,
            image_payload(10),
            "broken sensor_msgs/Image: 10 bytes wanted at sensor_msgs/Image.data, 0 left",
        ),
        (
            sensor_msgs.Image,
            image_payload(-1),
            "broken sensor_msgs/Image: negative length at sensor_msgs/Image.data",
        ),
        (
            sensor_msgs.JointState,
            encode(sensor_msgs.JointState())[:8] + b"\x7f\xff\xff\xff" + bytes(100),
            (
                "broken sensor_msgs/JointState: "
                "8589934588 bytes wanted at sensor_msgs/JointState.name, 72 left"
            ),
        ),
        (
            TFMessage,
            encode(TFMessage())[:8] + b"\xff\xff\xff\xff",
            "broken tf2_msgs/TFMessage: negative length at tf2_msgs/TFMessage.transforms",
        ),
    ],
)
def test_a_broken_payload_is_refused(cls, payload, line):
    with pytest.raises(DecodeError) as caught:
        decode(cls, payload)
    assert str(caught.value) == line


def test_a_few_bytes_cannot_ask_for_millions_of_empty_messages(odd):
    head = encode(odd.Many())[:8]
    assert len(decode(odd.Many, head + struct.pack(">i", 1000)).items) == 1000
    with raises_saying(DecodeError, "2147483647 elements", "odd/Many"):
        decode(odd.Many, head + b"\x7f\xff\xff\xff")
    with pytest.raises(DecodeError, match="negative length"):
        decode(odd.Many, head + b"\x80\x00\x00\x00")


def test_a_few_bytes_cannot_ask_for_millions_of_empty_rows(odd):
    head = encode(odd.Flat())[:8]
    with raises_saying(DecodeError, "2147483647 elements", "odd/Flat"):
        decode(odd.Flat, head + struct.pack(">ii", 0x7FFFFFFF, 0))
    for sizes in ((-1, -1), (-1, 0), (0, -1), (1, -1)):
        with pytest.raises(DecodeError, match="negative length"):
            decode(odd.Flat, head + struct.pack(">ii", *sizes))


def test_a_payload_nested_too_deeply_is_refused(odd):
    payload = encode(odd.Tree())[:8] + struct.pack(">ih", 1, 0) * 100_000
    with raises_saying(DecodeError, "odd/Tree: ", "nested", "100"):
        decode(odd.Tree, payload)


def test_services_have_messages_like_any_other():
    answer = std_srvs.Trigger.Response()
    answer.success, answer.message = True, "done"
    assert decode(std_srvs.Trigger_Response, encode(answer)).message == "done"
