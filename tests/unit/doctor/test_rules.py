"""The rules of wtf about nodes and their connections, on evidence made by hand."""

from dataclasses import replace

import pytest
from fixtures.judging import (
    JOINTS,
    ODOMETRY,
    SECOND,
    STEP,
    STRING,
    TWIST,
    findings,
    judge,
    node,
    pub,
    sub,
)

from lcmtools.doctor.evidence import Evidence, LcmProcess, LogLine, SenderFacts, derived
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import RULES
from lcmtools.graph.model import CallbackError, Endpoint, Graph, Node, Role, Staleness, Traffic
from lcmtools.wire.packet import Sender


def morse():
    """The simulator as the Husky lab has it."""
    command = [
        sub(f"/husky0/{name}", JOINTS, TWIST, group="wheel command")
        for name in ("velocity_cmd", "wheel_cmd", "wheel_velocity_cmd", "cmd_vel")
    ]
    return node("/morse", pub("/husky0/odometry", ODOMETRY), pub("/clock", STRING), STEP, *command)


def controller(namespace, output="controlled_velocity"):
    return node(
        f"{namespace}/simple_controller",
        sub(f"{namespace}/odometry", ODOMETRY),
        sub(f"{namespace}/desired_velocity", TWIST),
        pub(f"{namespace}/{output}", JOINTS),
    )


def test_unconnected_subscriptions_are_listed_as_roswtf_lists_them():
    finding = findings(morse(), controller(""))["unconnected-subscriptions"]
    assert finding.severity is Severity.WARNING
    assert finding.text == "The following node subscriptions are unconnected:"
    assert finding.items == (
        " * /morse:",
        "   * /husky0/velocity_cmd",
        " * /simple_controller:",
        "   * /odometry",
        "   * /desired_velocity",
    )


def test_a_topic_that_a_node_subscribes_to_twice_is_listed_once():
    listener = node("/listener", *[sub("/chatter", STRING)] * 2)
    finding = findings(listener)["unconnected-subscriptions"]
    assert finding.items == (" * /listener:", "   * /chatter")


def test_a_topic_published_in_another_namespace_suggests_that_namespace():
    finding = findings(morse(), controller(""))["unconnected-subscriptions"]
    assert (
        "/husky0/odometry is published: start /simple_controller with __ns:=/husky0"
        in finding.remedies
    )


def test_a_node_is_not_told_to_listen_to_itself():
    robot = node("/morse", sub("/cmd", JOINTS), pub("/joints", JOINTS))
    assert findings(robot)["unconnected-subscriptions"].remedies == (
        "start a publisher of /cmd; to see what is published: lcmtools list -v",
    )


def test_an_unheard_output_of_the_right_type_suggests_a_remap():
    finding = findings(morse(), controller("/husky0"))["unconnected-subscriptions"]
    assert finding.remedies == (
        (
            "/husky0/controlled_velocity of the same type has no subscriber: start"
            " /husky0/simple_controller with controlled_velocity:=velocity_cmd"
        ),
    )


@pytest.mark.parametrize("name", ["velocity_cmd", "wheel_cmd", "wheel_velocity_cmd", "cmd_vel"])
def test_one_fed_alternative_of_a_group_is_enough(name):
    command = node("/commander", pub(f"/husky0/{name}", JOINTS))
    assert "unconnected-subscriptions" not in findings(morse(), command)


def test_the_connected_lab_has_neither_warnings_nor_errors():
    pilot = node("/_lcmtools_pub_7", pub("/husky0/desired_velocity", TWIST), tool=True)
    found = findings(morse(), controller("/husky0", "velocity_cmd"), pilot)
    assert all(finding.severity is Severity.NOTE for finding in found.values())


def test_a_plain_lcm_programs_traffic_feeds_a_subscription():
    seen = Traffic("/odometry", Sender("127.0.0.1", 40000), (), 1, 8, 0, 0)
    listener = node("/listener", sub("/odometry", ODOMETRY))
    assert "unconnected-subscriptions" not in findings(listener, traffic=[seen])


def test_a_stale_publisher_feeds_nobody():
    dead = node("/talker", pub("/chatter", STRING), stale=Staleness.ENDED)
    found = findings(dead, node("/listener", sub("/chatter", STRING)))
    assert found["unconnected-subscriptions"].items == (" * /listener:", "   * /chatter")


