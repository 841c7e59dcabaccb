"""Logs in Python: payloads that are no messages, and types of the user's own."""

import pytest
from fixtures.wire import encode_event

import lcmtools
import lcmtools.bag
import lcmtools.observe
from lcmtools.errors import DecodeError
from lcmtools.messages.codec import encode
from lcmtools.messages.supply import set_supply
from lcmtools.types.builtin_interfaces import Time
from lcmtools.wire.packet import Packet

SOUND = encode(Time())
PAYLOADS = [  # as they may be in a log, and the reason why they are no message
    (SOUND, ""),
    (b"", "too short"),
    (SOUND[:7], "too short"),
    (SOUND[:10], "truncated|short|bytes"),
    (b"\xff" * 16, "unknown type"),
    (b"{}", "too short"),
    (SOUND, ""),
]


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "odd.lcmlog"
    events = (
        encode_event(number, Packet("/a", payload, number * 1_000_000_000))
        for number, (payload, _) in enumerate(PAYLOADS)
    )
    path.write_bytes(b"".join(events))
    return path


def test_every_arrival_comes_with_its_payload(log):
    with lcmtools.bag.open(log) as opened:
        found = list(opened.messages(undecoded=True))
        assert [one.payload for one in opened.messages("/a", undecoded=True)] == [
            one for one, _ in PAYLOADS
        ]
    assert [one.payload for one in found] == [payload for payload, _ in PAYLOADS]
    for arrival, (_, reason) in zip(found, PAYLOADS, strict=True):
        if reason:
            with pytest.raises(DecodeError, match=reason):
                _ = arrival.message
        else:
            assert isinstance(arrival.message, Time)


def test_errors_are_handed_over(log):
    errors = list[DecodeError]()
    with lcmtools.bag.open(log) as opened:
        found = list(opened.messages(on_error=errors.append))
    assert (len(found), len(errors)) == (2, 5)


def test_a_log_knows_the_users_own_types(tmp_path, monkeypatch):
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "Only.lcm").write_text("package own;\nstruct Only { double x; }\n")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path / "own"))
    path = tmp_path / "own.lcmlog"
    set_supply(None)
    try:
        payload = encode(lcmtools.message_class("own/Only")())
        path.write_bytes(encode_event(0, Packet("/own", payload, 0)))
        set_supply(None)
        with lcmtools.bag.open(path) as opened:
            assert opened.topics["/own"].types == ("own/Only",)
            (arrival,) = opened
            assert arrival.message.x == 0.0
        set_supply(None)
        (arrival,) = lcmtools.observe.messages("/own", log=path)
        assert arrival.message.x == 0.0
    finally:
        set_supply(None)
