"""Payloads that are no LCM messages are told by their format, and LCM messages are let be."""

import gzip
import json
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.messages.codec import encode
from lcmtools.messages.foreign import foreign_format
from lcmtools.messages.message_template import draft_from_values
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.std_msgs import String

# name: "lidar", id: 7, ranges: [1.0, 2.0] packed, stamp { sec: 1, nsec: 300 }, as protoc writes it
PROTOBUF = bytes.fromhex("0a056c69646172 1007 1a080000803f00000040 2205080110ac02")


@pytest.mark.parametrize(
    ("payload", "name"),
    [
        (b'{"speed": 0.5, "name": "r\xc3\xa9"}', "JSON"),
        (b'[1, 2.5, {"a": null}]\n', "JSON"),
        (b"{}", "JSON"),
        (b'{"speed": 0.5}\0', "JSON"),
        (b"{speed: 0.5}", "text"),
        (b"hello", "text"),
        (b"42", "text"),
        (b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M\r\n", "text"),
        (b"\x1b[31mred\x1b[0m", "text"),
        (b"<?xml version='1.0'?><a/>", "XML"),
        (PROTOBUF, "protobuf"),
        (bytes([8, 1]), "protobuf"),
        (pickle.dumps({"a": 1}), "a pickle of Python"),
        (gzip.compress(b"abc", mtime=0), "data compressed by gzip"),
        (b"\x89PNG\r\n\x1a\n1234", "a PNG image"),
        (b"\xff\xd8\xff\xe0JFIF", "a JPEG image"),
        (b"\x00\x01\x00\x00\x06\x00\x00\x00hello\x00", "CDR, as ROS 2 and DDS send it"),
        (b"", "nothing (no bytes)"),
        (b"\xff\xfe\xfd", "3 bytes"),
        (b"\xff" * 20, ""),
    ],
)
def test_the_format_is_told_by_the_bytes(payload, name):
    assert foreign_format(payload) == name


@pytest.mark.parametrize("end", range(6, 60, 5))
def test_a_head_is_enough_for_json_and_text(end):
    document = json.dumps({"name": "r\u00e9gulateur", "ranges": [1.5] * 20}, ensure_ascii=False)
    assert foreign_format(document.encode()[:end], is_whole=False) == "JSON"
    assert foreign_format("r\u00e9gulateur".encode()[:2], is_whole=False) == "text"


def test_a_head_of_protobuf_is_protobuf():
    assert foreign_format(PROTOBUF[:-3], is_whole=False) == "protobuf"
    assert foreign_format(PROTOBUF[:-3]) == ""


def test_messages_that_hold_text_are_messages():
    text = draft_from_values(String, ["a long text, mostly of letters"]).message
    assert foreign_format(encode(text)) == ""
    assert foreign_format(encode(Odometry())[:100], is_whole=False) == ""


@given(st.binary(max_size=200), st.booleans())
def test_any_bytes_are_survived(payload, is_whole):
    assert isinstance(foreign_format(payload, is_whole=is_whole), str)
