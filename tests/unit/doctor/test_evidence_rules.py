"""The rules of wtf that judge traffic, listeners and contents: planted faults."""

import os
import threading
import time
from dataclasses import replace

import pytest
from fixtures.judging import (
    ALICE,
    BOB,
    HEALTHY,
    NOW,
    SECOND,
    SOMEBODY,
    found,
    judge,
    only,
    stream,
)

from lcmtools.doctor import report
from lcmtools.doctor.evidence import (
    LcmProcess,
    Listener,
    Oddity,
    SenderFacts,
    SimulatedClock,
    Stream,
)
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.lcm_processes import processor_times
from lcmtools.doctor.rules import RULES
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Traffic
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.messages.type_versions import fingerprint_of


def test_a_healthy_bus_is_no_finding():
    streams = (stream("A", 100), stream("B", 1, 5))
    senders = (SenderFacts(ALICE, "alice", messages=100, ttl=0, uid=1000),)
    listeners = (Listener("bob (pid 2)", 2, 1000, queued_bytes=800, buffer_bytes=212992),)
    clock = SimulatedClock("/morse", 0.99, busy=0.4)
    evidence = replace(HEALTHY, streams=streams, senders=senders, listeners=listeners, clock=clock)
    assert found(evidence) == {}


def test_rules_have_ids_explanations_and_remedies():
    assert len({rule.id for rule in RULES}) == len(RULES)
    for rule in RULES:
        assert rule.explanation.endswith((".", ")")), rule.id
        assert rule.remedy, rule.id
        assert rule.summary, rule.id


def test_loss_says_whose_how_much_and_where():
    senders = (
        SenderFacts(ALICE, "/talker", messages=90, lost=10),
        SenderFacts(BOB, "/camera", is_local=False, messages=50, lost=50),
        SenderFacts(BOB, "/fine", messages=50),
    )
    finding = only(replace(HEALTHY, senders=senders))
    assert (finding.rule, finding.severity) == ("loss", Severity.WARNING)
    assert finding.items == (
        " * /camera (10.0.0.2:5000): 50 of 100 (50.0 %) on the network",
        " * /talker (10.0.0.1:4000): 10 of 100 (10.0 %) before they left it",
    )


def test_what_wtf_itself_lost_is_not_blamed_on_senders():
    senders = (SenderFacts(ALICE, "/talker", messages=90, lost=10),)
    assert found(replace(HEALTHY, senders=senders, own_drops=10)) == {}


def test_kernel_drops_name_the_slow_program_and_its_buffer():
    slow = Listener("slow.py (pid 7)", 7, 1000, drops=5, buffer_bytes=212992)
    tool = Listener("lcmtools list (pid 8)", 8, 1000, drops=500, is_tool=True)
    host = replace(HEALTHY.host, most_receive_buffer=212992)
    finding = only(replace(HEALTHY, listeners=(slow, tool), host=host))
    assert finding.rule == "kernel-drops"
    assert finding.items == (" * slow.py (pid 7): 5, its receive buffer holds 212992 bytes",)
    assert finding.remedies == (
        ("start it with LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304'"),
        "sudo sysctl -w net.core.rmem_max=8388608",
    )


def test_a_stopped_listener_is_named_with_what_wakes_it():
    stopped = Listener("sink (pid 7)", 7, 1000, drops=5, queued_bytes=200_000, state="T")
    finding = only(replace(HEALTHY, listeners=(stopped,)))
    assert finding.rule == "stuck-listeners"
    assert finding.items == (" * sink (pid 7): it is stopped",)
    assert finding.remedies == ("wake it (kill -CONT 7) or end it (kill -KILL 7)",)


def test_a_listener_that_does_not_read_is_named():
    full = Listener("s (pid 7)", 7, 0, drops=5, queued_bytes=9000, was_queued_bytes=9000)
    assert found(replace(HEALTHY, listeners=(full,)))["stuck-listeners"].items == (
        " * s (pid 7): 9000 bytes are waiting",
    )


