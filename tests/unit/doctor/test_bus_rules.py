"""The rules of wtf that judge the bus and the computer: planted faults."""

from collections import defaultdict
from dataclasses import replace

import pytest
from fixtures.judging import (
    ALICE,
    BOB,
    HEALTHY,
    found,
    only,
    stream,
)

from lcmtools.doctor import lcm_processes as programs
from lcmtools.doctor.evidence import (
    Evidence,
    Host,
    LcmProcess,
    Listener,
    SenderFacts,
)
from lcmtools.doctor.findings import Severity
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Traffic


def test_listeners_on_another_interface_are_named_where_that_is_known():
    host = replace(HEALTHY.host, interface="eth0", joined=("eth0", "wlan0", "lo"))
    listeners = (Listener("a (pid 7)", 7, 0, joined=("lo",)), Listener("b", 8, 0, joined=("eth0",)))
    assert only(replace(HEALTHY, host=host, listeners=listeners)).items == (" * a (pid 7): on lo",)
    unknown = (Listener("a (pid 7)", 7, 0),)
    # lcmtools' own programs join on lo as well
    assert only(replace(HEALTHY, host=host, listeners=unknown)).items == (" * on wlan0",)


def test_what_the_strict_filter_has_dropped_is_a_warning():
    strict = replace(HEALTHY.host, interface="eth0", rp_filter=1, others=("eth1",))
    dropped = replace(strict, rp_filter_drops=7)
    assert found(replace(HEALTHY, ttl=1, host=strict))["rp-filter"].severity is Severity.NOTE
    finding = found(replace(HEALTHY, ttl=1, host=dropped))["rp-filter"]
    assert finding.severity is Severity.WARNING
    assert finding.text.startswith("rp_filter dropped 7 datagrams")


def test_ttl_0_where_other_computers_take_part():
    senders = (
        SenderFacts(ALICE, "/talker", ttl=0),
        SenderFacts(BOB, "10.0.0.2:5000", is_local=False, ttl=1),
    )
    finding = only(replace(HEALTHY, senders=senders))
    assert finding.rule == "ttl"
    assert finding.text == "Other computers (10.0.0.2) cannot receive from the following (ttl=0):"
    assert finding.items == (" * /talker",)


def test_a_camera_may_stay_at_home_on_purpose():
    senders = (
        SenderFacts(ALICE, "/camera", ttl=0),
        SenderFacts(ALICE, "/talker", ttl=1),
        SenderFacts(BOB, "10.0.0.2:5000", is_local=False, ttl=1),
    )
    evidence = replace(HEALTHY, senders=senders, streams=(stream("/image", 30, name="/camera"),))
    assert found(evidence) == {}
    ear = Node("/ear", "far", "bob", 1, endpoints=(Endpoint("/image", Role.SUBSCRIBER),))
    wanted = replace(evidence, graph=evidence.graph._replace(nodes=(ear,)), remote={"far"})
    finding = found(wanted)["ttl"]
    assert (finding.severity, finding.items) == (Severity.WARNING, (" * /camera",))


def test_ttl_above_1_leaves_the_network():
    senders = (SenderFacts(ALICE, "/talker", ttl=7),)
    assert only(replace(HEALTHY, senders=senders)).items == (" * /talker sends with ttl=7",)


def test_other_users_of_the_bus_are_named_but_root():
    listeners = (Listener("?", None, 4711), Listener("r", None, 0))
    finding = only(replace(HEALTHY, listeners=listeners, users={4711: "bob"}))
    assert finding.rule == "other-users"
    assert finding.items == (" * bob: ?",)


