"""One channel as texts: its properties, its message with curves, or its bytes."""

import pytest

from lcmtools.messages.codec import encode
from lcmtools.observe.channels.details import (
    DetailLine,
    detail_lines,
    flow_text,
    number_text,
    properties,
)
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.channels.study import Study
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.wire.packet import Packet

S = 1_000_000_000
START = 1_795_000_000 * S


def study_of(*values):
    """A study that has taken vectors, or payloads, two a second."""
    study = Study("A")
    for number, value in enumerate(values):
        message = Vector3()
        message.x = value if isinstance(value, float) else 0.0
        payload = value if isinstance(value, bytes) else encode(message)
        study.add_packet(Packet("A", payload, START + number * S // 2))
    return study


def lines_of(study):
    return detail_lines(study.state(), study.samples)


def test_a_number_has_its_curve_and_its_range_beside_it():
    x, y, _ = lines_of(study_of(0.0, 1.0, 2.0, 3.0, 4.0))
    assert x == DetailLine("x", "  x", "4.0", (0.0, 0.25, 0.5, 0.75, 1.0), "0 .. 4", is_number=True)
    assert (y.bars, y.span) == ((0.0,) * 5, "constant")


def test_numbers_that_hardly_differ_say_by_how_much():
    x, *_ = lines_of(study_of(*(9.81 + i * 1e-12 for i in range(4))))
    assert x.span == "9.81, within 3e-12"


def test_what_is_known_of_a_channel_has_labels():
    row = ChannelRow("A", rate=10.0, jitter=0.002, bandwidth=320.0, lost=3, loss=0.1, messages=27,
              senders=("drive.py (pid 42)",), age=0.5)  # fmt: skip
    assert flow_text(row) == (
        "10.00 Hz  jitter 2.0 ms  320 B/s  loss 10% of its senders' messages (3)  27 messages"
    )
    assert list(properties(row, study_of(1.0).state())) == [
        ("type", "geometry_msgs/Vector3 by its fingerprint, or geometry_msgs/Point"),
        ("fingerprint", "0xae7e5fba5eeca11e"),
        ("senders", "drive.py (pid 42)"),
        ("listeners", "-"),
        ("message", "32 B, 0.5 s ago"),
    ]


def test_what_cannot_be_decoded_is_shown_in_hexadecimal():
    found = lines_of(study_of(bytes(range(60, 80))))
    assert [(line.name, line.value) for line in found] == [
        ("     0", "3c 3d 3e 3f 40 41 42 43 44 45 46 47 48 49 4a 4b  <=>?@ABCDEFGHIJK"),
        ("    16", "4c 4d 4e 4f                                      LMNO"),
    ]


def test_before_the_first_message_it_says_so():
    found = dict(properties(ChannelRow("A"), Study("A").state()))
    assert found["message"] == "none since this view was opened"
    assert found["type"] == "unknown"


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "1"), (0.000012345, "1.2345e-05"), (123456.0, "123456"), (1e12, "1e+12")],
)
def test_numbers_are_short(value, text):
    assert number_text(value) == text
