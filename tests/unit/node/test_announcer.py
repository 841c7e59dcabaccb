"""A node makes itself known: at once, when asked, each period, and when it leaves."""

import sys
import threading
import time

import pytest
from fixtures.fake_bus import FakeBus

from lcmtools import Node
from lcmtools.errors import BusError, ServiceTimeout
from lcmtools.graph import model
from lcmtools.graph.protocol import (
    ANSWER_SPREAD,
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Probe,
    decode_announcement,
    encode_probe,
)
from lcmtools.node.announcer import Announcer
from lcmtools.node.graph_follower import GraphFollower
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Trigger


def _announced(bus):
    payloads = [payload for channel, payload in tuple(bus.published) if channel == NODE_CHANNEL]
    return [found for payload in payloads if (found := decode_announcement(payload))]


def _probe(bus, target="", nonce=0):
    bus.publish(PROBE_CHANNEL, encode_probe(Probe(target, nonce)))


def test_a_new_node_is_announced_at_once_with_all_that_it_is(begin, bus, wait_until):
    begin("__ns:=/husky0")
    node = Node("driver")
    node.create_publisher(String, "chatter", 7)
    wait_until(lambda: _announced(bus) and len(_announced(bus)[-1].node.endpoints) == 3)
    announced = _announced(bus)[-1].node
    assert 0 <= time.time_ns() - announced.sent < 60_000_000_000
    assert announced._replace(sent=0) == node.describe()
    assert announced.name == "/husky0/driver"
    assert [(e.topic, e.type, e.depth) for e in announced.endpoints] == [
        ("/rosout", "rosgraph_msgs/Log", 100),
        ("/husky0/chatter", "std_msgs/String", 7),
        ("/husky0/driver/_parameters", "lcmtools_msgs/Parameters", 0),
    ]


def test_a_node_is_announced_each_period(begin, bus, wait_until, monkeypatch):
    monkeypatch.setattr("lcmtools.graph.announcing.PERIOD", 0.01)
    begin()
    Node("a")
    wait_until(lambda: len(_announced(bus)) > 5)


def test_rates_are_announced_while_messages_come_and_not_afterwards(
    begin, bus, wait_until, monkeypatch
):
    for module in ("graph.announcing", "node.announcer"):
        monkeypatch.setattr(f"lcmtools.{module}.PERIOD", 0.05)
    begin()
    publisher = Node("a").create_publisher(String, "/chatter")

    def rate():
        ends = [end for announced in _announced(bus)[-1:] for end in announced.node.endpoints]
        return next((end.rate for end in ends if end.topic == "/chatter"), 0.0)

    def rate_of_messages():
        publisher.publish(String())
        return rate()

    wait_until(rate_of_messages)
    wait_until(lambda: not rate())


def test_a_probe_of_all_is_answered_with_its_nonce(begin, bus, wait_until):
    begin()
    Node("a")
    Node("b")
    _probe(bus, nonce=42)
    wait_until(lambda: {a.node.name for a in _announced(bus) if a.answers == 42} == {"/a", "/b"})


def test_a_probe_of_one_is_answered_by_that_one_before_the_probe_returns(begin, bus):
    begin()
    Node("a")
    Node("b")
    _probe(bus, "/b", 43)
    _probe(bus, "/nobody", 44)
    assert [a.node.name for a in _announced(bus) if a.answers] == ["/b"]


def test_many_probes_of_one_node_get_few_answers_with_the_last_number(begin, bus, wait_until):
    begin()
    Node("a")
    Node("b")
    began = time.monotonic()
    for nonce in range(1, 501):
        _probe(bus, "/a", nonce)
        _probe(bus, f"/nobody{nonce}", nonce)
    wait_until(lambda: any(a.answers == 500 for a in _announced(bus)))
    announced = 3  # the first answer, and announcements of the new nodes, which answer too
    most = announced + (time.monotonic() - began) / ANSWER_SPREAD
    answers = [a for a in _announced(bus) if a.answers]
    assert {a.node.name for a in answers} == {"/a"}
    assert len(answers) <= most


@pytest.mark.parametrize("payload", [b"", b"nonsense", encode_probe(Probe("/a", 1))[:-1]])
def test_a_broken_probe_is_passed_over(begin, bus, payload):
    begin()
    Node("a")
    bus.publish(PROBE_CHANNEL, payload)
    _probe(bus, "/a", 5)
    assert [a.answers for a in _announced(bus) if a.answers] == [5]