@pytest.mark.parametrize(
    ("drops", "queued", "rule"),
    [(70, 9000, "kernel-drops"), (95, 9000, "stuck-listeners"), (30, 20_000, "stuck-listeners")],
)
def test_a_listener_that_reads_slowly_does_not_drop_all(drops, queued, rule):
    full = Listener("s (pid 7)", 7, 0, drops, queued, was_queued_bytes=9000, buffer_bytes=20_000)
    sender = SenderFacts(ALICE, "alice", messages=100, ttl=0)
    assert only(replace(HEALTHY, listeners=(full,), senders=(sender,))).rule == rule


@pytest.mark.parametrize(
    ("interpreter", "tool"), [("python3.11", "py-spy"), ("java", "jstack"), ("", "gdb")]
)
def test_what_shows_where_a_program_waits_is_of_its_language(interpreter, tool):
    waiting = {"queued_bytes": 9000, "was_queued_bytes": 9000}
    full = Listener("d (pid 7)", 7, 0, drops=5, interpreter=interpreter, **waiting)
    evidence = replace(HEALTHY, listeners=(full,))
    remedies = " ".join(found(evidence)["stuck-listeners"].remedies)
    assert [one for one in ("py-spy", "jstack", "gdb") if one in remedies] == [tool]


def test_a_message_larger_than_a_buffer_is_told_before_it_is_lost():
    streams = (stream("CAM", 10, name="cam (pid 3)", largest=300_000),)
    listeners = (
        Listener("small (pid 7)", 7, 1000, buffer_bytes=212_992),
        Listener("large (pid 8)", 8, 1000, buffer_bytes=4_000_000),
    )
    evidence = replace(HEALTHY, streams=streams, listeners=listeners)
    finding = only(evidence)
    assert finding.rule == "small-buffer"
    assert (
        finding.text
        == "'CAM' from cam (pid 3) has 300000 bytes, too many for the receive buffers of:"
    )
    assert finding.items == (" * small (pid 7): holds 212992 bytes",)
    assert finding.remedies[0].endswith("&recv_buf_size=600000'")
    paced = (SenderFacts(ALICE, "cam", paces=True),)
    assert found(replace(evidence, senders=paced)) == {}


@pytest.mark.parametrize(
    ("kind", "rule"),
    [
        ("not-finite", "not-finite"),
        ("quaternion", "quaternions"),
        ("covariance", "covariances"),
        ("future", "stamps"),
        ("old", "stamps"),
        ("undecodable", "undecodable"),
    ],
)
def test_odd_contents_are_told_with_topic_sender_and_field(kind, rule):
    finding = only(replace(HEALTHY, oddities=(Oddity(kind, "/odom", "/morse", "it is odd", 7),)))
    assert (finding.rule, finding.severity) == (rule, Severity.WARNING)
    assert finding.items == (" * /odom from /morse: it is odd (7 messages)",)
    assert finding.remedies


@pytest.mark.parametrize(
    ("kind", "there", "here"),
    [
        ("future", "synchronize both computers' clocks", "stamp with the time since 1970"),
        ("old", "synchronize both computers' clocks", "stamp with the time since 1970"),
        ("replayed", "if it is not a log, its computer's clock", "if it is not a log, stamp with"),
    ],
)
def test_the_clock_of_this_computer_is_no_reason_for_its_stamps(kind, there, here):
    odd = (Oddity(kind, "/odom", "/morse", "it is odd", 7),)
    for is_local, remedy in ((False, there), (True, here)):
        senders = (SenderFacts(ALICE, "/morse", is_local=is_local),)
        finding = found(replace(HEALTHY, oddities=odd, senders=senders))["stamps"]
        assert finding.remedies[0].startswith(remedy)
    of_lcm = (replace(odd[0], text="utime is odd"),)
    remedies = found(replace(HEALTHY, oddities=of_lcm, senders=senders))["stamps"].remedies
    assert remedies[0].startswith(here if kind == "replayed" else "message.utime = time.time_ns()")
    log = replace(HEALTHY, url="file:///ride.lcmlog", oddities=odd, senders=senders)
    assert found(log)["stamps"].remedies[0].startswith(there)


def test_one_old_message_may_be_a_latched_one():
    odd = Oddity("old", "/map", "/server", "header.stamp is 60.0 s old")
    assert found(replace(HEALTHY, oddities=(odd,))) == {}


