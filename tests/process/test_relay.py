"""Relays between buses: what arrives, once and in order, and who is seen on the other side."""

import json
import os
import re
import signal
import threading
import time
from contextlib import ExitStack, closing

import pytest
from fixtures.says import assert_says
from fixtures.typist import Typist

from lcmtools.bus.open import open_bus
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.graph.relay_report import State
from lcmtools.labs.nodes.talker import Talker
from lcmtools.relay.relay import Relay, attend
from lcmtools.relay.rules import Rules


class _EndError(Exception):
    """The relay is to end."""


class RunningRelay:
    """A relay on threads of the test.

    Attributes:
        said: What it has said.
        link: Its state.
    """

    def __init__(self, here, there, rules, name):
        self.said = []
        self.link = None
        self._ends = threading.Event()
        self._relay = Relay((parse_url(here), parse_url(there)), rules, self.said.append, name=name)
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    @property
    def carries(self):
        """True while it carries messages."""
        return self.link is not None and self.link.state is State.ACTIVE

    @property
    def stands_by(self):
        """True once it has said that it stands by."""
        return any(text.startswith("stands by") for text in self.said) and not self.carries

    def end(self):
        """End it, with its goodbye."""
        self._ends.set()
        self._thread.join()

    def _run(self):
        with pytest.raises(_EndError), self._relay:
            attend(self._relay, self._note)

    def _note(self, link):
        self.link = link
        if self._ends.is_set():
            raise _EndError


@pytest.fixture
def nothing_late(monkeypatch):
    """Nothing is late for a relay of this process, however busy the computer is."""
    monkeypatch.setattr("lcmtools.relay.side.LATE", 3600.0)
    monkeypatch.setattr("lcmtools.wire.lateness.LATE", 3600 * 10**9)
    monkeypatch.setattr("lcmtools.bus.zenoh.keep_last_sender._MOST_WAITING", 3600 * 10**9)


@pytest.fixture
def relay(wait_until, nothing_late):
    """``relay(here, there, Rules(), waits=True)``: a relay that works, or stands by."""
    del nothing_late
    running = []

    def run(here, there, rules=Rules()):  # noqa: B008
        one = RunningRelay(here, there, rules, f"/relay_{len(running)}")
        running.append(one)
        wait_until(lambda: one.carries or one.stands_by)
        return one

    yield run
    for one in running:
        one.end()


@pytest.fixture
def urls(free_port):
    """Gives buses: ``urls()``, ``urls("zenoh://224.0.0.224:")``."""
    return lambda start="udpm://239.255.76.67:": f"{start}{free_port()}"


@pytest.fixture
def join():
    """``join(url)``: a connection to a bus."""
    with ExitStack() as closing:

        def make(url):
            bus = open_bus(parse_url(url))
            closing.callback(bus.close)
            return bus

        yield make


def _hears(bus, channel):
    heard = []
    bus.subscribe(channel, lambda payload, _: heard.append(payload))
    return heard


def _numbers(count):
    return [number.to_bytes(8, "big") for number in range(count)]


def test_messages_pass_both_ways_once_and_in_order(relay, urls, join, wait_until):
    one, other = urls(), urls()
    relay(one, other)
    here, there = join(one), join(other)
    at_here, at_there = _hears(here, "/back"), _hears(there, "/there")
    own = _hears(here, "/there")
    for payload in _numbers(300):
        here.publish("/there", payload)
        there.publish("/back", payload)
        time.sleep(0)  # the other threads of this process have their turn
    large = bytes(8_000_000)
    here.publish("/there", large)
    wait_until(lambda: at_there[-1:] == [large] and len(at_here) == 300)
    assert at_there == [*_numbers(300), large]
    assert at_here == _numbers(300)
    wait_until(lambda: len(own) == 301)
    assert own == [*_numbers(300), large]  # no echo


def test_of_two_relays_one_carries_and_the_other_takes_over(relay, urls, join, wait_until):
    one, other = urls(), urls()
    first, second = relay(one, other), relay(other, one)
    assert (first.carries, second.stands_by) == (True, True)
    assert_says(second.said[0], "stands by", "/relay_0", "udpm://")
    here, there = join(one), join(other)
    heard, own = _hears(there, "/a"), _hears(here, "/a")
    for payload in _numbers(100):
        here.publish("/a", payload)
    wait_until(lambda: len(heard) >= 100 and len(own) >= 100)
    first.end()
    wait_until(lambda: second.carries)
    for payload in _numbers(100):
        here.publish("/a", payload)
    here.publish("/a", b"end")
    wait_until(lambda: heard[-1] == own[-1] == b"end")
    assert heard == own == [*_numbers(100), *_numbers(100), b"end"]