def test_mpudpm_beside_udpm_is_a_warning():
    asks = Traffic("#!mpudpm_CH2PRT_REQ", BOB, (), 1, 20, 1, 1)
    facts = (SenderFacts(BOB, "sub (pid 9)"),)
    graph = HEALTHY.graph._replace(traffic=(*HEALTHY.graph.traffic, asks))
    findings = found(replace(HEALTHY, graph=graph, senders=facts))
    assert findings["mpudpm"].items == (" * sub (pid 9)",)
    silent = LcmProcess(8, "pub", "", "LCM_DEFAULT_URL=mpudpm://239.255.76.67:7667")
    assert found(replace(HEALTHY, processes=(silent,)))["mpudpm"].items == (" * pub (pid 8)",)
    url = "mpudpm://239.255.76.67:7700?ttl=0"
    away = replace(silent, bus=url, variable=f"LCM_DEFAULT_URL={url}")
    evidence = replace(HEALTHY, graph=Graph(), processes=(away,))
    assert found(evidence).keys() == {"other-buses"}
    assert found(evidence)["other-buses"].remedies == (f"export LCM_DEFAULT_URL='{url}'",)


def test_publishers_on_several_buses_are_told_the_one_where_they_are_missed():
    ends = tuple(Endpoint(topic, Role.SUBSCRIBER) for topic in ("/odom", "/scan"))
    graph = Graph((Node("/ear", "ear", "here", 1, endpoints=ends),))
    odom = LcmProcess(9, "wheels", "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3", topics=("/odom",))
    scan = LcmProcess(8, "laser", "239.255.76.68:7667", "LCM_DEFAULT_URL=x", topics=("/scan",))
    here = f"if they should be on this one, start them with LCM_DEFAULT_URL='{HEALTHY.url}'"
    finding = found(replace(HEALTHY, graph=graph, processes=(odom, scan)))["other-buses"]
    assert finding.severity is Severity.WARNING
    assert finding.text.endswith(", with /odom and /scan, which nodes here wait for:")
    assert finding.remedies == (here,)
    finding = found(replace(HEALTHY, graph=graph, processes=(odom,)))["other-buses"]
    there = "export LCM_DEFAULT_URL='udpm://239.255.76.67:7670?ttl=0'"
    assert finding.remedies == (there, here)


def test_a_listener_on_another_bus_is_told_the_one_where_its_topic_is():
    ends = (Endpoint("/scan", Role.PUBLISHER),)
    graph = Graph((Node("/laser", "laser", "here", 1, endpoints=ends),))
    away = LcmProcess(9, "ear", "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3", awaited=("/scan",))
    findings = found(replace(HEALTHY, graph=graph, listeners=(), processes=(away,)))
    assert findings.keys() == {"other-buses"}
    finding = findings["other-buses"]
    assert finding.severity is Severity.WARNING
    assert finding.text.endswith("and wait there for /scan, which is published here:")
    here = f"if they should be on this one, start them with LCM_DEFAULT_URL='{HEALTHY.url}'"
    assert finding.remedies == (here,)


@pytest.mark.parametrize(("topic", "searches"), [("/rosout", 0), ("/scan", 1)])
def test_other_buses_are_searched_only_for_what_is_missing(topic, searches, monkeypatch):
    searched = []

    def topics(processes, _missed):
        searched.extend(process.bus for process in processes)
        return defaultdict(set), defaultdict(set, {9: {topic}})

    monkeypatch.setattr(programs, "_topics", topics)
    ends = tuple(Endpoint(name, Role.PUBLISHER) for name in (topic, "/_lcmtools/hidden"))
    graph = Graph((Node("/laser", "laser", "here", 1, endpoints=ends),))
    away = LcmProcess(9, "ear", "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3")
    (found_away,) = programs.with_topics([away], graph)
    assert searched == [away.bus] * searches
    assert found_away.awaited == (topic,) * searches


def test_an_empty_bus_names_the_buses_where_ones_programs_are():
    other = LcmProcess(9, "talker", "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3")
    evidence = replace(HEALTHY, graph=Graph(), processes=(other, LcmProcess(8, "here")))
    finding = found(evidence)["other-buses"]
    assert finding.items == (" * pid 9 on 239.255.76.67:7670 (LCMTOOLS_DOMAIN=3): talker",)
    assert finding.remedies == ("export LCM_DEFAULT_URL='udpm://239.255.76.67:7670?ttl=0'",)
    beside = only(replace(HEALTHY, processes=(other, LcmProcess(7, "x", "tcpq://127.0.0.1:7700"))))
    assert (beside.rule, beside.severity) == ("other-buses", Severity.NOTE)
    assert beside.items[1] == " * pid 7 on tcpq://127.0.0.1:7700: x"
    assert beside.remedies == (
        f"if they should be on this one, start them with LCM_DEFAULT_URL='{HEALTHY.url}'",
        (
            "those without a variable get their bus from their code or arguments: name this bus"
            " there, or none: lcm.LCM()"
        ),
    )


