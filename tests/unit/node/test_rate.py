"""A rate for loops of one's own."""

import math
import threading

import pytest
from fixtures.says import assert_says, raises_saying

import lcmtools
import lcmtools.types.std_msgs
from lcmtools import Node
from lcmtools.errors import LcmtoolsError


def test_a_rate_keeps_a_loop_going_with_its_callbacks(begin):
    context = begin()
    node, ticks = Node("a"), []
    node.create_timer(0.002, lambda: ticks.append(1))
    rate = node.create_rate(100)
    began = node.callbacks.time()
    for _ in range(5):
        rate.sleep()
    assert node.callbacks.time() - began >= 50_000_000
    assert len(ticks) > 5
    context.stop()
    rate.sleep()  # returns at once


def test_a_rate_follows_simulated_time(begin):
    begin("_use_sim_time:=true")
    from lcmtools.types.rosgraph_msgs import Clock

    node, other = Node("a"), Node("b", tool=True)
    clock = other.create_publisher(Clock, "/clock")
    rate = node.create_rate(10)
    returned = threading.Event()

    def loop():
        rate.sleep()
        returned.set()

    thread = threading.Thread(target=loop)
    thread.start()
    message = Clock()
    for second in range(1, 4):
        assert not (second == 1 and returned.is_set())
        message.clock.sec = second
        clock.publish(message)
    thread.join(timeout=60)
    assert returned.is_set()


def test_a_rate_in_a_callback_is_an_error_and_beside_spin_it_waits(begin):
    context = begin()
    node = Node("a")
    rate = node.create_rate(1000)
    node.create_timer(0.001, rate.sleep)
    thread = threading.Thread(target=lcmtools.spin, args=[node])
    thread.start()
    for _ in range(20):
        rate.sleep()
    context.stop()
    thread.join()
    (error,) = node.describe().errors
    assert_says(error.message, "rate.sleep()", "callback")


@pytest.mark.parametrize("frequency", [0, -1, 1e-320, math.nan, math.inf, "10", None, True])
def test_a_rate_that_is_none_is_refused(begin, frequency):
    begin()
    with raises_saying(LcmtoolsError, "create_rate", "positive", "Hz", "got"):
        Node("a").create_rate(frequency)


def test_a_slow_rate_is_no_timer_that_is_meant_in_milliseconds(begin, capsys):
    begin()
    Node("a").create_rate(0.01)
    assert capsys.readouterr().err == ""
