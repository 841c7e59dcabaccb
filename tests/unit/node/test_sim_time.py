"""Nodes on simulated time: clock, log and timers follow /clock."""

import lcmtools
from lcmtools import Node
from lcmtools.messages.codec import decode, encode
from lcmtools.types.rosgraph_msgs import Clock, Log

_S = 1_000_000_000


def _tell(bus, node, seconds):
    message = Clock()
    message.clock.sec, message.clock.nsec = divmod(round(seconds * _S), _S)
    bus.publish("/clock", encode(message))
    lcmtools.spin_once(node)


def test_the_clock_is_what_the_simulation_says(begin, bus):
    begin("_use_sim_time:=true")
    node = Node("a")
    assert node.get_clock().now() == 0
    _tell(bus, node, 12.000000034)
    assert node.get_clock().now() == 12_000_000_034
    _tell(bus, node, 3.5)
    assert node.get_clock().now() == 3_500_000_000


def test_the_clock_is_global_whatever_the_namespace(begin, bus):
    begin("_use_sim_time:=true", "__ns:=/husky0")
    node = Node("a")
    _tell(bus, node, 1.0)
    assert node.get_clock().now() == _S


def test_the_log_is_stamped_with_simulated_time(begin, bus, capsys):
    begin("_use_sim_time:=true")
    node = Node("a")
    _tell(bus, node, 7.25)
    node.get_logger().info("x")
    assert capsys.readouterr().err == "[INFO] [7.250000000] [/a]: x\n"
    (entry,) = [decode(Log, payload) for channel, payload in bus.published if channel == "/rosout"]
    assert (entry.header.stamp.sec, entry.header.stamp.nsec) == (7, 250_000_000)


def test_timers_follow_simulated_time(begin, bus):
    begin("_use_sim_time:=true")
    node, called = Node("a"), []
    _tell(bus, node, 100.0)
    node.create_timer(1.0, lambda: called.append(node.get_clock().now() / _S))
    assert node.callbacks.time_to_timer() is None  # only a message can bring work
    for tenth in range(1000, 1031, 4):
        _tell(bus, node, tenth / 10)
    assert called == [101.2, 102.0]
    _tell(bus, node, 103.2)
    assert called == [101.2, 102.0, 103.2]


def test_timers_go_on_when_the_simulation_starts_again(begin, bus):
    begin("_use_sim_time:=true")
    node, called = Node("a"), []
    _tell(bus, node, 100.0)
    node.create_timer(1.0, lambda: called.append(node.get_clock().now() / _S))
    for seconds in (101.0, 0.1, 0.9, 1.1, 2.1):
        _tell(bus, node, seconds)
    assert called == [101.0, 1.1, 2.1]


def test_without_simulated_time_the_clock_is_the_computers(begin, bus):
    begin()
    node = Node("a")
    _tell(bus, node, 1.0)
    assert node.get_clock().now() > 1_600_000_000 * _S
    assert "/clock" not in {e.topic for e in node.describe().endpoints}