def test_a_ring_of_three_makes_no_circle(relay, urls, join, wait_until):
    rings = [urls(), urls(), urls()]
    relays = [relay(rings[number], rings[(number + 1) % 3]) for number in range(3)]
    assert [one.carries for one in relays] == [True, True, False]
    buses = [join(url) for url in rings]
    heard = [_hears(bus, "/a") for bus in buses]
    for payload in _numbers(50):
        buses[0].publish("/a", payload)
    buses[0].publish("/a", b"end")
    wait_until(lambda: all(one[-1:] == [b"end"] for one in heard))
    assert heard == 3 * [[*_numbers(50), b"end"]]
    relays[0].end()  # the third joins what it has joined
    wait_until(lambda: relays[2].carries)
    for one in heard:
        one.clear()
    buses[1].publish("/a", b"again")
    wait_until(lambda: all(heard))
    assert heard == 3 * [[b"again"]]


def test_another_relay_takes_over_from_one_that_is_killed_and_keeps_what_it_has(
    relay, urls, join, start, lcmtools_path, wait_until
):
    one, other = urls(), urls()
    killed = start(lcmtools_path, "relay", one, other)
    killed.wait_for("carries messages between")
    second = relay(one, other)
    assert second.stands_by
    killed.send_signal(signal.SIGKILL)
    wait_until(lambda: second.carries)
    again = start(lcmtools_path, "relay", one, other)
    again.wait_for("stands by: /relay_0 joins")
    here, there = join(one), join(other)
    heard = _hears(there, "/a")
    for payload in _numbers(50):
        here.publish("/a", payload)
    here.publish("/a", b"end")
    wait_until(lambda: heard[-1:] == [b"end"])
    assert heard == [*_numbers(50), b"end"]
    again.send_signal(signal.SIGINT)
    assert again.wait() == 130


def test_nodes_are_seen_on_the_other_bus_with_their_own(relay, urls, cli, start_node, wait_until):
    one, other = urls(), urls()
    start_node(Talker, url=one)
    running = relay(one, other, Rules(prefix="robot7"))
    env = {"LCM_DEFAULT_URL": other}
    wait_until(lambda: "/robot7/talker" in cli("node", "list", env=env).out)
    assert "/robot7/talker (on udpm://" in cli("node", "list", env=env).out
    assert cli("echo", "/robot7/chatter", "-n", "1", env=env).out.startswith("data:")
    (listed,) = json.loads(cli("node", "info", "/robot7/talker", "--json", env=env).out)
    assert listed["relays"] == ["/relay_0"]
    assert listed["bus"].startswith("udpm://239.255.76.67:")
    assert listed["memory_bytes"] is None  # nothing of a process of this computer
    (info,) = json.loads(cli("info", "/robot7/chatter", "--json", env=env).out)
    assert [row["node"] for row in info["publishers"]] == ["/robot7/talker"]
    assert info["other_publishers"] == []
    assert "by /relay_0, pid" in cli("info", "/robot7/chatter", env=env).out
    kill = ("node", "kill", "/robot7/talker")
    wait_until(lambda: "is on another bus and cannot be shut down" in cli(*kill, env=env).err)
    answered = cli("node", "ping", "/robot7/talker", env=env, until="time=")
    assert "reply from /robot7/talker" in answered.out
    recorded = [
        {node.name for node in NodeRecords(parse_url(url), os.environ).read()}
        for url in (one, other)
    ]
    running.end()
    assert "talker" not in cli("node", "list", env=env).out
    assert recorded == [{"/talker", "/relay_0"}, {"/relay_0"}]  # who looks waits for it
    assert not list(NodeRecords(parse_url(other), os.environ).read())


def test_a_relay_that_is_interrupted_before_it_begins_is_missed_by_nobody(urls):
    buses = parse_url(urls()), parse_url(urls())
    records = [NodeRecords(bus, os.environ) for bus in buses]
    relay = Relay(buses, Rules(), [].append, name="/short")
    assert not any(list(of.read()) for of in records)
    with relay:
        relay.turn()
        assert [node.name for of in records for node in of.read()] == ["/short", "/short"]
    assert not any(list(of.read()) for of in records)