def test_the_sensors_of_a_simulator_need_no_subscriber_but_those_of_a_played_log_do():
    ends = pub("/clock", "rosgraph_msgs/Clock"), pub("/scan", STRING)
    player = findings(node("/player", *ends))["unconnected-publications"]
    assert player.items == (" * /player:", "   * /scan")
    assert "unconnected-publications" not in findings(node("/sim", *ends, STEP))
    follower = node("/sim_husky2", pub("/husky2/scan", STRING), STEP)
    assert "unconnected-publications" not in findings(follower)


def test_a_tool_that_looks_is_not_reported():
    echo = node("/_lcmtools_echo_1", sub("/nothing"), tool=True)
    talker = node("/talker", pub("/chatter", STRING))
    assert "unconnected-subscriptions" not in findings(echo, talker)


def test_an_unheard_publication_is_a_note_only():
    finding = findings(node("/talker", pub("/chatter", STRING)))["unconnected-publications"]
    assert finding.severity is Severity.NOTE
    assert finding.items == (" * /talker:", "   * /chatter")


@pytest.mark.parametrize("topic", ["/clock", "/rosout", "/tf", "/a/_hidden"])
def test_everybodys_topics_and_hidden_ones_are_not_reported(topic):
    assert (
        findings(node("/n", pub(topic, STRING), sub(topic + "x", STRING), pub(topic + "x", STRING)))
        == {}
    )


def raising(last_time):
    error = CallbackError("/odometry", "AttributeError", "no 'pos'", "mine.py:35", 340, last_time)
    controller = node("/husky0/controller")._replace(errors=(error,))
    graph = Graph((controller,), time=100_000_000_000)
    line = LogLine("/husky0/controller", "error", "callback raised AttributeError: no 'pos'")
    return Evidence("udpm://x", graph=graph, logs=(line,))


def test_an_exception_of_a_callback_is_told_with_its_line_and_not_again_as_a_log():
    (finding,) = judge(raising(99_000_000_000))
    assert (finding.rule, finding.severity) == ("callback-errors", Severity.ERROR)
    assert finding.items == (
        (
            " * /husky0/controller raised AttributeError 340 times, mine.py:35: no 'pos'"
            " (in the callback of /odometry)"
        ),
    )
    assert finding.remedies == ("correct mine.py:35, and start /husky0/controller again",)


def test_an_exception_of_some_time_ago_is_a_warning():
    (finding,) = judge(raising(50_000_000_000))
    assert finding.severity is Severity.WARNING


def test_warnings_in_a_nodes_log_are_told():
    line = LogLine("/morse", "warning", "no wheel is called l", 7)
    evidence = Evidence("udpm://x", graph=Graph((node("/morse"),)), logs=(line,))
    (finding,) = judge(evidence)
    assert (finding.rule, finding.severity) == ("logged", Severity.WARNING)
    assert finding.items == (" * /morse: warning: no wheel is called l (7 messages)",)
    assert finding.remedies == ("read the whole log: lcmtools echo /rosout",)


@pytest.mark.parametrize(
    ("kind", "found"), [(STRING, {"type-mismatch"}), (TWIST, {"logged"})], ids=["other", "same"]
)
def test_a_message_of_another_type_is_not_told_again_as_a_log(kind, found):
    nodes = node("/sends", pub("/cmd_vel", TWIST)), node("/ear", sub("/cmd_vel", kind))
    line = LogLine("/ear", "warning", "/cmd_vel: message ignored: it is not of the type")
    assert {
        one.rule for one in judge(Evidence("udpm://x", graph=Graph(nodes), logs=(line,)))
    } == found


def test_two_live_nodes_of_one_name_are_an_error():
    finding = findings(node("/talker", pid=7), node("/talker", pid=8))["duplicate-names"]
    assert finding.severity is Severity.ERROR
    assert finding.text == "2 nodes have the name /talker:"
    assert finding.items == (" * pid 7 on husky: run /talker", " * pid 8 on husky: run /talker")
    (remedy,) = finding.remedies
    assert remedy == "end one of them (kill 7) or (kill 8), or start it with __name:=talker2"