def test_two_programs_that_send_at_once_compete():
    streams = (stream("/cmd", 10), stream("/cmd", 10, sender=BOB, name="bob"))
    finding = only(replace(HEALTHY, streams=streams))
    assert finding.rule == "competing-publishers"
    assert finding.text == "2 programs publish on /cmd at the same time:"
    assert finding.items == (" * alice: /cmd", " * bob: /cmd")
    ended = replace(streams[1], has_ended=True)
    assert found(replace(HEALTHY, streams=(streams[0], ended))) == {}


def test_a_node_that_competes_gets_the_remap_that_works_in_place_of_the_one_it_has():
    command = "lcmtools run simple_controller out:=cmd"
    ends = (Endpoint("/cmd", Role.PUBLISHER),)
    node = Node("/pilot", "p", "h", 8, sender=BOB, endpoints=ends, command=command)
    streams = (stream("/cmd", 10), stream("/cmd", 10, sender=BOB, name="/pilot"))
    graph = HEALTHY.graph._replace(nodes=(node,))
    finding = found(replace(HEALTHY, streams=streams, graph=graph))["competing-publishers"]
    assert finding.remedies == ("end one of them, or start /pilot with out:=/cmd_2",)


def test_a_program_that_repeats_what_it_receives_may_make_a_circle():
    repeater = replace(stream("/a", 10, sender=BOB, name="bob"), repeated=9)
    finding = only(replace(HEALTHY, streams=(stream("/a", 10), repeater)))
    assert finding.items[1] == " * bob: /a, 9 messages that another sender had sent before"
    assert finding.remedies[0].startswith("a program that forwards what it receives creates a loop")


def test_two_simulators_make_no_circle_and_no_remap_parts_them():
    node = Node("/b", "b", "h", 8, sender=BOB, endpoints=(Endpoint("/clock", Role.PUBLISHER),))
    again = replace(stream("/clock", 10, sender=BOB, name="/b"), repeated=9)
    graph = HEALTHY.graph._replace(nodes=(node,))
    finding = found(replace(HEALTHY, streams=(stream("/clock", 10), again), graph=graph))[
        "competing-publishers"
    ]
    assert finding.items == (" * alice: /clock", " * /b: /clock")
    assert finding.remedies == ("end one of them, or start /b on another bus, with --domain 1",)


@pytest.mark.parametrize("messages", [0, 1])
def test_a_command_that_has_sent_and_still_runs_competes(messages):
    ends = (Endpoint("/cmd", Role.PUBLISHER, messages=messages),)
    pub = Node("/_pub", "p", "h", 8, sender=BOB, endpoints=ends, tool=True)
    evidence = replace(
        HEALTHY, streams=(stream("/cmd", 10),), graph=HEALTHY.graph._replace(nodes=(pub,))
    )
    findings = found(evidence)
    assert ("competing-publishers" in findings) is bool(messages)
    if messages:
        assert findings["competing-publishers"].items == (" * alice: /cmd", " * /_pub: /cmd")


def test_alternatives_of_one_input_are_one_topic():
    ends = tuple(Endpoint(name, Role.SUBSCRIBER, group="g") for name in ("/a", "/b"))
    robot = Node("/morse", "1", "h", 1, endpoints=ends)
    streams = (stream("/a", 10), stream("/b", 10, sender=BOB, name="bob"))
    graph = HEALTHY.graph._replace(
        nodes=(robot,), traffic=(Traffic("/a", ALICE, (), 1, 8, NOW, NOW),)
    )
    assert "competing-publishers" in found(replace(HEALTHY, streams=streams, graph=graph))


@pytest.mark.parametrize("name", ["/tf", "/rosout", "/_hidden"])
def test_some_topics_are_for_many(name):
    streams = (stream(name, 10), stream(name, 10, sender=BOB, name="bob"))
    assert found(replace(HEALTHY, streams=streams)) == {}


def test_one_node_with_two_ports_does_not_compete_with_itself():
    streams = (stream("/image", 10), stream("/image", 10, sender=BOB))
    assert found(replace(HEALTHY, streams=streams)) == {}


def _graphs(before, after):
    hears = Node("/ear", "2", "h", 2, endpoints=(Endpoint("/a", Role.SUBSCRIBER),))
    start = NOW - 100 * SECOND
    nodes = [Node("/mouth", "1", "h", 1, start, endpoints=(e,)) for e in (before, after)]
    graphs = [Graph((node, hears), time=NOW) for node in nodes]
    return replace(HEALTHY, before=graphs[0], graph=graphs[1])


