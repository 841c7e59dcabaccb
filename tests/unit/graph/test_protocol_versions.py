"""Programs of other versions of lcmtools: their messages and files are read as far as known.

tests/fixtures/protocol has messages and files of version 1. They are never written anew: what a
program of this version sends must be readable for ever.
"""

import json
import os
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from fixtures.protocol import messages as version_1

from lcmtools.bag.log import open_log
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.doctor.saved import from_text
from lcmtools.errors import DecodeError
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import VERSION, Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROTOCOL_CHANNELS,
    Announcement,
    Probe,
    Retained,
    Shutdown,
    decode_announcement,
    decode_probe,
    decode_shutdown,
    encode_announcement,
    encode_probe,
    encode_shutdown,
    head_of,
)
from lcmtools.graph.relay_report import State, decode_report, encode_report
from lcmtools.messages.appendable import decode_appendable, encode_appendable
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import fingerprint
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types import lcmtools_msgs as msgs
from lcmtools.types.std_msgs import String
from lcmtools.wire.log_index import parse_index
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.stamp import Origin, Stamp, decode_stamp

_FIXTURES = Path(version_1.__file__).parent
_BYTES = {
    name: bytes.fromhex(text)
    for name, text in json.loads((_FIXTURES / "messages.json").read_text()).items()
}
_NODE, _REMOTE, _REPORT = version_1.NODE, version_1.REMOTE, version_1.REPORT

_FROZEN = {
    msgs.Announcement: 0x04FC851A704B5456,
    msgs.Appendable: 0x320FD561652534BE,
    msgs.RemoteAnnouncement: 0x18AD9405B8DDCCD0,
    msgs.RelayReport: 0xFFA7027E4FFA5232,
    msgs.Probe: 0x36A8CC66FEBE4DC8,
    msgs.Shutdown: 0x2E46E88DD1CD3B5F,
    msgs.ServiceRequest: 0x208E80B7F6920AEE,
    msgs.ServiceReply: 0xD7C6C2990B932630,
    msgs.Parameters.Request: 0x777BDB458F3E0541,
    msgs.Parameters.Response: 0x65C38BA64D96A12F,
}

_APPENDABLE = {  # the fields of version 1; a later version may have more behind them
    msgs.NodeDetails: "ports_length endpoints_length errors_length ports endpoints busy errors",
    msgs.Endpoint: (
        "types_length fingerprints_length topic role types fingerprints group depth latched"
        " messages bytes drops last_time calls busy longest rate"
    ),
    msgs.CallbackError: "callback exception message place count last_time",
    msgs.RelayStep: "id relay bus",
    msgs.RelayLink: "ends_length id name host state number ends",
    msgs.RelayEnd: (
        "heard_length ports_length commands_length id bus heard ports is_up trouble messages bytes"
        " left_out dropped commands lost"
    ),
}


@pytest.mark.parametrize("cls", _FROZEN, ids=lambda cls: cls.__name__)
def test_a_frozen_message_has_its_fingerprint_for_ever(cls):
    assert hex(fingerprint(cls)) == hex(_FROZEN[cls])


@pytest.mark.parametrize("cls", _APPENDABLE, ids=lambda cls: cls.__name__)
def test_an_appendable_struct_begins_with_the_fields_of_version_1(cls):
    names = [field.name for field in fields(cls)]
    known = _APPENDABLE[cls].split()
    assert names[: len(known)] == known
    assert VERSION > 1 or names == known, "a new version number goes with a new field"


def _service(name):
    message = decode(getattr(msgs, name), _BYTES[f"service {name[7:].lower()}"])
    return [getattr(message, field.name) for field in fields(type(message))]


def _parameter(message):
    (one,) = message.changes if isinstance(message, msgs.Parameters_Request) else message.parameters
    return [getattr(one, field.name) for field in fields(msgs.Parameter)]


_PARAMETER = ["kp", "float", "1.5", "gain", "0", "2", True]