def test_two_simulators_of_one_name_need_a_bus_each():
    clock = pub("/clock")
    finding = findings(node("/sim", clock, pid=7), node("/sim", clock, pid=8))["duplicate-names"]
    apart = "end one of them (kill 7) or (kill 8), or start it on another bus, with --domain 1"
    assert finding.remedies == (apart,)


def test_a_command_that_observes_and_publishes_is_no_duplicate_of_itself():
    looks = node("/_lcmtools_gui_7", sub("/chatter", STRING), tool=True)
    assert "duplicate-names" not in findings(looks, looks._replace(id="other", endpoints=()))


def test_a_restarted_node_is_no_duplicate_of_its_stale_self():
    found = findings(node("/talker", pid=7, stale=Staleness.UNANSWERED), node("/talker", pid=8))
    assert "duplicate-names" not in found


@pytest.mark.parametrize(
    ("stale", "remedy"),
    [
        (Staleness.HANGS, "wake it (kill -CONT 7) or end it (kill -KILL 7)"),
        (
            Staleness.ENDED,
            "start /talker again, or forget it: lcmtools node cleanup",
        ),
    ],
)
def test_stale_nodes_are_an_error(stale, remedy):
    finding = findings(node("/talker", pid=7, stale=stale))["stale-nodes"]
    assert finding.severity is Severity.ERROR
    assert finding.items == (f" * /talker (pid 7): {stale.value}",)
    assert finding.remedies == (remedy,)


def test_on_a_computer_that_is_too_busy_a_node_that_does_not_answer_is_a_note():
    hangs, ended = (
        node(name, pid=pid, stale=stale)
        for name, pid, stale in (("/a", 7, Staleness.HANGS), ("/b", 8, Staleness.ENDED))
    )
    evidence = Evidence("udpm://x", graph=Graph((hangs, ended)), listened=1.0)
    busy = replace(evidence, processor_wait=0.5)
    deaf = replace(evidence, own_drops=5)

    def severities(evidence):
        return [one.severity for one in judge(evidence) if one.rule == "stale-nodes"]

    for one in (busy, deaf):
        assert severities(one) == [Severity.ERROR, Severity.NOTE]
        stopped = replace(one, processes=(LcmProcess(7, "a", state="T"),))
        assert severities(stopped) == [Severity.ERROR]
    assert severities(
        replace(deaf, senders=(SenderFacts(Sender("10.0.0.1", 1), "a", messages=50),))
    ) == [Severity.ERROR]
    (note,) = [one for one in judge(busy) if one.severity is Severity.NOTE]
    assert note.items[-1] == " * this computer is too busy to tell: they may only be late"


def test_of_a_stale_node_elsewhere_no_process_of_this_computer_is_meant():
    far = node("/talker", pid=7, stale=Staleness.SILENT)._replace(sender=Sender("10.0.0.2", 40000))
    evidence = Evidence(url="udpm://x", graph=Graph((far,)), remote=frozenset({far.id}))
    (finding,) = [found for found in judge(evidence) if found.rule == "stale-nodes"]
    assert finding.items == (f" * /talker (pid 7 on husky at 10.0.0.2): {far.stale.value}",)
    assert "kill" not in "".join(finding.remedies)
    assert evidence.own_nodes() == []


def test_a_node_that_ended_and_was_started_again_is_no_stale_one():
    ended = node("/talker", pid=7, stale=Staleness.ENDED)
    assert "stale-nodes" not in findings(ended, node("/talker", pid=8))


def test_a_node_that_hangs_is_stale_beside_another_of_its_name():
    hanging = node("/talker", pid=7, stale=Staleness.HANGS)
    finding = findings(hanging, node("/talker", pid=8))["stale-nodes"]
    assert finding.items == (" * /talker (pid 7): runs but does not answer",)


def test_a_command_that_was_killed_is_no_stale_node():
    killed = node("/_lcmtools_pub_7", pid=7, stale=Staleness.ENDED)
    assert "stale-nodes" not in findings(killed)


def test_an_empty_bus_is_a_warning_that_names_it():
    finding = findings()["no-traffic"]
    assert finding.severity is Severity.WARNING
    assert finding.text == "There are no nodes on udpm://x, and nothing came in 1 s"


def test_a_tool_alone_is_an_empty_bus():
    assert "no-traffic" in findings(node("/_lcmtools_echo_1", tool=True))