def test_a_publisher_that_has_gone_silent_is_a_note():
    silent = Endpoint("/a", Role.PUBLISHER, messages=500, last_time=NOW - 50 * SECOND)
    finding = only(_graphs(silent, silent))
    assert (finding.rule, finding.severity) == ("silent", Severity.NOTE)
    assert finding.items == (" * /mouth: /a, the last of 500 messages 50 s ago",)


def test_a_stream_that_ends_while_wtf_listens_is_a_note():
    ended = stream("A", 20, 20)
    later = HEALTHY.graph._replace(time=NOW + SECOND)
    assert found(replace(HEALTHY, streams=(ended,), graph=later))["silent"].items == (
        " * alice: 'A', 1.0 s ago, 20 Hz before",
    )


def test_a_rate_that_has_fallen_is_a_note():
    before = Endpoint("/a", Role.PUBLISHER, messages=9900, last_time=NOW - SECOND)
    after = before._replace(messages=9910, last_time=NOW)
    finding = only(_graphs(before, after))
    assert finding.rule == "slow-rate"
    assert finding.items == (" * /mouth: /a, 10 Hz instead of 100 Hz",)


def test_a_stream_with_a_gap_is_irregular():
    even = stream("A", 50, 50)
    uneven = replace(even, times=(*(t - SECOND for t in even.times[:25]), *even.times[25:]))
    finding = only(replace(HEALTHY, streams=(uneven,)))
    assert finding.rule == "irregular"
    assert finding.items == (" * alice: 'A', 1.02 s without a message, usually 20 ms",)


def test_bursts_are_not_irregular():
    times = tuple(NOW - pause * 300_000_000 + n for pause in (3, 2, 1) for n in range(30))
    assert found(replace(HEALTHY, streams=(stream("A", 1, times=times),))) == {}
    assert found(replace(HEALTHY, streams=(stream("A", 1, times=times[30:]),))) == {}


def test_a_full_queue_names_node_topic_and_depth():
    def graph(drops, depth):
        slow = Endpoint("/a", Role.SUBSCRIBER, depth=depth, drops=drops)
        mouth = Node("/mouth", "1", "h", 1, endpoints=(Endpoint("/a", Role.PUBLISHER),))
        return Graph((mouth, Node("/ear", "2", "h", 2, endpoints=(slow,))), time=NOW)

    evidence = replace(HEALTHY, before=graph(5, 10), graph=graph(25, 10))
    finding = only(evidence)
    assert finding.rule == "queue-drops"
    assert finding.items == (" * /ear lost 20 messages of /a (depth 10)",)
    assert found(replace(HEALTHY, before=graph(5, 1), graph=graph(25, 1))) == {}
    assert found(replace(HEALTHY, before=graph(25, 10), graph=graph(25, 10))) == {}


@pytest.mark.parametrize(
    ("clock", "severity"),
    [
        (SimulatedClock("/morse", 0.5, busy=0.99), Severity.WARNING),
        (SimulatedClock("/morse", 0.5, busy=0.3), Severity.NOTE),
        (SimulatedClock("/morse", 0.5, target=0.5), None),
        (SimulatedClock("/morse", 3.0, target=4.0, busy=1.0), Severity.WARNING),
        (SimulatedClock("/morse", 40.0, target=None, busy=1.0), None),
        (SimulatedClock("/morse", 0.0, busy=0.1), Severity.NOTE),
        (SimulatedClock("/morse", None, jumps=1), Severity.NOTE),
        (SimulatedClock("/morse", None, jumps=9), Severity.WARNING),
    ],
)
def test_a_simulator_that_is_too_slow_stands_still_or_jumps_back(clock, severity):
    finding = found(replace(HEALTHY, clock=clock)).get("slow-simulator")
    assert (finding.severity if finding else None) is severity


