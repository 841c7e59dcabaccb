"""Clocks, containers, bridges, firewalls and what could not be looked at."""

from dataclasses import replace

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import (
    Evidence,
    Host,
    HostClock,
    Listener,
    Oddity,
    RelayEnd,
    SenderFacts,
)
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import relays
from lcmtools.doctor.rules.unchecked import unchecked
from lcmtools.doctor.sentences import commands, unchecked_text
from lcmtools.graph.model import Endpoint, FullLine, Graph, Node, RelayStep, Role, Traffic
from lcmtools.wire.packet import Sender

REMOTE = SenderFacts(Sender("10.0.0.2", 5000), "/far", is_local=False, messages=3)
SEEN = Graph(traffic=(Traffic("A", None, (), 1, 8, 1, 1),), time=1)
OUTGOING = Evidence(
    url="udpm://239.255.76.67:7667?ttl=1",
    ttl=1,
    graph=SEEN,
    listened=1.0,
    host=Host(uid=1000, interface="eth0", speed_mbit=1000, joined=("eth0",)),
)
LOCAL = replace(OUTGOING, url="udpm://239.255.76.67:7667?ttl=0", ttl=0)


def found(evidence):
    return {finding.rule: finding for finding in judge(evidence)}


def on(evidence, **values):
    return replace(evidence, host=replace(evidence.host, **values))


def clock(lag):
    return HostClock("robot", "10.0.0.2", lag, ("/far",))


@pytest.mark.parametrize(
    ("lag", "text"),
    [
        (-3.25, "The clock of robot (10.0.0.2) is 3.2 s ahead of this computer's:"),
        (-0.12, "The clock of robot (10.0.0.2) is 120 ms ahead of this computer's:"),
        (40.0, "The clock of robot (10.0.0.2) is 40 s behind this computer's:"),
    ],
)
def test_a_clock_that_differs_is_told_with_its_nodes(lag, text):
    finding = found(replace(LOCAL, clocks=(clock(lag),)))["clocks"]
    assert (finding.severity, finding.text) == (Severity.WARNING, text)
    assert finding.items == (" * /far",)
    assert "set-ntp true" in finding.remedies[0]


@pytest.mark.parametrize("lag", [-0.09, 0.0, 0.0003, 0.25])
def test_a_slow_network_is_no_wrong_clock(lag):
    assert found(replace(LOCAL, clocks=(clock(lag),))) == {}


def test_many_nodes_of_a_wrong_clock_are_counted():
    nodes = tuple(f"/n{n}" for n in range(9))
    finding = found(replace(LOCAL, clocks=(replace(clock(9), nodes=nodes),)))["clocks"]
    assert finding.items[-2:] == (" * /n5", " * and 3 more")


def test_stamps_of_a_wrong_clock_are_not_told_again_for_each_topic():
    names = ("/far", "10.0.0.2:40001", "/near")
    odd = tuple(Oddity("future", f"/{n}", name, "x") for n, name in enumerate(names))
    rules = found(replace(LOCAL, clocks=(clock(-5),), oddities=odd))
    assert rules["stamps"].items == (" * /2 from /near: x",)
    rules = found(replace(LOCAL, clocks=(clock(0),), oddities=odd))
    assert len(rules["stamps"].items) == 3


@pytest.mark.parametrize(
    ("values", "rule"),
    [
        ({"interface": "lo"}, "loopback-route"),
        ({"container": "WSL"}, "container"),
        ({"container": "container", "is_virtual": True}, "container"),
        ({"bridge": "br0"}, "igmp-querier"),
    ],
)
def test_what_may_keep_others_away_is_a_note_while_nobody_is_heard(values, rule):
    assert found(on(LOCAL, **values)) == {}
    (finding,) = judge(on(OUTGOING, **values))
    assert (finding.rule, finding.severity) == (rule, Severity.NOTE)
    assert finding.remedies
    heard = on(replace(OUTGOING, senders=(REMOTE,)), **values)
    assert found(heard) == {}


def test_a_container_in_the_computers_own_network_is_none():
    assert found(on(OUTGOING, container="container")) == {}


def test_a_bridge_is_given_its_querier():
    (finding,) = judge(on(OUTGOING, bridge="br0"))
    assert finding.remedies == ("echo 1 | sudo tee /sys/class/net/br0/bridge/multicast_querier",)


def test_a_strict_filter_matters_where_another_interface_leads_somewhere():
    assert found(on(OUTGOING, rp_filter=1)) == {}
    assert list(found(on(OUTGOING, rp_filter=1, others=("wlan0",)))) == ["rp-filter"]