def test_a_tool_that_publishes_is_something_on_the_bus():
    assert findings(node("/_lcmtools_pub_1", pub("/chatter", STRING), tool=True)) == {}


def test_a_bus_that_does_not_work_is_the_only_finding():
    evidence = Evidence(url="udpm://x", bus_problem="no route", bus_remedy="type: ip route")
    (finding,) = judge(evidence)
    assert finding.severity is Severity.ERROR
    assert finding.text == "The bus does not work: no route"
    assert finding.remedies == ("type: ip route",)


def test_malformed_datagrams_are_shown_with_their_sender():
    evidence = Evidence(
        url="udpm://x",
        graph=Graph((node("/n"),)),
        malformed=[("127.0.0.1:5", "starts with b'abcd'")],
    )
    (finding,) = [f for f in judge(evidence) if f.rule == "malformed"]
    assert finding.items == (" * 127.0.0.1:5: starts with b'abcd'",)


def test_errors_come_before_warnings_and_notes():
    graph = Graph(
        (
            node("/a", pub("/x", STRING), sub("/y", STRING)),
            node("/b", pid=1),
            node("/b", pid=2),
        )
    )
    severities = [finding.severity for finding in judge(Evidence(url="u", graph=graph))]
    assert severities == sorted(severities, reverse=True)
    assert severities[0] is Severity.ERROR


def test_simulated_time_needs_somebody_who_publishes_it():
    follower = node("/talker", sub("/clock", "rosgraph_msgs/Clock"), pid=7)
    finding = findings(follower)["no-clock"]
    assert finding.severity is Severity.ERROR
    assert finding.items == (" * /talker (pid 7)",)
    assert finding.remedies[0] == "start /talker without _use_sim_time:=true"
    assert "no-clock" not in findings(follower, node("/sim", pub("/clock", "rosgraph_msgs/Clock")))
    graph = Graph((follower, node("/sim", pid=8, stale=Staleness.ENDED)))
    killed = Evidence(url="udpm://x", graph=graph, stale_published=frozenset({"/clock"}))
    assert "no-clock" not in {finding.rule for finding in judge(killed)}


def test_a_rule_that_is_not_asked_takes_nothing_from_others():
    talker = node("/talker", pid=8, stale=Staleness.ENDED)
    graph = Graph((node("/ear", sub("/chatter", STRING)), talker))
    evidence = Evidence(url="udpm://x", graph=graph, stale_published=frozenset({"/chatter"}))
    assert "unconnected-subscriptions" not in {finding.rule for finding in judge(evidence)}
    asked = [rule for rule in RULES if rule.id != "stale-nodes"]
    assert "unconnected-subscriptions" in {finding.rule for finding in judge(evidence, asked)}


def test_commands_of_lcmtools_publish_nothing_unannounced():
    ear = Node("/ear", "e", "here", 7, endpoints=(Endpoint("/a", Role.SUBSCRIBER, depth=10),))
    for command, severity in (("lcmtools wtf --watch", "WARNING"), ("driver", "NOTE")):
        evidence = Evidence("udpm://", graph=Graph((ear,)), processes=(LcmProcess(9, command),))
        (finding,) = [f for f in judge(evidence) if f.rule == "unconnected-subscriptions"]
        assert finding.severity.name == severity


def test_what_came_repeatedly_has_lost_its_publisher():
    end = Endpoint("/a", Role.SUBSCRIBER, depth=10, messages=50, last_time=SECOND)
    ear = Node("/ear", "e", "here", 7, endpoints=(end,))
    graph = Graph((ear,), time=500 * SECOND)
    evidence = Evidence("udpm://", graph=graph, processes=(LcmProcess(9, "driver"),))
    (finding,) = [f for f in judge(evidence) if f.rule == "unconnected-subscriptions"]
    assert finding.severity is Severity.WARNING


def test_functions_of_one_name_in_two_modules_derive_two_values():
    def of_module(name, value):
        def shares(_):
            return value

        shares.__module__ = name
        return derived(shares)

    evidence = Evidence("udpm://239.255.76.67:7667")
    one, other = of_module("a", 1), of_module("b", 2)
    assert [one(evidence), other(evidence), one(evidence)] == [1, 2, 1]