def test_names_that_few_can_use_and_names_that_look_alike():
    streams = (stream("\udcff", 1, 3), stream("POSE", 1, 3), stream("Pose", 1, 3))
    findings = [f for f in judge(replace(HEALTHY, streams=streams)) if f.rule == "names"]
    assert [finding.severity for finding in findings] == [Severity.WARNING, Severity.NOTE]
    assert findings[1].items == (" * 'POSE' from alice, and 'Pose' from alice",)
    streams = (stream("/pose", 1, 3), stream("/pose ", 1, 3))
    (*_, alike) = (f for f in judge(replace(HEALTHY, streams=streams)) if f.rule == "names")
    assert alike.items == (" * '/pose' from alice, and '/pose ' from alice",)
    long = found(replace(HEALTHY, streams=(stream("a" * 61, 1, 3),)))["names"]
    assert long.severity is Severity.NOTE


def test_numbered_names_do_not_look_alike():
    streams = (stream("/husky0/odom", 1, 3), stream("/husky1/odom", 1, 3))
    assert found(replace(HEALTHY, streams=streams)) == {}


def test_a_program_that_has_nothing_to_send_makes_an_empty_bus_a_note():
    empty = replace(HEALTHY, graph=Graph())
    assert only(empty).severity is Severity.WARNING
    finding = only(replace(empty, processes=(LcmProcess(7, "beacon"),)))
    assert (finding.rule, finding.severity) == ("no-traffic", Severity.NOTE)
    assert finding.items == (" * beacon (pid 7) uses LCM, and may publish rarely",)


def test_what_a_program_may_publish_seldom_is_unconnected_as_a_note():
    ear = Node("/ear", "2", "h", 2, endpoints=(Endpoint("/a", Role.SUBSCRIBER),))
    evidence = replace(HEALTHY, graph=Graph((ear,)))
    assert only(evidence).severity is Severity.WARNING
    note = only(replace(evidence, processes=(LcmProcess(7, "beacon"),)))
    assert (note.rule, note.severity) == ("unconnected-subscriptions", Severity.NOTE)
    assert note.items[-1] == " * beacon (pid 7) uses LCM, and may publish rarely"
    for other in (LcmProcess(2, "ear"), LcmProcess(7, "b", "x:1")):
        processes = replace(evidence, processes=(other,))
        assert found(processes)["unconnected-subscriptions"].severity is Severity.WARNING


def test_a_simulator_that_is_paused_is_a_note_and_excuses_who_waits_for_it():
    clock = Endpoint("/clock", Role.PUBLISHER, messages=9, last_time=NOW - 9 * SECOND)
    scan = clock._replace(topic="/scan")
    ends = (clock, scan, Endpoint("/sim/set_rate", Role.SERVICE))
    sim = Node("/sim", "s", "h", 1, endpoints=ends)
    out = Endpoint("/a", Role.PUBLISHER, messages=500, last_time=NOW - 50 * SECOND)
    waits = (out, Endpoint("/scan", Role.SUBSCRIBER))
    driver = Node("/driver", "d", "h", 2, NOW - 100 * SECOND, endpoints=waits, sent=NOW)
    ear = Node("/ear", "e", "h", 3, endpoints=(Endpoint("/a", Role.SUBSCRIBER),))
    evidence = replace(HEALTHY, graph=Graph((sim, driver, ear), time=NOW))
    note = only(evidence)
    assert (note.rule, note.severity) == ("slow-simulator", Severity.NOTE)
    assert (note.text, note.items) == ("Simulated time stands still:", (" * /sim",))
    assert note.remedies == ("if that was not intended: lcmtools sim resume",)
    tick = Stream("/clock", ALICE, "/sim", (NOW,))
    assert found(replace(evidence, streams=(tick,))).keys() == {"silent"}
    ticked = sim._replace(endpoints=(clock._replace(last_time=NOW), scan, ends[2]))
    missed = replace(evidence, graph=Graph((ticked, driver, ear), time=NOW), own_drops=99)
    assert found(missed) == {}, "wtf has missed the ticks"


def test_an_unknown_type_is_compared_with_what_others_send_on_the_channel():
    pose = message_class("geometry_msgs/Pose2D")
    traffic = tuple(
        Traffic("A", sender, (number,), 5, 50, 1, 2)
        for sender, number in ((ALICE, fingerprint(pose)), (BOB, fingerprint_of(fields(pose)[:2])))
    )
    finding = only(replace(HEALTHY, graph=Graph(traffic=traffic)))
    assert finding.items[1].endswith("like geometry_msgs/Pose2D, but without the field theta)")