def test_a_large_message_that_does_not_come_back_is_a_warning():
    lost = on(LOCAL, large_bytes=300_000, large_problem="part 1 of 5, 65507 bytes, is lost")
    finding = found(lost)["large-messages"]
    assert finding.text == (
        "A message of 300000 bytes does not come back: part 1 of 5, 65507 bytes, is lost"
    )


def test_what_cannot_be_sent_is_an_error_with_the_remedy():
    forbidden = on(OUTGOING, send_problem="sending is forbidden", send_remedy="sudo ufw allow out")
    finding = found(forbidden)["sending"]
    assert (finding.severity, finding.remedies) == (Severity.ERROR, ("sudo ufw allow out",))


@pytest.mark.parametrize(
    ("firewall", "chain", "command"),
    [
        ("ufw", "", "sudo ufw allow in proto udp to 224.0.0.0/4"),
        (
            "firewalld",
            "",
            (
                "sudo firewall-cmd --add-rich-rule='rule family=ipv4 destination"
                " address=224.0.0.0/4 accept'"
            ),
        ),
        (
            "nftables",
            "inet filter input",
            "sudo nft insert rule inet filter input ip daddr 224.0.0.0/4 accept",
        ),
        ("iptables", "INPUT", "sudo iptables -I INPUT -d 224.0.0.0/4 -j ACCEPT"),
    ],
)
def test_each_firewall_has_its_own_remedy(firewall, chain, command):
    evidence = on(OUTGOING, firewall=firewall, firewall_chain=chain)
    (remedy,) = found(evidence)["firewall"].finding.remedies
    assert commands(remedy) == [command]


def _reasons(evidence):
    return {one.rule: unchecked_text(one) for one in unchecked(evidence)}


def test_on_a_usual_bus_everything_is_checked():
    listener = Listener("a (pid 7)", 7, 1000, buffer_bytes=212_992)
    assert _reasons(replace(LOCAL, listeners=(listener,))) == {}
    ended = Listener("b (pid 8)", 8, 1000)  # its socket was closed before its size was read
    assert _reasons(replace(LOCAL, listeners=(listener, ended))) == {}
    assert _reasons(OUTGOING) == {}


def test_what_only_root_can_know_is_unknown():
    hidden = Listener("a program of user 1001", None, 1001, buffer_bytes=212_992)
    evidence = replace(LOCAL, listeners=(hidden,), users={1001: "bob"})
    assert "(bob)" in _reasons(evidence)["stuck-listeners"]
    assert _reasons(on(evidence, uid=0)) == {}
    assert _reasons(on(OUTGOING, firewall_unknown="only root")) == {"firewall": "only root"}
    assert _reasons(on(LOCAL, firewall_unknown="only root")) == {}


def test_what_the_system_does_not_tell_is_unknown():
    sizeless = replace(LOCAL, listeners=(Listener("a (pid 7)", 7, 1000),))
    assert list(_reasons(sizeless)) == ["small-buffer"]
    of_sockets = ["kernel-drops", "stuck-listeners", "small-buffer", "interfaces", "other-users"]
    assert list(_reasons(on(LOCAL, has_sockets=False))) == [*of_sockets, "other-buses"]
    of_network = ["link", "bandwidth", "rp-filter", "igmp-querier"]
    reasons = _reasons(on(OUTGOING, has_sockets=False, speed_mbit=0))
    assert list(reasons) == [*of_sockets, "other-buses", *of_network]
    assert reasons["link"].startswith("this system does not report its routes")
    assert list(_reasons(on(OUTGOING, speed_mbit=0))) == ["bandwidth"]
    assert _reasons(on(OUTGOING, speed_mbit=0, is_wireless=True)) == {}


@pytest.mark.parametrize(
    ("url", "rules"),
    [
        ("tcpq://localhost:7700", ["loss"]),
        ("zenoh://", ["loss"]),
        ("mpudpm://239.255.76.67:7667?ttl=0", ["loss"]),
        ("file:///tmp/log", []),
    ],
)
def test_other_kinds_of_buses_do_not_tell_senders(url, rules):
    assert list(_reasons(replace(LOCAL, url=url))) == rules


def test_a_bus_that_does_not_work_comes_first():
    assert _reasons(replace(on(LOCAL, has_sockets=False), bus_problem="no route")) == {}


def test_a_clock_behind_a_relay_is_told_without_an_address_and_a_slow_line_is_none():
    far = Node("/far", "f", "robot", 7, path=(RelayStep("r", "/relay", "0"),))
    odd = tuple(Oddity("future", "/a", name, "x") for name in ("/far", "/relay", "/near"))
    evidence = replace(LOCAL, graph=Graph((far,)), oddities=odd, remote=frozenset("f"))
    behind = HostClock("robot", "", 40.0, ("/far",))
    rules = found(replace(evidence, clocks=(behind,)))
    assert rules["clocks"].text == "The clock of robot is 40 s behind this computer's:"
    assert rules["stamps"].items == (" * /a from /near: x",)
    assert "clocks" not in found(replace(evidence, clocks=(replace(behind, lag=1.2),)))