def test_parameters_and_services_work_through_a_relay(relay, urls, cli, start_node, wait_until):
    one, other = urls(), urls()
    start_node(Talker, url=one)
    relay(one, other)
    env = {"LCM_DEFAULT_URL": other}
    wait_until(lambda: "/talker" in cli("node", "list", env=env).out)
    get = ("param", "get", "talker", "use_sim_time")
    wait_until(lambda: cli(*get, env=env).out == "false\n")
    refused = cli("param", "set", "talker", "use_sim_time", "true", env=env)
    assert_says(refused.err, "/talker", "use_sim_time", "cannot change")


def test_commands_pass_only_where_they_are_named(relay, urls, join, wait_until):
    one, other = urls(), urls()
    running = relay(one, other, Rules(allow=["**", "/named/cmd_vel"], deny=["/no"]))
    here, there = join(one), join(other)
    passed = [_hears(there, channel) for channel in ("/cmd_vel", "/no", "/clock", "LCM_SELF_TEST")]
    named, last = _hears(there, "/named/cmd_vel"), _hears(there, "/last")
    for channel in ("/cmd_vel", "/no", "/clock", "LCM_SELF_TEST", "/named/cmd_vel", "/last"):
        here.publish(channel, b"12345678")
    wait_until(lambda: last)
    assert named == [b"12345678"]
    assert not any(passed)
    wait_until(lambda: running.link and running.link.ends[0].left_out >= 4)


def test_what_needs_an_option_to_pass_is_said_once_with_the_option(
    urls, join, start, lcmtools_path
):
    one, other = urls(), urls()
    program = start(lcmtools_path, "relay", one, other)
    program.wait_for("carries messages between")
    here = join(one)
    for channel in ("/cmd_vel", "/cmd_vel", "/clock", "/other"):
        here.publish(channel, b"12345678")
    program.wait_for("leaves out /cmd_vel; to pass it: --allow '**' --allow /cmd_vel")
    program.send_signal(signal.SIGINT)
    program.wait()
    printed = program.output
    assert printed.count("leaves out") <= 2
    assert "left out by its rules" in printed.rpartition("none lost, ")[2]


@pytest.mark.usefixtures("nothing_late")
def test_what_it_counted_since_its_last_turn_is_in_its_link(urls, join, wait_until):
    one, other = urls(), urls()
    here, there = join(one), join(other)
    last = _hears(there, "/last")
    with Relay((parse_url(one), parse_url(other)), Rules(), lambda _: None) as running:
        wait_until(lambda: running.turn().state is State.ACTIVE)
        for channel in ("/cmd_vel", "/cmd_vel", "/last"):
            here.publish(channel, b"12345678")
        wait_until(lambda: last)
    assert running.link.ends[0].left_out == 2
    assert running.link.ends[1].messages == 1


@pytest.mark.usefixtures("nothing_late")
def test_it_carries_by_the_time_it_says_so(urls, join, wait_until):
    one, other = urls(), urls()
    here, there = join(one), join(other)
    early = _hears(there, "/early")

    def notify(text):
        if text.startswith("carries messages"):
            here.publish("/early", b"12345678")
            wait_until(lambda: early)

    with Relay((parse_url(one), parse_url(other)), Rules(), notify) as running:
        wait_until(lambda: early or running.turn().state is State.ACTIVE)
    assert early == [b"12345678"]


def test_an_allowed_name_alone_says_that_nothing_else_passes(urls, start, lcmtools_path):
    program = start(lcmtools_path, "relay", urls(), urls(), "--allow", "CMD")
    program.wait_for("only CMD can pass; --allow '**' passes the other topics, too")


def test_one_way_lets_nothing_back(relay, urls, join, wait_until):
    one, other = urls(), urls()
    running = relay(one, other, Rules(one_way=True))
    here, there = join(one), join(other)
    back, last = _hears(here, "/back"), _hears(there, "/last")
    there.publish("/back", b"12345678")
    wait_until(lambda: running.link and running.link.ends[1].left_out)
    here.publish("/last", b"12345678")
    wait_until(lambda: last)
    assert not back


def test_a_latched_message_comes_to_who_is_late_on_the_other_bus(
    relay, urls, cli, start, lcmtools_path
):
    one, other = urls(), urls()
    words = ("pub", "--latch", "/map_name", "std_msgs/String", "data: hall", "--lcm-url", one)
    start(lcmtools_path, *words).wait_for("latching")
    relay(one, other)
    late = cli("echo", "/map_name/data", "-n", "1", "--lcm-url", other, "--timeout", "20")
    assert late.out == '"hall"\n---\n'