@pytest.mark.parametrize(
    ("read", "expected"),
    [
        (lambda: decode_announcement(_BYTES["announcement"]), Announcement(_NODE, answers=77)),
        (lambda: decode_announcement(_BYTES["goodbye"]), Announcement(_NODE, leaving=True)),
        (
            lambda: decode_announcement(_BYTES["remote announcement"]),
            Announcement(_REMOTE, answers=77),
        ),
        (lambda: decode_report(_BYTES["relay report"]), _REPORT),
        (lambda: decode_probe(_BYTES["probe"]), Probe("/husky0/driver", 7)),
        (lambda: decode_shutdown(_BYTES["shutdown"]), Shutdown("1-abc", 8, "someone")),
        (lambda: _service("ServiceRequest"), [2, "c", 5, b"\1\2"]),
        (lambda: _service("ServiceReply"), [1, "c", 5, 1, "no", b"\1"]),
        (
            lambda: _parameter(decode(msgs.Parameters.Request, _BYTES["parameters request"])),
            _PARAMETER,
        ),
        (
            lambda: _parameter(decode(msgs.Parameters.Response, _BYTES["parameters response"])),
            _PARAMETER,
        ),
        (lambda: decode_stamp(_BYTES["stamp"]), Stamp(1 << 63, 2, 3, Origin(1 << 63, 2))),
        (lambda: decode_stamp(_BYTES["relayed stamp"]), Stamp(1, 2, 3, Origin(4, 5, 6))),
    ],
)
def test_a_message_of_version_1_is_read(read, expected):
    assert read() == expected


def test_this_version_writes_a_message_as_version_1_does():
    assert VERSION > 1 or encode_report(_REPORT) == _BYTES["relay report"]
    assert encode_probe(Probe("/husky0/driver", 7)) == _BYTES["probe"]
    assert encode_shutdown(Shutdown("1-abc", 8, "someone")) == _BYTES["shutdown"]


def _newer(payload, *, roles=True):
    """Return an announcement as of a later version: more in each place that may grow."""
    message = decode(msgs.Announcement, payload)
    message.version, message.software = VERSION + 1, "lcmtools 9.0.0"
    details = decode_appendable(msgs.NodeDetails, message.details)
    for one in details.endpoints:  # as of this version
        one.data = encode_appendable(decode_appendable(msgs.Endpoint, one.data))
    for one in (*details.endpoints, *details.errors):
        one.data += b"\0\0\0\7more\0"
    if roles:
        endpoint, one = msgs.Endpoint(), msgs.Appendable()
        endpoint.topic, endpoint.role = "/action", 9
        one.data = encode_appendable(endpoint)
        details.endpoints = [one, *details.endpoints]
    message.details = encode_appendable(details) + b"\0\0\0\1\1"
    return encode(message) + b"bytes after the end"


def test_what_a_later_version_appends_is_ignored():
    payload = _newer(_BYTES["announcement"])
    expected = _NODE._replace(version=VERSION + 1, software="lcmtools 9.0.0")
    assert decode_announcement(payload) == Announcement(expected, answers=77)
    assert head_of(payload).identity == head_of(_BYTES["announcement"]).identity


def test_what_an_earlier_version_lacks_has_defaults():
    message = decode(msgs.Announcement, _BYTES["announcement"])
    details = decode_appendable(msgs.NodeDetails, message.details)
    after_depth = encode_appendable(_endpoint_of(details)).index(b"group\0") + 6 + 4
    first = details.endpoints[0]
    first.data = first.data[:after_depth]
    whole = encode_appendable(details)
    # without busy, errors, the namespace, overflows and what was observed
    message.details = whole[: -4 - 8 - 8 - 4 - len(details.errors[0].data) - 8]
    details.errors_length = 0
    decoded = decode_announcement(encode(message))
    assert decoded is not None
    expected = Endpoint(*version_1.ENDPOINT[:6])
    assert decoded.node.endpoints[0] == expected
    assert (decoded.node.busy, decoded.node.errors, decoded.node.ports) == (0, (), _NODE.ports)


def _endpoint_of(details):
    return decode_appendable(msgs.Endpoint, details.endpoints[0].data)


