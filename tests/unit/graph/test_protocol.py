"""Announcements and probes: there and back, and nothing hostile raises."""

import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools.graph.model import CallbackError, Endpoint, NodeInfo, Role, Traffic
from lcmtools.graph.protocol import (
    MOST_OBSERVED,
    Announcement,
    Probe,
    Shutdown,
    decode_announcement,
    decode_probe,
    decode_shutdown,
    encode_announcement,
    encode_probe,
    encode_shutdown,
    head_of,
)
from lcmtools.messages.appendable import appendables, encode_appendable
from lcmtools.messages.codec import encode
from lcmtools.types import lcmtools_msgs as msgs
from lcmtools.types.std_msgs import String

_NODE = NodeInfo(
    name="/husky0/driver",
    id="abc",
    host="robot",
    pid=4242,
    start_time=1_700_000_000_000_000_001,
    command="driver --ns /husky0 été",
    tool=True,
    ports=(40_001, 65_535),
    endpoints=(
        Endpoint(
            "/husky0/odometry",
            Role.PUBLISHER,
            ("nav_msgs/Odometry", "nav_msgs/Path"),
            (0x94E17F94648CF0E4, 0xC3AE62ACB35793E2, 1, (1 << 64) - 1, 1 << 63),
            "group",
            10,
            1 << 40,
            1 << 41,
            3,
            1_700_000_000_000_000_002,
        ),
        Endpoint("/a", Role.SUBSCRIBER, calls=7, busy=1 << 42, longest=1 << 41),
        Endpoint("/b", Role.SERVICE, calls=1, busy=2, longest=3),
        Endpoint("/c", Role.CLIENT),
    ),
    busy=1 << 43,
    sent=1_700_000_000_000_000_003,
    errors=(
        CallbackError("/odometry", "KeyError", "'l'", "simple_controller.py:35", 340, 1 << 60),
        CallbackError("timer 0.1 s", "ValueError", "", "moving_robot.py:1", 1, 2),
    ),
)


_MANY = tuple(Endpoint(f"/topic_{n}", Role.PUBLISHER) for n in range(500))
_BARE = NodeInfo("/a", "i", "h", 1)
_ANNOUNCEMENT = encode_announcement, decode_announcement
_PROBE, _SHUTDOWN = (encode_probe, decode_probe), (encode_shutdown, decode_shutdown)


