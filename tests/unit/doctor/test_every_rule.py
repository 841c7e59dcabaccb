"""Every rule's finding can be had from evidence in a file, without a process or a bus."""

from dataclasses import replace

import pytest
from fixtures.judging import judge

from lcmtools.doctor import report
from lcmtools.doctor.evidence import (
    Evidence,
    FrameParent,
    Host,
    HostClock,
    LcmProcess,
    Listener,
    LogLine,
    Oddity,
    RelayEnd,
    SenderFacts,
    SimulatedClock,
    Stream,
)
from lcmtools.doctor.findings import Severity, finding, rule, state
from lcmtools.doctor.rules import RULES
from lcmtools.doctor.sentences import commands
from lcmtools.graph.model import (
    VERSION,
    CallbackError,
    Endpoint,
    FullLine,
    Graph,
    Node,
    Role,
    Staleness,
    Traffic,
)
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.messages.type_versions import fingerprint_of
from lcmtools.wire.packet import Sender

SECOND = 1_000_000_000
OLD_POSE = fingerprint_of(fields(message_class("geometry_msgs/Pose2D"))[:2])
NOW = 1_000_000 * SECOND
ALICE, BOB = Sender("10.0.0.1", 4000), Sender("10.0.0.2", 5000)
PRINT = fingerprint(message_class("std_msgs/String"))
SPEAKS = Endpoint("/a", Role.PUBLISHER, ("std_msgs/String",), (PRINT,))
TAKES = SPEAKS._replace(role=Role.SUBSCRIBER, depth=10)
TALKER = Node("/talker", "t", "here", 7, NOW - 100 * SECOND, "run talker", endpoints=(SPEAKS,))
EAR = Node("/ear", "e", "here", 8, NOW - 100 * SECOND, "run ear", endpoints=(TAKES,), sent=1)
GOOD = Evidence(
    "udpm://239.255.76.67:7667?ttl=1",
    ttl=1,
    graph=Graph((TALKER, EAR), time=NOW),
    before=Graph((TALKER, EAR), time=NOW - SECOND),
    listened=1.0,
    host=Host(uid=1000, interface="eth0", speed_mbit=1000, joined=("eth0",)),
)
EVEN = Stream("A", ALICE, "alice", tuple(NOW - n * SECOND // 50 for n in range(50, 0, -1)))
GAP = replace(EVEN, times=(*(t - SECOND for t in EVEN.times[:25]), *EVEN.times[25:]))
EMPTY = replace(GOOD, graph=Graph(), before=Graph())
OLDER = Endpoint("/a", Role.PUBLISHER, messages=9900, last_time=NOW - SECOND)


def graph(*nodes, traffic=()):
    return replace(GOOD, graph=Graph(nodes, traffic, NOW))


def host(**values):
    return replace(GOOD, host=replace(GOOD.host, **values))


def having(node, **values):
    return node._replace(endpoints=(node.endpoints[0]._replace(**values),), sent=1 + SECOND)


def server(node):
    offer = Endpoint("/go", Role.SERVICE, ("std_srvs/Trigger",), (4,))
    return node._replace(endpoints=(*node.endpoints, offer))


def sent(channel, number):
    return (Traffic(channel, ALICE, (number,), 5, 50, 1, 2),)


def odd(kind):
    return replace(GOOD, oddities=(Oddity(kind, "/a", "/talker", "it is odd", 3),))


COMMANDED = Endpoint(
    *("/r/cmd_vel", Role.SUBSCRIBER, ("geometry_msgs/Twist",), (), "drive"),
    messages=1,
    last_time=NOW - 5 * SECOND,
)
ODOMETRY = Endpoint("/r/odom", Role.SUBSCRIBER, ("nav_msgs/Odometry",))
ROBOT = Node(
    *("/robot", "r", "here", 10, NOW - 100 * SECOND, "run robot"),
    endpoints=(
        COMMANDED,
        TAKES._replace(group="drive"),
        ODOMETRY._replace(role=Role.PUBLISHER),
    ),
    sent=NOW,
)
SLOWED = replace(
    graph(TALKER._replace(endpoints=(OLDER._replace(messages=9910, last_time=NOW),)), EAR),
    before=Graph((TALKER._replace(endpoints=(OLDER,)), EAR)),
)
BUSY = having(EAR, messages=10, calls=10, busy=SECOND, last_time=SECOND)
EVIDENCE = {
    "bandwidth": replace(GOOD, streams=(replace(EVEN, bytes=90_000_000),)),
    "bus": replace(EMPTY, bus_problem="no route", bus_remedy="type: sudo ip route add x"),
    "callback-errors": graph(
        TALKER._replace(errors=(CallbackError("/x", "KeyError", "'a'", "my.py:3", 2, NOW),)), EAR
    ),
    "clocks": replace(GOOD, clocks=(HostClock("h", "10.0.0.2", -3, ("/far",)),)),
    "competing-publishers": replace(
        GOOD, streams=(EVEN, replace(EVEN, sender=BOB, name="bob", pid=3))
    ),
    "container": host(container="WSL"),
    "covariances": odd("covariance"),
    "damaged-log": replace(GOOD, url="file:///ride.lcmlog", damaged_bytes=449),
    "doubled": replace(GOOD, streams=(replace(EVEN, doubled=20),)),
    "driven-by-nobody": replace(
        graph(TALKER, EAR._replace(endpoints=(TAKES, ODOMETRY)), ROBOT),
        oddities=(Oddity("drives", "/r/odom", "/robot", "drives at 0.50 m/s, 0.00 rad/s", 9),),
    ),
    "duplicate-names": graph(TALKER, TALKER._replace(id="u", pid=9), EAR),
    "environment": host(environment=("PYTHONPATH has /x, which does not exist",)),
    "firewall": host(firewall="ufw"),
    "frames": replace(
        GOOD,
        frames=(FrameParent("/", "base", "odom", "/a"), FrameParent("/", "base", "map", "/b")),
    ),
    "igmp-querier": host(bridge="br0"),
    "incomplete-messages": graph(TALKER, having(EAR, incomplete=2)),
    "interfaces": replace(host(joined=("wlan0",)), listeners=(Listener("l", 1, 0, is_node=True),)),
    "irregular": replace(GOOD, streams=(GAP,)),
    "full-line": replace(
        graph(TALKER._replace(full_lines=(FullLine("10.0.0.2", 9, (("/a", 5.0),)),)), EAR),
        before=Graph((EAR,), time=NOW - SECOND),
    ),
    "kernel-drops": replace(GOOD, listeners=(Listener("l", 1, 0, drops=5, is_node=True),)),
    "large-messages": host(large_bytes=300_000, large_problem="part 1 is lost"),
    "link": host(has_link=False),
    "logged": replace(GOOD, logs=(LogLine("/talker", "warning", "odd", 2),)),
    "loopback-route": host(interface="lo", joined=("lo",)),
    "loss": replace(GOOD, senders=(SenderFacts(ALICE, "alice", messages=90, lost=10, ttl=1),)),
    "malformed": replace(GOOD, malformed=(("10.0.0.1:4000", "starts with b'{'"),)),
    "mpudpm": replace(GOOD, processes=(LcmProcess(8, "pub", "", "LCM_DEFAULT_URL=mpudpm://"),)),
    "names": replace(GOOD, streams=(Stream("/map[0]", ALICE, "alice", (1,)),)),
    "no-clock": graph(
        TALKER,
        EAR,
        EAR._replace(
            id="c",
            name="/c",
            endpoints=(Endpoint("/clock", Role.SUBSCRIBER, ("rosgraph_msgs/Clock",), (3,)),),
        ),
    ),
    "no-traffic": EMPTY,
    "not-finite": odd("not-finite"),
    "relay-bus": replace(GOOD, relays=(RelayEnd("/relay", "here", "tcpq://office", "is lost"),)),
    "relay-losses": replace(GOOD, relays=(RelayEnd("/relay", "here", "tcpq://office", dropped=3),)),
    "relay-commands": replace(
        GOOD, relays=(RelayEnd("/relay", "here", "tcpq://office", commands=("/a",)),)
    ),
    "relay-standby": replace(GOOD, relays=(RelayEnd("/relay", "here", "0", stands_by=True),)),
    "open-files": replace(GOOD, processes=(LcmProcess(9, "leak", open_files=950),)),
    "other-buses": replace(EMPTY, processes=(LcmProcess(9, "t", "239.255.76.67:7670"),)),
    "other-version": graph(*(one._replace(version=VERSION + 1) for one in (TALKER, EAR))),
    "other-users": replace(GOOD, listeners=(Listener("?", 5, 4711, is_node=True),)),
    "quaternions": odd("quaternion"),
    "queue-drops": graph(TALKER, having(EAR, drops=20)),
    "reassembly": host(reassembly_failures=3),
    "rp-filter": host(rp_filter=1, others=("wlan0",)),
    "sending": host(send_problem="sending is forbidden", send_remedy="type: sudo ufw allow out"),
    "services": graph(*(server(one) for one in (TALKER, EAR))),
    "silent": replace(GOOD, processes=(LcmProcess(9, "talker", state="T"),)),
    "slow-callbacks": graph(TALKER, BUSY._replace(busy=SECOND)),
    "slow-rate": SLOWED,
    "slow-simulator": replace(GOOD, clock=SimulatedClock("/sim", 0.5, busy=0.99)),
    "refused-filters": replace(GOOD, listeners=(Listener("/ear", 8, 1000, is_unfiltered=True),)),
    "small-buffer": replace(
        GOOD,
        streams=(replace(EVEN, largest=300_000),),
        listeners=(Listener("l", 1, 0, buffer_bytes=200_000, is_node=True),),
    ),
    "stale-nodes": graph(TALKER, EAR, TALKER._replace(id="u", name="/s", stale=Staleness.HANGS)),
    "stamps": odd("future"),
    "stuck-listeners": replace(GOOD, listeners=(Listener("l", 1, 0, state="T", is_node=True),)),
    "ttl": replace(GOOD, senders=(SenderFacts(ALICE, "alice", ttl=7),)),
    "type-mismatch": graph(
        TALKER, EAR, traffic=sent("/a", fingerprint(message_class("geometry_msgs/Twist")))
    ),
    "unconnected-publications": graph(TALKER),
    "unconnected-subscriptions": graph(EAR),
    "undecodable": odd("undecodable"),
    "unknown-type": graph(TALKER, EAR, traffic=sent("/p", OLD_POSE)),
}


def test_there_is_evidence_for_every_rule():
    assert set(EVIDENCE) == {rule.id for rule in RULES}
    assert judge(GOOD) == []


@pytest.mark.parametrize("rule", EVIDENCE)
def test_a_fault_is_found_and_nothing_else(rule):
    (found,) = judge(EVIDENCE[rule])
    assert found.rule == rule
    assert found.finding.subjects() or found.finding.facts or found.finding.title.parts
    is_note = found.severity is Severity.NOTE
    assert found.remedies or is_note
    typed = [command for remedy in found.finding.remedies for command in commands(remedy)]
    assert all(command in "\n".join(found.remedies) for command in typed)


@pytest.mark.parametrize("table", ["titles", "facts", "remedies"])
def test_a_kind_has_one_sentence_in_all_rules(table):
    sentences = {}
    for one in RULES:
        for kind, sentence in getattr(one, table).items():
            assert sentences.setdefault(kind, sentence) == sentence


def test_a_rule_has_its_sentences_beside_it():
    @rule(
        "too-hot",
        remedy="cool it",
        title="{count:times} too hot:",
        facts={"hot": "{sender} at {degrees:.1f}"},
        remedies={"cool": "cool it: `lcmtools cool {sender}`"},
        evidence="temperatures",
        severity=Severity.NOTE,
    )
    def temperatures_are_low(evidence):
        """Temperatures are low. Otherwise it is hot."""
        facts = [state("hot", sender=one.name, degrees=50.04) for one in evidence.senders]
        title = state("too-hot", count=len(facts))
        yield from finding(title, facts, *(state("cool", **fact.parts) for fact in facts))

    (hot,) = temperatures_are_low.examine(replace(GOOD, senders=(SenderFacts(ALICE, "alice"),)))
    assert report.finding_text(hot) == [
        "NOTE once too hot:",
        " * alice at 50.0",
        "   -> cool it: lcmtools cool alice",
    ]
    assert commands(hot.remedies[0]) == ["lcmtools cool alice"]
    assert temperatures_are_low.summary == "Temperatures are low"
