"""Whole systems as evidence: one fault is one finding, a healthy system none, and wtf --watch."""

from dataclasses import replace
from itertools import islice

import pytest
from fixtures.judging import STEP, in_words, judge

from lcmtools.doctor import report
from lcmtools.doctor.evidence import Evidence, Host, Listener, SenderFacts, SimulatedClock, Stream
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import RULES
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Traffic
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.wire.packet import Sender

SECOND = 1_000_000_000
NOW = 1_000_000 * SECOND
STRING, TWIST, JOINTS = "std_msgs/String", "geometry_msgs/Twist", "sensor_msgs/JointState"
EVEN = tuple(NOW - n * SECOND // 50 for n in range(50, 0, -1))  # arrivals at 50 Hz


def number(name):
    return fingerprint(message_class(name))


def endpoint(topic, role, *types, group=""):
    depth = 10 if role is Role.SUBSCRIBER else 0
    return Endpoint(topic, role, types, tuple(map(number, types)), group, depth)


def pub(topic, *types):
    return endpoint(topic, Role.PUBLISHER, *types)


def sub(topic, *types, group=""):
    return endpoint(topic, Role.SUBSCRIBER, *types, group=group)


def node(name, pid, *endpoints, tool=False):
    sender = Sender("127.0.0.1", 40_000 + pid)
    start = NOW - 100 * SECOND
    return Node(name, f"i{pid}", "here", pid, start, tool=tool, endpoints=endpoints, sender=sender)


def simulator(pid, *robots, name="/morse"):
    """The simulator with these robots, as the Husky lab has it."""
    ends = [pub("/clock", "rosgraph_msgs/Clock"), STEP._replace(topic=f"{name}/step")]
    for robot in robots:
        ends += [pub(f"{robot}/odometry", "nav_msgs/Odometry"), pub(f"{robot}/pose", STRING)]
        inputs = ("velocity_cmd", "wheel_cmd", "cmd_vel")
        ends += [sub(f"{robot}/{i}", JOINTS, TWIST, group=f"wheels of {robot}") for i in inputs]
    return node(name, pid, *ends)


def controller(pid, robot):
    return node(
        f"{robot}/simple_controller",
        pid,
        sub(f"{robot}/odometry", "nav_msgs/Odometry"),
        sub(f"{robot}/desired_velocity", TWIST),
        pub(f"{robot}/velocity_cmd", JOINTS),
    )


def pilot(pid, topic):
    return node(f"/_lcmtools_pub_{pid}", pid, pub(topic, TWIST), tool=True)


def system(*nodes):
    """These nodes, each of which sends on all its topics during the look."""
    sending = [(n, e.topic) for n in nodes for e in n.having(Role.PUBLISHER)]
    prints = {(n.id, e.topic): e.fingerprints[:1] for n in nodes for e in n.endpoints}
    streams = tuple(Stream(t, n.sender, n.name, EVEN, 100, 5000, pid=n.pid) for n, t in sending)
    traffic = tuple(
        Traffic(t, n.sender or Sender("", 0), prints[n.id, t], 50, 5000, NOW - SECOND, NOW)
        for n, t in sending
    )
    graph = Graph(nodes, traffic, NOW)
    simulates = any(topic == "/clock" for _, topic in sending)
    return Evidence(
        "udpm://239.255.76.67:7667?ttl=0",
        graph=graph,
        before=graph._replace(time=NOW - SECOND),
        listened=1.0,
        senders=tuple(
            SenderFacts(n.sender, n.name, messages=50, ttl=0, uid=1000, paces=True)
            for n in nodes
            if n.sender
        ),
        streams=streams,
        listeners=tuple(Listener(n.name, n.pid, 1000, is_node=True) for n in nodes if not n.tool),
        clock=SimulatedClock("/morse", 1.0) if simulates else None,
        host=Host(uid=1000, interface="lo", joined=("lo",)),
    )


HUSKIES = tuple(f"/husky{n}" for n in range(3))
HEALTHY = {
    "three Huskies": (
        simulator(1, *HUSKIES),
        *(controller(10 + n, robot) for n, robot in enumerate(HUSKIES)),
        *(pilot(20 + n, f"{robot}/desired_velocity") for n, robot in enumerate(HUSKIES)),
    ),
    "an empty world": (simulator(1),),
    "talkers in namespaces": (
        node("/a/talker", 1, pub("/a/chatter", STRING)),
        node("/a/listener", 2, sub("/a/chatter", STRING)),
        node("/b/talker", 3, pub("/b/chatter", STRING)),
        node("/b/listener", 4, sub("/b/chatter", STRING)),
    ),
    "a service and its client": (
        node("/server", 1, endpoint("/set", Role.SERVICE, STRING, STRING)),
        node("/client", 2, endpoint("/set", Role.CLIENT, STRING, STRING)),
    ),
}


@pytest.mark.parametrize("name", HEALTHY)
def test_a_healthy_system_is_no_finding(name):
    assert judge(system(*HEALTHY[name])) == []


def test_two_simulators_of_one_robot_are_one_finding():
    sims = (simulator(1, "/husky0"), simulator(2, "/husky0", name="/other"))
    echo = node("/_lcmtools_echo_4", 4, sub("/husky0/odometry"), tool=True)
    (finding,) = judge(system(*sims, pilot(3, "/husky0/velocity_cmd"), echo))
    assert finding.rule == "competing-publishers"
    assert finding.text.startswith("2 programs publish on /clock and /husky0/odometry")
    assert {" * /morse: /husky0/odometry", " * /other: /husky0/odometry"} <= set(finding.items)


def test_two_nodes_that_steer_under_one_name_are_one_finding():
    """One cause, one finding: the old process was left over."""
    steers = (node("/moving_robot", pid, pub("/husky0/cmd_vel", TWIST)) for pid in (5, 6))
    (finding,) = judge(system(simulator(1, "/husky0"), *steers))
    assert finding.rule == "duplicate-names"
    assert [item.partition(" on ")[0] for item in finding.items] == [" * pid 5", " * pid 6"]


def test_plain_programs_that_send_different_types_are_named_with_their_processes():
    facts, streams, traffic = [], [], []
    for pid, kind in ((7, TWIST), (8, STRING)):
        name = f"sends.py (pid {pid})"
        sender = Sender("127.0.0.1", 40_000 + pid)
        facts.append(SenderFacts(sender, name, messages=50, ttl=0, uid=1000))
        streams.append(Stream("A", sender, name, EVEN, 100, 5000, pid=pid))
        traffic.append(Traffic("A", sender, (number(kind),), 50, 5000, NOW - SECOND, NOW))
    graph = Graph(traffic=tuple(traffic), time=NOW)
    (finding,) = judge(replace(system(), graph=graph, streams=streams, senders=facts))
    assert finding.rule == "type-mismatch"
    assert finding.items == (
        " * sends.py (pid 7) sends geometry_msgs/Twist or geometry_msgs/Accel",
        " * sends.py (pid 8) sends std_msgs/String",
    )


def test_plain_programs_that_only_listen_make_the_empty_bus_a_note():
    listener = Listener("listens.py (pid 7)", 7, 1000)
    (finding,) = judge(replace(system(), listeners=(listener,)))
    assert (finding.rule, finding.severity) == ("no-traffic", Severity.NOTE)
    assert finding.items == (" * listens.py (pid 7) listens",)


def test_what_clears_of_a_finding_is_named():
    one, two = (node(f"/{n}", i, sub(f"/{n}", STRING)) for i, n in enumerate(("one", "two"), 1))
    talker = pilot(3, "/three")
    looks = iter([system(talker, one, two), system(talker, two)])
    _, changes = islice(report.watch(lambda: next(looks), RULES), 2)
    (_, cleared), (change, _) = changes
    assert report.change_text("cleared", cleared) == [
        "CLEARED The following node subscriptions are unconnected:",
        " * /one:",
        "   * /one",
    ]
    assert change == "changed"


def test_watch_reports_what_appears_changes_and_clears():
    one, two = (node(f"/{n}", i, sub(f"/{n}", STRING)) for i, n in enumerate(("one", "two"), 1))
    talker = pilot(3, "/three")
    grown = system(talker, one, two)
    looks = iter([system(talker, one), grown, grown, system(talker)])
    seen = [
        [(change, found.rule, in_words(found).items) for change, found in changes]
        for changes in islice(report.watch(lambda: next(looks), RULES), 4)
    ]
    rule = "unconnected-subscriptions"
    both = (" * /one:", "   * /one", " * /two:", "   * /two")
    assert seen == [
        [("appeared", rule, both[:2])],
        [("changed", rule, both)],
        [],
        [("cleared", rule, both)],
    ]