@pytest.mark.parametrize(
    ("ways", "message"),
    [
        *((_ANNOUNCEMENT, Announcement(_NODE, answers=n)) for n in (0, 1, -(1 << 63))),
        (_ANNOUNCEMENT, Announcement(_NODE, leaving=True, answers=(1 << 63) - 1)),
        (_ANNOUNCEMENT, Announcement(_BARE)),
        (_ANNOUNCEMENT, Announcement(_BARE._replace(endpoints=_MANY))),
        *((_PROBE, probe) for probe in (Probe(), Probe("/a", 7), Probe("", -1))),
        *((_SHUTDOWN, one) for one in (Shutdown("abc", 7, "a person"), Shutdown(""))),
    ],
)
def test_a_message_survives_the_way_there_and_back_and_is_nothing_if_truncated(ways, message):
    write, read = ways
    payload = write(message)
    assert read(payload) == message
    assert all(
        read(payload[:end]) is None for end in range(0, len(payload), len(payload) // 99 + 1)
    )


_PAYLOAD = encode_announcement(Announcement(_NODE))


def _of(*endpoints):
    message, details = msgs.Announcement(), msgs.NodeDetails()
    message.name, details.endpoints = "/a", appendables(endpoints)
    message.details = encode_appendable(details)
    return encode(message)


def _named(topic, role=0):
    endpoint = msgs.Endpoint()
    endpoint.topic, endpoint.role = topic, role
    return endpoint


@pytest.mark.parametrize(
    ("topic", "role"),
    [("/a", 4), ("/a", -1), ("/a", 127), ("", 0), ("/" + 63 * "a", 0), ("/a\0b", 0)],
)
def test_an_endpoint_with_an_unknown_role_or_that_is_no_channel_is_left_out(topic, role):
    decoded = decode_announcement(_of(_named(topic, role), _named("/b")))
    assert [end.topic for end in decoded.node.endpoints] == ["/b"]


def test_an_announcement_of_an_unknown_state_is_a_node_that_lives():
    message = msgs.Announcement()
    message.name, message.state = "/driver", 7
    decoded = decode_announcement(encode(message))
    assert not decoded.leaving


@pytest.mark.parametrize("length", [-1, 1 << 30, (1 << 31) - 1, -(1 << 31)])
@pytest.mark.parametrize("position", [8, 16])  # of the details, of the name
def test_an_announcement_with_an_absurd_length_is_none(position, length):
    broken = bytearray(_PAYLOAD)
    struct.pack_into(">i", broken, position, length)
    assert decode_announcement(bytes(broken)) is None


def test_another_message_is_no_announcement_and_no_probe():
    payload = encode(String())
    assert decode_announcement(payload) is None
    assert decode_probe(payload) is None
    assert decode_probe(_PAYLOAD) is None
    assert decode_shutdown(_PAYLOAD) is None


@settings(max_examples=300)
@given(st.data())
def test_an_announcement_with_any_bytes_changed_never_raises(data):
    broken = bytearray(_PAYLOAD)
    for _ in range(data.draw(st.integers(1, 8))):
        broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    decode_announcement(bytes(broken))


@given(st.binary(max_size=200))
def test_any_bytes_after_the_fingerprint_never_raise(data):
    decode_announcement(_PAYLOAD[:8] + data)
    decode_probe(encode_probe(Probe())[:8] + data)


def test_the_identity_in_an_announcement_is_the_nodes_own():
    def identity(node, *, leaving=False, answers=0):
        return head_of(encode_announcement(Announcement(node, leaving, answers))).identity

    assert identity(_NODE)
    changed = _NODE._replace(endpoints=(), ports=(1,), command="")
    assert identity(changed, answers=9) == identity(_NODE)
    assert identity(_NODE, leaving=True) != identity(_NODE)
    for other in (_NODE._replace(name="/b"), _NODE._replace(id="x"), _NODE._replace(host="h2")):
        assert identity(other) != identity(_NODE)


def _revision(node):
    return head_of(encode_announcement(Announcement(node))).revision


def test_counters_and_clocks_change_no_revision():
    counted = _NODE.endpoints[1]._replace(
        messages=9, bytes=9, drops=9, last_time=9, calls=9, busy=9, longest=9
    )
    endpoints = (_NODE.endpoints[0], counted, *_NODE.endpoints[2:])
    assert _revision(_NODE._replace(endpoints=endpoints, sent=9, busy=9)) == _revision(_NODE)
    changed = (_NODE.endpoints[0], counted._replace(depth=9), *_NODE.endpoints[2:])
    assert _revision(_NODE._replace(endpoints=changed)) != _revision(_NODE)


def test_another_error_of_a_callback_changes_the_revision_and_its_count_does_not():
    first, second = _NODE.errors
    counted = first._replace(message="'r'", count=341, last_time=9)
    assert _revision(_NODE._replace(errors=(second, counted))) == _revision(_NODE)
    assert _revision(_NODE._replace(errors=(first,))) != _revision(_NODE)


def test_no_more_than_the_newest_five_errors_are_announced():
    errors = tuple(_NODE.errors[0]._replace(place=f"a.py:{line}") for line in range(9))
    got = decode_announcement(encode_announcement(Announcement(_NODE._replace(errors=errors))))
    assert got.node.errors == errors[-5:]


def test_an_announcement_is_sent_at_a_time():
    announcement = Announcement(_NODE, leaving=True, answers=3)
    assert announcement.sent_at(5) == Announcement(_NODE._replace(sent=5), leaving=True, answers=3)


@given(st.binary(max_size=120))
def test_the_identity_in_anything_else_is_empty_or_some_bytes(data):
    assert head_of(data).identity == b"" or data.startswith(_PAYLOAD[:8])
    head_of(_PAYLOAD[:8] + data)


@pytest.mark.parametrize(
    "name", ["", "/", "driver", "/a//b", "/a/", "/a b", "/\x1b[2J", "~a", "/" + 63 * "a"]
)
def test_an_announcement_of_a_node_without_a_proper_name_is_none(name):
    message = msgs.Announcement()
    message.name = name
    assert decode_announcement(encode(message)) is None


def test_of_what_a_stranger_claims_to_have_observed_the_first_valid_channels_are_read():
    names = ["", "a" * 300, *(f"/{number}" for number in range(1_000))]
    observed = tuple(Traffic(name, None, (), 1, 1, -(1 << 63), (1 << 63) - 1) for name in names)
    decoded = decode_announcement(
        encode_announcement(Announcement(NodeInfo("/n", "i", "h", 1, observed=observed)))
    )
    read = decoded.node.observed
    assert [seen.channel for seen in read] == names[2:MOST_OBSERVED]
    assert str(read[0].sender) == "unknown"