@pytest.mark.parametrize("cls", _APPENDABLE, ids=lambda cls: cls.__name__)
def test_a_struct_that_ends_after_any_of_its_fields_is_read(cls):
    whole = encode_appendable(cls())
    ends = {end for end in range(len(whole) + 1) if _is_read(cls, whole[:end])}
    names = [field for field in fields(cls) if not field.dimensions]
    assert {0, len(whole)} <= ends
    assert len(ends) == len(names) + 1  # empty arrays take no bytes


def _is_read(cls, data):
    with suppress(DecodeError):
        decode_appendable(cls, data)
        return True
    return False


@pytest.mark.parametrize("details", [b"", b"\xff" * 9, b"\0\0\0"])
def test_of_unreadable_details_the_head_remains(details):
    message = decode(msgs.Announcement, _BYTES["announcement"])
    message.details = details
    decoded = decode_announcement(encode(message))
    assert decoded is not None
    bare = _NODE._replace(ports=(), endpoints=(), busy=0, errors=(), has_details=False)
    assert decoded.node == bare
    passed_on = decode_announcement(encode_announcement(decoded))
    assert passed_on == decoded  # by a relay, which could not read them either


def test_topics_of_unreadable_details_are_those_of_the_messages():
    message = decode(msgs.Announcement, _BYTES["announcement"])
    message.details = b"\xff"
    builder, sender = GraphBuilder(), Sender("127.0.0.1", 4001)
    builder.add(Packet(NODE_CHANNEL, encode(message), 1, sender))
    builder.add(Packet("/chatter", encode(String()), 2, sender))
    builder.add(Packet("/other", encode(String()), 3, Sender("127.0.0.1", 4002)))
    graph = builder.snapshot(4)
    ((node, end),) = graph.topic("/chatter").publishers
    assert (node.name, end.role, end.messages) == ("/husky0/driver", Role.PUBLISHER, 1)
    assert graph.topic("/other").publishers == ()
    assert not node.stale


def test_values_of_later_enumerations_do_no_harm():
    message = decode(msgs.Announcement, _BYTES["announcement"])
    message.state = 9
    decoded = decode_announcement(encode(message))
    assert not decoded.leaving
    report = decode(msgs.RelayReport, _BYTES["relay report"])
    link = decode_appendable(msgs.RelayLink, report.links[0].data)
    link.state = 9
    report.links[0].data = encode_appendable(link) + b"more"
    read = decode_report(encode(report) + b"more")
    assert read == _REPORT._replace(links=(replace(_REPORT.links[0], state=State.STANDBY),))


def test_a_link_that_cannot_be_read_costs_no_other():
    report = decode(msgs.RelayReport, _BYTES["relay report"])
    odd = msgs.Appendable()
    odd.data = b"\xff"
    report.links = [odd, *report.links]
    assert decode_report(encode(report)) == _REPORT


@pytest.mark.parametrize("channel", sorted(PROTOCOL_CHANNELS))
@pytest.mark.parametrize("payload", [b"", b"\1" * 8, b"\1" * 80, encode(String())])
def test_an_unknown_message_on_a_channel_of_the_protocol_does_nothing(channel, payload):
    builder = GraphBuilder()
    builder.add(Packet(channel, payload, 1, None))
    assert builder.add_all([Packet(channel, payload, 1, None)])
    assert builder.snapshot(2).nodes == ()
    for read in (decode_announcement, decode_probe, decode_shutdown, decode_report):
        assert read(payload) is None


@pytest.mark.parametrize("name", ["announcement", "remote announcement"])
def test_an_announcement_that_is_kept_for_others_keeps_what_is_unknown(name):
    payload = _BYTES[name] if name.startswith("remote") else _newer(_BYTES[name])
    retained = Retained()
    retained.keep(payload, 1.0)
    (kept,) = retained.payloads(2.0)
    before, after = decode_announcement(payload), decode_announcement(kept)
    assert after == Announcement(before.node).sent_at(0)
    if not name.startswith("remote"):
        inner = partial(decode, msgs.Announcement)
        assert inner(kept).details == inner(payload).details