def test_a_destroyed_node_says_goodbye_once(begin, bus):
    begin()
    node = Node("a")
    node.destroy_node()
    node.destroy_node()
    assert [a.node.name for a in _announced(bus) if a.leaving] == ["/a"]


def test_closing_says_goodbye_for_every_node(begin, bus):
    context = begin()
    for name in "abc":
        Node(name)
    context.close()
    assert [a.node.name for a in _announced(bus) if a.leaving] == ["/a", "/b", "/c"]


def test_nothing_is_announced_after_the_goodbye(begin, bus):
    """However busily the bus asks meanwhile."""
    begin()
    stop = threading.Event()

    def ask():
        while not stop.is_set():
            _probe(bus)
            for name in ("/n0", "/n1", "/n2"):
                _probe(bus, name, 1)

    asker = threading.Thread(target=ask)
    asker.start()
    for turn in range(60):
        Node(f"n{turn % 3}").destroy_node()
    stop.set()
    asker.join()
    left = set()
    for announcement in _announced(bus):
        assert announcement.node.id not in left
        if announcement.leaving:
            left.add(announcement.node.id)
    assert len(left) == 60


class _Refusing(FakeBus):
    """A bus that takes no announcements until it is told to."""

    takes = False

    def deliver(self, channel, payload):
        if channel == NODE_CHANNEL and not self.takes:
            raise BusError("the network is down")
        super().deliver(channel, payload)


def test_announcing_goes_on_when_the_network_comes_back(begin, wait_until, monkeypatch):
    monkeypatch.setattr("lcmtools.graph.announcing.PERIOD", 0.01)
    bus = _Refusing()
    begin(bus=bus)
    node = Node("a")
    _probe(bus, "/a", 1)
    bus.takes = True
    wait_until(lambda: _announced(bus))
    node.destroy_node()


def test_a_node_that_takes_long_to_describe_is_announced_seldom_while_it_is_set_up(bus):
    """A node with a thousand endpoints did little else while they were made."""
    described = []

    def describe():
        end = time.thread_time() + 0.02
        while time.thread_time() < end:
            pass
        described.append(None)
        return []

    announcer = Announcer(bus, describe, GraphFollower(bus, None))
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        announcer.announce_soon()
        time.sleep(0.001)
    announcer.close()
    assert 1 <= len(described) <= 5


def test_a_command_line_that_is_not_utf8_is_announced(begin, bus, wait_until, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["node", "file\udcff"])
    begin()
    Node("a")
    wait_until(lambda: _announced(bus))
    assert _announced(bus)[0].node.command == "node file?"


def test_a_command_line_without_end_is_announced_in_one_datagram(
    begin, bus, wait_until, monkeypatch
):
    monkeypatch.setattr(sys, "argv", ["node", *["--word"] * 100_000])
    begin()
    Node("a")
    wait_until(lambda: _announced(bus))
    assert _announced(bus)[0].node.command.startswith("node --word --word")
    assert max(len(payload) for channel, payload in bus.published) < 10_000


def test_who_is_called_knows_before_what_this_program_listens_to(begin, bus, monkeypatch):
    monkeypatch.setattr(Announcer, "_run", lambda _: None)  # it may always come later
    begin()
    node = Node("tester")
    client = node.create_client(Trigger, "/sim/step")
    node.create_subscription(String, "odometry", print)

    for _ in range(2):
        with pytest.raises(ServiceTimeout):
            client.call(Trigger.Request(), timeout=0.2)

    channels = [channel for channel, _ in bus.published if channel != "/rosout"]
    assert channels == [NODE_CHANNEL, "/sim/step/_request", "/sim/step/_request"]
    (announced,) = _announced(bus)
    assert "/odometry" in [endpoint.topic for endpoint in announced.node.endpoints]


def test_a_fault_of_one_announcement_is_reported_and_the_next_is_made(bus, wait_until):
    reports = []
    bus.on_outage = reports.append
    node, faults = model.NodeInfo("/a", "1", "here", 1), [OSError(28, "No space left on device")]

    def describe():
        if faults:
            raise faults.pop()
        return [node]

    announcer = Announcer(bus, describe, GraphFollower(bus, None))
    wait_until(lambda: reports)
    announcer.announce_soon()
    wait_until(lambda: _announced(bus))
    announcer.close()
    assert reports == ["announcing failed: OSError: [Errno 28] No space left on device"]