def test_a_bus_that_only_the_code_names_is_worded_as_a_guess():
    process = LcmProcess(9, "./driver", "239.255.76.67:7670", is_guess=True)
    finding = only(replace(HEALTHY, processes=(process,)))
    assert finding.items == (
        " * pid 9 probably on 239.255.76.67:7670 (its code names it): ./driver",
    )
    assert finding.remedies[1].endswith("name this bus there, or none: lcm.LCM()")


def test_nearly_all_files_open_is_a_warning():
    full = LcmProcess(9, "leak.py", open_files=950, most_files=1024)
    assert only(replace(HEALTHY, processes=(full,))).rule == "open-files"


def _host(**values):
    return replace(HEALTHY, host=replace(HEALTHY.host, **values))


def test_the_computer_itself():
    listener = (Listener("x", 1, 1000),)
    moved = replace(_host(interface="eth0", joined=("wlan0", "eth0")), listeners=listener)
    assert only(moved).items == (" * on wlan0",)
    assert only(_host(reassembly_failures=3)).rule == "reassembly"
    assert only(replace(_host(rp_filter=1, interface="eth0", others=("b",)), ttl=1)).rule == (
        "rp-filter"
    )
    assert only(replace(_host(firewall="ufw", interface="eth0"), ttl=1)).rule == "firewall"
    assert only(_host(environment=("PYTHONPATH has /x",))).items == (" * PYTHONPATH has /x",)
    assert found(_host(rp_filter=1, firewall="ufw")) == {}


def test_a_bus_that_fills_the_network():
    streams = (stream("CAM", 30, 30, bytes=9_000_000),)
    wired = replace(_host(interface="eth0", joined=(), speed_mbit=100), ttl=1, streams=streams)
    assert only(wired).rule == "bandwidth"
    assert only(wired).items == (" * 'CAM' from alice: 9.00 MB/s",)
    assert found(replace(wired, ttl=0)) == {}
    gigabit = replace(wired, host=replace(wired.host, speed_mbit=1000))
    assert found(gigabit) == {}
    wireless = replace(gigabit, host=replace(gigabit.host, is_wireless=True))
    assert "bandwidth" in found(wireless)


def test_a_bus_that_does_not_work_says_what_stands_in_the_way():
    host = Host(interface="lo", is_up=False, firewall="ufw", container="container")
    evidence = Evidence("udpm://", bus_problem="no route", bus_remedy="type: x", host=host)
    finding = only(evidence)
    assert finding.rule == "bus"
    assert finding.items[0] == " * the interface lo is down"
    assert finding.remedies == ("type: x", "start the container with: --network host")


def test_what_bears_on_multicast_is_not_said_of_a_server():
    host = Host(firewall="ufw", container="container")
    evidence = Evidence("tcpq://127.0.0.1:1", bus_problem="no server", host=host)
    assert only(evidence).items == ()


def test_what_is_missed_is_connected_here_before_it_is_sought_on_another_bus():
    given, taken = Endpoint("/r/odometry", Role.PUBLISHER), Endpoint("/odometry", Role.SUBSCRIBER)
    nodes = (
        Node("/robot", "robot", "here", 1, endpoints=(given,)),
        Node("/driver", "driver", "here", 2, endpoints=(taken,)),
    )
    there = LcmProcess(9, "robot", "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3", topics=("/odometry",))
    findings = found(replace(HEALTHY, graph=Graph(nodes), processes=(there,)))
    (remedy,) = findings["unconnected-subscriptions"].remedies
    assert remedy.endswith("start /driver with odometry:=/r/odometry")
    assert findings["other-buses"].severity is Severity.NOTE
    alone = found(replace(HEALTHY, graph=Graph(nodes[1:]), processes=(there,)))
    assert alone["other-buses"].severity is Severity.WARNING
    assert "unconnected-subscriptions" not in alone