def test_a_log_of_version_1_is_read():
    with LogFile(_FIXTURES / "ride.lcmlog") as log:
        (announced,) = log.announcements()
        assert decode_announcement(announced.payload) == Announcement(_NODE)
        assert [packet.channel for packet in log.packets()] == ["/chatter"] * 3
        assert log.index.blocks
        assert [loss.lost for loss in log.losses().values()] == [5]
        assert set(log.index.types) == {"rover/state_t"}
        assert {one.name for one in log.index.senders.values()} == {"/husky0/driver"}


def test_an_index_of_a_later_version_is_read_as_far_as_it_is_known():
    lines = (_FIXTURES / "ride.lcmlog.index").read_text().splitlines()
    newer = ['{"index":2}', '{"weather":["sunny"]}']
    for line in lines[1:]:
        ((key, value),) = json.loads(line).items()
        if isinstance(value, list):
            value.append("more")
        if key == "block":
            value[4] = {name: [*counts, "more"] for name, counts in value[4].items()}
            value.insert(5, 0) if len(value) == 6 else None
        newer.append(json.dumps({key: value}))
    assert parse_index(newer) == parse_index(lines)


@pytest.mark.parametrize("lines", [[], ["{}"], ['{"index":"1"}'], ['{"other":1}'], ["no JSON"]])
def test_lines_that_are_no_index_are_none(lines):
    assert parse_index(lines) is None


@pytest.fixture
def record(tmp_path):
    """Writes the record of a node that has ended."""
    url = parse_url("udpm://239.255.76.67:19999?ttl=0")

    def write(values):
        records = NodeRecords(url, {"XDG_RUNTIME_DIR": str(tmp_path)})
        records.write(NodeInfo("/other", "other", "here", os.getpid()))
        (folder,) = (tmp_path / "lcmtools" / "records").iterdir()
        (folder / "abc.json").write_text(json.dumps(values))
        records.remove("other")
        return records

    return write


_RECORD = {"name": "/a", "id": "abc", "host": "here", "pid": 1, "start_ticks": -1}


@pytest.mark.parametrize(
    "values",
    [
        _RECORD,
        {**_RECORD, "version": 9, "start_time": 5, "command": "a b", "weather": ["sunny"]},
    ],
)
def test_a_record_of_another_version_is_read(values, record):
    (node,) = record(values).read()
    assert (node.name, node.id, node.pid) == ("/a", "abc", 1)
    assert node.stale == "ended without saying goodbye"


def _evidence():
    document = json.loads((_FIXTURES / "evidence.json").read_text())
    return document


def test_evidence_of_version_1_is_read():
    evidence = from_text(json.dumps(_evidence()))
    assert evidence.url == "udpm://239.255.76.67:7667?ttl=1"
    assert [node.name for node in evidence.graph.nodes] == ["/n"]
    assert evidence.clocks[0].host == "h"
    assert evidence.relays[0].commands == ("/cmd_vel",)


def test_evidence_of_a_later_version_is_read_as_far_as_it_is_known():
    document = _evidence()
    document["lcmtools_evidence"] = 2
    evidence = document["evidence"]
    evidence["weather"] = "sunny"
    (node,) = evidence["graph"]["nodes"]
    node["color"] = "red"
    node["stale"] = "ASLEEP"
    node["sender"].append("more")
    node["endpoints"] = [*node["endpoints"], {"topic": "/action", "role": "ACTION"}]
    found = from_text(json.dumps(document))
    usual = from_text(json.dumps(_evidence()))
    (expected,) = usual.graph.nodes
    assert found.graph.nodes == (expected._replace(stale=type(expected.stale).NOT),)
    assert replace(found, graph=usual.graph) == usual


def test_a_log_of_version_1_is_played_from_python(monkeypatch):
    monkeypatch.setattr("lcmtools.messages.supply._make", None)  # the log's types are for here only
    monkeypatch.setattr("lcmtools.messages.supply._supply", None)
    with open_log(_FIXTURES / "ride.lcmlog") as log:
        assert [arrival.message.data for arrival in log.messages()] == [
            f"hello {n}" for n in range(3)
        ]
