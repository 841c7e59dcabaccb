"""Evidence in a file: all of it comes back, and what is no such file costs one line."""

import json
import random
from dataclasses import fields, replace

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import (
    Evidence,
    FrameParent,
    Host,
    HostClock,
    LcmProcess,
    Listener,
    LogLine,
    Oddity,
    Publication,
    RelayEnd,
    SenderFacts,
    SimulatedClock,
    Stream,
)
from lcmtools.doctor.saved import from_text, load, save, to_text
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness, Traffic
from lcmtools.wire.packet import Sender

ALICE = Sender("10.0.0.1", 4000)
TAKES = Endpoint("/a", Role.SUBSCRIBER, ("std_msgs/String",), (1 << 63,), "g", 10, 1, 2, 3, 4, 5)
NODE = NodeInfo(
    "/n", "id", "h", 7, 1, "run n", tool=True, ports=(5,), endpoints=(TAKES,), sender=ALICE
)
NODE = NODE._replace(last_announced=9, stale=Staleness.HANGS, busy=1, sent=2)
LISTENER = Listener("l", None, 0, 1, 2, 3, 4, "T", is_tool=True, is_node=True)
STREAM = Stream("A", ALICE, "alice", (1, 2), 3, 4, is_cut=True, pid=5)
EVERYTHING = Evidence(
    url="udpm://239.255.76.67:7667?ttl=1",
    bus_problem="none",
    bus_remedy="none",
    ttl=1,
    graph=Graph((NODE._replace(lag=-5),), (Traffic("\udcff\n", None, (1, 2), 3, 4, 5, 6),), 7),
    before=Graph((NODE,), (), 6),
    listened=0.25,
    malformed=(("10.0.0.1:4000", "bad"),),
    own_drops=1,
    senders=(
        SenderFacts(ALICE, "alice", is_local=False, messages=5, lost=6, ttl=1, uid=7, paces=True),
    ),
    streams=(STREAM, Stream("B", None, "?", ())),
    remembered=(Publication("A", ALICE, "alice", 5, 10.0, 0.5, 3),),
    listeners=(LISTENER,),
    oddities=(Oddity("old", "A", "alice", "x", 2),),
    frames=(FrameParent("/", "base", "odom", "a"),),
    logs=(LogLine("/n", "error", "it burns", 2),),
    clock=SimulatedClock("sim", 0.5, None, 0.25),
    processes=(LcmProcess(1, "c", "b", "v", 2, 3, "T", ("t",)),),
    host=Host(uid=5, joined=("lo",), has_sockets=False),
    stale_published=frozenset({"a", "b"}),
    stale_subscribed=frozenset({"c"}),
    processor_wait=0.5,
    waits={7: 0.25},
    users={1000: "alice"},
    clocks=(HostClock("h", "10.0.0.1", -0.5, ("/n",)),),
    remote=frozenset({"id"}),
    relays=(RelayEnd("/r", "h", "tcpq://office", "is lost", 3, ("/cmd_vel",), stands_by=True),),
    damaged_bytes=1,
)


def test_all_evidence_comes_back(tmp_path):
    for part in fields(Evidence):  # nothing is left at its default, which is not written
        assert getattr(EVERYTHING, part.name) != getattr(Evidence("x"), part.name), part.name
    file = tmp_path / "evidence.json"
    save(EVERYTHING, file)
    assert load(file) == EVERYTHING
    assert from_text(to_text(Evidence("udpm://"))) == Evidence("udpm://")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "it is not JSON"),
        ("[" * 100_000, "it is not JSON"),
        ("[]", "it is other JSON"),
        ('{"rule": "loss"}', "it is other JSON"),
        ('{"lcmtools_evidence": "2", "evidence": {}}', "it is other JSON"),
        ('{"lcmtools_evidence": 1}', "'evidence' is missing, unknown or wrong"),
        ('{"lcmtools_evidence": 1, "evidence": {}}', "'evidence.url' is missing, unknown or wrong"),
    ],
)
def test_a_file_that_holds_no_evidence_is_told_in_a_line(text, why, tmp_path):
    file = tmp_path / "some.json"
    file.write_text(text)
    with pytest.raises(LcmtoolsError) as caught:
        load(file)
    assert caught.value.what == f"{file} does not contain evidence that wtf can judge: {why}"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ttl", "1"),
        ("ttl", True),
        ("ttl", 1.5),
        ("ttl", 10**30),
        ("listened", float("nan")),
        ("listened", float("inf")),
        ("graph", {"nodes": [{"name": "/n"}]}),
        ("graph", {"nodes": {}}),
        ("senders", [{"sender": ["10.0.0.1"], "name": "x"}]),
        ("streams", [{"channel": "A", "sender": None, "name": "x", "times": [None]}]),
        ("users", {"-1": "x"}),
    ],
)
def test_values_that_do_not_fit_are_refused_with_their_place(name, value):
    document = {"lcmtools_evidence": 1, "evidence": {"url": "udpm://", name: value}}
    with pytest.raises(Exception, match=rf"^'evidence\.{name}.*' is missing, unknown or wrong$"):
        from_text(json.dumps(document))


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(LcmtoolsError, match=r"cannot read .*: No such file"):
        load(tmp_path / "none")
    with pytest.raises(LcmtoolsError, match=r"cannot write .*: No such file"):
        save(EVERYTHING, tmp_path / "none" / "file")


def test_every_rule_stands_evidence_that_fits_and_makes_no_sense():
    """Numbers are replaced at random: rules may say anything, but must not fail."""
    chance = random.Random(1)  # noqa: S311 - for a test
    plain = json.loads(to_text(replace(EVERYTHING, bus_problem="", bus_remedy="")))

    def changed(part):
        if isinstance(part, dict):
            return {key: changed(value) for key, value in part.items()}
        if isinstance(part, list):
            return [changed(value) for value in part]
        if isinstance(part, int) and not isinstance(part, bool) and chance.random() < 0.5:
            return chance.choice([0, 1, -1, 2**63, -(2**63), 3_000_000_000])
        return part

    for _ in range(200):
        judge(from_text(json.dumps({**plain, "evidence": changed(plain["evidence"])})))