def test_clocks_that_cannot_be_compared_are_not_checked():
    nodes = [Node(f"/{host}", host, host, 7) for host in ("ada", "bob")]
    evidence = replace(LOCAL, graph=Graph(tuple(nodes)), remote=frozenset(("ada", "bob")))
    known = HostClock("ada", "", 0.0, ("/ada",))
    reasons = _reasons(replace(evidence, clocks=(known,)))
    assert reasons == {"clocks": "no announcement of bob tells when it was sent"}


def _full(before, now, *passing):
    def graph(dropped):
        line = FullLine("tcpq://office", dropped, passing)
        return Graph((Node("/its_name", "r", "robot", 1, full_lines=(line,)),))

    return Evidence(url="", before=graph(before), graph=graph(now))


def test_the_remedy_for_a_full_line_is_a_rate_that_it_takes():
    end = RelayEnd("/its_name", "robot", "tcpq://office", dropped=3, id="r")
    passing = ("/camera/image", 3.17), ("/a b", 120.0), ("/cloud", 0.0)
    evidence = replace(_full(0, 3, *passing), relays=(end,))
    options = "--rate /camera/image=2.5 --rate '/a b=96' --deny /cloud"
    assert found(evidence)["relay-losses"].remedies == (
        f"start /its_name again with {options} as well",
    )
    assert relays.is_in_doubt(evidence)


def test_a_server_that_drops_messages_for_a_client_is_named():
    losses = found(_full(5, 9, ("/image", 5.0)))["relay-losses"]
    assert losses.items == (" * /its_name on robot: 4 messages for tcpq://office",)
    assert losses.remedies[0].endswith("the relay that brings it: --rate /image=4")
    assert "relay-losses" not in found(_full(9, 9, ("/image", 5.0)))


_IMAGE = Endpoint("/image", Role.PUBLISHER, rate=30.0)


def _fills(*passing, dropped=9, rate=30.0):
    ends = (_IMAGE._replace(rate=rate), Endpoint("/cmd_vel", Role.PUBLISHER, rate=20.0))
    lines = (FullLine("10.0.0.2", dropped, passing),)
    return Node("/robot", "r", "robot", 1, endpoints=ends, full_lines=lines)


@pytest.mark.parametrize(
    ("line", "fact", "remedy"),
    [
        (
            _fills(("/image", 5.7)),
            "/image, 30 Hz, of which 5.7 Hz pass to 10.0.0.2",
            "/image at 4.6 Hz at most, or smaller messages",
        ),
        (
            _fills(("/image", 5.7), ("/cmd_vel", 19.5)),  # commands only waited with the images
            "/image, 30 Hz, of which 5.7 Hz pass to 10.0.0.2",
            "/image at 4.6 Hz at most, or smaller messages",
        ),
        (
            _fills(("/image", 5.7), rate=0.0),
            "/image, of which 5.7 Hz pass to 10.0.0.2",
            "/image at 4.6 Hz at most, or smaller messages",
        ),
        (
            _fills(("/image", 0.0)),
            "/image, 30 Hz, of which 0 Hz pass to 10.0.0.2",
            "smaller messages on /image, or none",
        ),
    ],
)
def test_a_line_that_a_node_fills_is_named_with_the_rate_that_it_takes(line, fact, remedy):
    other = line._replace(full_lines=(line.full_lines[0]._replace(to="elsewhere", dropped=3),))
    for before in (Graph((other,)), Graph()):  # a full line may delay the first announcement
        losses = found(Evidence(url="", before=before, graph=Graph((line,))))
        assert losses["full-line"].items == (f" * /robot on robot: {fact}",)
        assert [one.partition("publish ")[2] for one in losses["full-line"].remedies] == [remedy]


@pytest.mark.parametrize(
    ("before", "now"),
    [
        (_fills(("/image", 5.0)), _fills(("/image", 5.0))),  # nothing more was dropped
        (_fills()._replace(full_lines=()), _fills(("/image", 5.0))),  # wtf itself fills the line
        (_fills(("/image", 5.0)), _fills(dropped=20)),
    ],
)
def test_a_line_that_was_not_full_before_the_look_is_not_named(before, now):
    assert "full-line" not in found(Evidence(url="", before=Graph((before,)), graph=Graph((now,))))