def test_a_stray_byte_in_a_channel_is_shown_as_what_it_is():
    finding = only(replace(HEALTHY, streams=(stream("caf\udce9", 10),)))
    assert finding.items[0].startswith(" * 'caf\\xe9' from alice: it is not UTF-8")
    sent = tuple(Traffic("caf\udce9", ALICE, (number,), 5, 50, 1, 2) for number in (5, 6))
    finding = only(replace(HEALTHY, graph=Graph(traffic=sent)))
    assert finding.text == "The types on 'caf\\xe9' do not match:"


def test_a_subscription_that_was_fed_of_late_is_connected():
    ear = Endpoint("/a", Role.SUBSCRIBER, messages=10, last_time=NOW - 4 * SECOND, calls=10)
    graph = Graph((Node("/ear", "2", "h", 2, NOW - 54 * SECOND, endpoints=(ear,)),), SOMEBODY, NOW)
    assert found(replace(HEALTHY, graph=graph)) == {}
    later = graph._replace(time=NOW + 60 * SECOND)
    assert "unconnected-subscriptions" in found(replace(HEALTHY, graph=later))


def test_a_few_messages_come_from_a_publisher_only_beside_programs_that_are_no_nodes():
    """Else it was ``pub -1``, typed twice."""
    ear = Endpoint("/a", Role.SUBSCRIBER, messages=2, last_time=NOW - 4 * SECOND)
    graph = Graph((Node("/ear", "2", "h", 2, NOW - 14 * SECOND, endpoints=(ear,)),), SOMEBODY, NOW)
    evidence = replace(HEALTHY, graph=graph, processes=(LcmProcess(2, "ear"),))
    assert "unconnected-subscriptions" in found(evidence)
    beside = (*evidence.processes, LcmProcess(7, "beacon"))
    assert found(replace(evidence, processes=beside)) == {}
    elsewhere = (*evidence.processes, LcmProcess(7, "beacon", "239.255.76.67:7670"))
    assert "unconnected-subscriptions" in found(replace(evidence, processes=elsewhere))


def test_what_a_nodes_filter_drops_is_no_slowness():
    node = Listener("/listener (pid 7)", 7, 1000, drops=5, is_node=True)
    evidence = replace(HEALTHY, listeners=(node,))
    assert only(evidence).rule == "kernel-drops"
    assert only(replace(evidence, malformed=(("x", "bad"),))).rule == "malformed"


def test_a_stream_that_nobody_has_subscribed_to_may_rest():
    def rules(*nodes):
        times = tuple(NOW - (9 if n < 50 else 7) * SECOND + n * 5_000_000 for n in range(100))
        resting = stream("/imu", 1, times=times)
        return found(replace(HEALTHY, streams=(resting,), graph=Graph(nodes, time=NOW)))

    simulator = Node("/sim", "1", "h", 1, endpoints=(Endpoint("/imu", Role.PUBLISHER),))
    ear = Node("/ear", "2", "h", 2, endpoints=(Endpoint("/imu", Role.SUBSCRIBER),))
    assert {"silent", "irregular"} <= rules(simulator, ear).keys()
    assert {"silent", "irregular"} <= rules().keys()  # a plain program's
    assert not {"silent", "irregular"} & rules(simulator).keys()
    assert not {"silent", "irregular"} & rules(simulator, ear._replace(tool=True)).keys()


def test_a_long_list_ends_with_the_number_of_the_others():
    oddities = tuple(Oddity("not-finite", f"/t{n}", "/n", "x is nan", 1) for n in range(40))
    finding = only(replace(HEALTHY, oddities=oddities))
    rows = [row for row in report.finding_text(finding.finding) if row.startswith(" *")]
    assert len(finding.items) == 40
    assert len(rows) == 24
    assert rows[-1] == " * … and 17 more"


def test_busy_time_is_that_of_all_threads():
    before, _ = processor_times(os.getpid())
    begun, ends = threading.Event(), threading.Event()

    def compute():
        while time.thread_time_ns() < 50_000_000:
            pass
        begun.set()
        ends.wait()

    thread = threading.Thread(target=compute)
    thread.start()
    begun.wait()
    after, _ = processor_times(os.getpid())
    ends.set()
    thread.join()
    assert after - before >= 50_000_000
