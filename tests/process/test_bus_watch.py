"""A watch: what the commands that look at a bus learn from it, and how soon."""

import os
import time
from contextlib import ExitStack

import lcm
import pytest

from lcmtools import Node
from lcmtools.arguments import split_arguments
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import Role
from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.node.context import Context
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.types.std_msgs import String


@pytest.fixture
def open_monitor(bus_url):
    with ExitStack() as stack:
        yield lambda tool: stack.enter_context(BusMonitor(parse_url(bus_url), tool, os.environ))


@pytest.fixture
def context(bus_url):
    """A program with nodes, on a connection of its own."""
    said, _ = split_arguments([])
    context = Context(UdpBus(parse_url(bus_url)), said, {})
    yield context
    context.close()


@pytest.mark.timing
def test_the_graph_is_complete_at_once(context, open_monitor, stopwatch):
    nodes = [Node(f"n{number}", context=context) for number in range(20)]
    nodes[3].create_publisher(String, "chatter")
    watch, time_taken = open_monitor("list"), stopwatch()
    graph = watch.settle(foreign=False)
    assert time_taken.seconds() < 0.35
    assert len(graph.nodes) == 20
    (found,) = graph.named("n3")
    assert found.sender is not None
    assert found.pid == os.getpid()
    assert [e.topic for e in found.having(Role.PUBLISHER)] == ["/chatter", "/rosout"]


def test_all_that_a_node_sends_is_known_to_be_its_own(context, open_monitor, wait_until):
    watch = open_monitor("list")
    node = Node("a", context=context)
    small, large = node.create_publisher(String, "small"), node.create_publisher(String, "large")
    message = String()
    small.publish(message)
    message.data = "x" * 200_000
    large.publish(message)

    def seen():
        watch.receive(0.05)
        return {"/small", "/large"} <= {t.channel for t in watch.graph().traffic}

    wait_until(seen)
    graph = watch.settle(foreign=False)
    assert graph.topic("/small").foreign == ()
    assert graph.topic("/large").foreign == ()
    assert graph.topic("/large").traffic[0].sender == graph.topic("/small").traffic[0].sender


def test_a_program_that_is_no_node_is_waited_for(open_monitor, start_python, bus_url):
    program = start_python(
        """
import sys, time, lcm
bus = lcm.LCM(sys.argv[1])
bus.publish("EXAMPLE", b"payload\\0")
print("ready", flush=True)
while True:
    time.sleep(0.6)
    bus.publish("EXAMPLE", b"payload\\0")
""",
        bus_url,
    )
    program.wait_for("ready")
    graph = open_monitor("list").settle()
    assert graph.topic_names() == ["EXAMPLE"]
    (seen,) = graph.topic("EXAMPLE").foreign
    assert seen.sender is not None


def test_every_channel_of_a_program_is_known_not_just_its_first(
    bus_url, start_python, open_monitor
):
    program = start_python(
        """
import sys, time, lcm
bus = lcm.LCM(sys.argv[1])
while True:
    for number in range(10):
        bus.publish(f"CHANNEL_{number}", b"payload\\0")
        print("ready", flush=True)
        time.sleep(0.1)
""",
        bus_url,
    )
    program.wait_for("ready")
    graph = open_monitor("list").settle()
    assert graph.topic_names() == [f"CHANNEL_{number}" for number in range(10)]


@pytest.mark.timing
@pytest.mark.usefixtures("private_network")
def test_nobody_is_waited_for_on_an_empty_bus(stopwatch):
    with BusMonitor(parse_url("udpm://"), "list", os.environ) as watch:
        time_taken = stopwatch()
        assert watch.settle().nodes == ()
        assert time_taken.seconds() < 0.5


def test_a_command_that_listens_is_announced_and_says_goodbye(
    context, open_monitor, bus_url, wait_until
):
    node = Node("a", context=context)
    publisher = node.create_publisher(String, "chatter")
    assert publisher.subscriber_count() == 0
    with BusMonitor(parse_url(bus_url), "echo", os.environ) as echo:
        echo.listen_to(["/chatter"])
        wait_until(lambda: publisher.subscriber_count() == 1)
        other = open_monitor("list")
        other.probe()

        def answered():
            echo.receive(0.02)
            other.receive(0.02)
            return len(other.graph().nodes) == 2

        wait_until(answered)
        (tool,) = [n for n in other.graph().nodes if n.tool]
        assert tool.is_hidden
        assert tool.name.startswith("/_lcmtools_echo_")
        assert "/chatter" in other.graph().topic_names()  # for the publisher's sake
    wait_until(lambda: publisher.subscriber_count() == 0)


def test_a_command_that_only_looks_is_silent(open_monitor):
    other = open_monitor("list")
    with ExitStack() as stack:
        watch = stack.enter_context(open_monitor("info"))
        watch.settle(foreign=False)
    assert not any(p.channel == NODE_CHANNEL for p in other.receive(0.1))


def test_packets_come_as_they_are_pulled_until_the_time_is_over(open_monitor, bus_url, stopwatch):
    watch = open_monitor("hz")
    plain = lcm.LCM(bus_url)
    for number in range(5):
        plain.publish("N", b"%d" % number)
    before, time_taken = time.monotonic(), stopwatch()
    packets = [p for p in watch.packets(0.2) if p.channel == "N"]
    assert [packet.payload for packet in packets] == [b"0", b"1", b"2", b"3", b"4"]
    assert time.monotonic() - before > 0.15
    assert time_taken.seconds() < 1.0
    plain.publish("N", b"6")
    assert next(p for p in watch.packets() if p.channel == "N").payload == b"6"


@pytest.mark.usefixtures("private_network")
def test_a_watch_goes_on_while_the_network_is_gone(bus_url, ip, wait_until):
    with BusMonitor(parse_url(bus_url), "test", os.environ) as watch:
        ip("link", "set", "lo", "down")
        watch.listen_to(["/chatter"])  # announced when there is a network again
        assert watch.receive(0.0) == []
        ip("link", "set", "lo", "up")
        ip("route", "add", "224.0.0.0/4", "dev", "lo")
        with BusMonitor(parse_url(bus_url), "other", os.environ) as other:

            def is_seen():
                watch.receive(0.1)  # in which it announces itself each second
                return other.settle(foreign=False).nodes

            wait_until(is_seen)
            (node,) = other.graph().nodes
        assert [endpoint.topic for endpoint in node.endpoints] == ["/chatter"]
        ip("link", "set", "lo", "down")
        # and leaving without one is no error either


def test_a_watch_that_was_held_up_still_hears_who_has_answered(bus_url, context, monkeypatch):
    Node("talker", context=context)
    with BusMonitor(parse_url(bus_url), "test", os.environ) as watch:
        receive = watch.receive

        def be_held_up(_timeout):
            time.sleep(0.4)  # longer than a look ever takes
            monkeypatch.setattr(watch, "receive", receive)
            return []

        monkeypatch.setattr(watch, "receive", be_held_up)
        assert [node.name for node in watch.settle(foreign=False).nodes] == ["/talker"]