def test_a_rate_keeps_some(relay, urls, join, wait_until):
    one, other = urls(), urls()
    relay(one, other, Rules(rates={"/fast": 0.01}))
    here, there = join(one), join(other)
    heard, last = _hears(there, "/fast"), _hears(there, "/last")
    for payload in _numbers(20):
        here.publish("/fast", payload)
    here.publish("/last", b"")
    wait_until(lambda: last)
    assert heard == _numbers(1)


def test_a_server_and_a_group_are_joined_without_an_echo(
    relay, urls, tcpq_server, join, wait_until
):
    one = urls()
    running = relay(one, tcpq_server.url)
    here, there = join(one), join(tcpq_server.url)
    heard, own, back = _hears(there, "/a"), _hears(here, "/a"), _hears(here, "/b")
    wait_until(lambda: here.publish("/a", b"first") or heard)
    here.publish("/a", b"begin")
    wait_until(lambda: heard[-1:] == own[-1:] == [b"begin"])
    heard.clear()
    own.clear()
    for payload in _numbers(100):
        here.publish("/a", payload)
        there.publish("/b", payload)
    here.publish("/a", b"end")
    wait_until(lambda: heard[-1:] == own[-1:] == [b"end"] and len(back) == 100)
    there.publish("/b", b"end")
    wait_until(lambda: back[-1:] == [b"end"])
    assert heard == own == [*_numbers(100), b"end"]
    tcpq_server.close()
    wait_until(lambda: not running.carries)
    here.publish("/a", b"lost")
    tcpq_server.reopen()
    wait_until(lambda: running.carries)
    wait_until(lambda: "is back" in running.said[-2])
    heard.clear()
    wait_until(lambda: here.publish("/a", b"again") or heard)
    assert set(heard) == {b"again"}
    texts = [text for text in running.said if "is lost" in text or "is back" in text]
    assert len(texts) == 2


def test_relays_are_shown_by_status(relay, urls, cli, wait_until):
    one, other = urls(), urls()
    relay(one, other)
    relay(one, other)
    env = {"LCM_DEFAULT_URL": other}

    def states():
        shown = json.loads(cli("relay", "--status", "--json", env=env).out)
        return [(link["name"], link["state"]) for link in shown]

    # on a busy computer one may answer too late for a look
    wait_until(lambda: states() == [("/relay_0", "active"), ("/relay_1", "standby")])

    def says_what_is_lost():
        rows = cli("relay", "--status", env=env).out.splitlines()
        return len(rows) == 5 and "carries, none lost" in rows[1]

    wait_until(says_what_is_lost)
    none = cli("relay", "--status", env={"LCM_DEFAULT_URL": urls()})
    assert (none.code, none.out) == (0, "")
    assert_says(none.err, "no relay", "udpm://")


def test_two_groups_are_joined_by_zenoh_and_two_relays(
    relay, urls, join, cli, start_node, wait_until
):
    one, line, other = urls(), urls("zenoh://224.0.0.224:"), urls()
    start_node(Talker, url=one)
    running = [relay(one, line), relay(other, line), relay(line, other)]
    assert [each.carries for each in running] == [True, True, False]
    here, there = join(one), join(other)
    heard, back = _hears(there, "/a"), _hears(here, "/b")
    for payload in _numbers(200):
        here.publish("/a", payload)
        there.publish("/b", payload)
    wait_until(lambda: len(heard) >= 200 and len(back) >= 200)
    # not amid the others, which its fragments would push out of the buffers of a busy computer
    here.publish("/a", bytes(150_000))
    wait_until(lambda: len(heard) > 200)
    assert heard == [*_numbers(200), bytes(150_000)]
    assert back == _numbers(200)
    env = {"LCM_DEFAULT_URL": other}
    wait_until(lambda: "/talker" in cli("node", "list", env=env).out)
    (listed,) = json.loads(cli("node", "info", "/talker", "--json", env=env).out)
    assert listed["relays"] == ["/relay_1", "/relay_0"]
    assert listed["bus"].startswith("udpm://239.255.76.67:")
    get = ("param", "get", "talker", "use_sim_time")
    wait_until(lambda: cli(*get, env=env).out == "false\n")


def test_a_relay_at_a_terminal_shows_what_it_carries(urls, lcmtools_path, start_node):
    one, other = urls(), urls()
    start_node(Talker, url=one)
    with closing(Typist(lcmtools_path, "relay", one, other)) as user:
        user.wait_for("carries messages between")
        user.wait_for("/s; none lost")
        assert re.search(rb"\rthere \d+/s, .*B/s; back \d+/s, .*B/s; none lost", user.written)
        user.process.send_signal(signal.SIGINT)
        assert user.end() == 130
    assert b" messages (" in user.written
