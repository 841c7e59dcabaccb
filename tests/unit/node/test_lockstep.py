"""Answers to the steps of a recording that is played to nodes."""

import threading

import pytest

from lcmtools import Node, spin_once
from lcmtools.bus.base import LOCKSTEP
from lcmtools.bus.step_bus import DONE_CHANNEL, STEP_CHANNEL
from lcmtools.clock import split_stamp
from lcmtools.messages.codec import encode
from lcmtools.node.lockstep import DONE, STEP
from lcmtools.node.timer import NEVER
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.std_msgs import Float64

_SECOND = 10**9
_START = 5 * _SECOND


@pytest.fixture
def node(begin):
    """A node that is played to from the fifth second on."""
    return Node("played_to", context=begin(environment={LOCKSTEP: str(_START)}))


def answers(bus):
    return [DONE.unpack(payload) for channel, payload in bus.published if channel == DONE_CHANNEL]


def step(bus, number, time=None):
    """Send a step, after a time if one is given."""
    if time is not None:
        clock = Clock()
        clock.clock.sec, clock.clock.nsec = split_stamp(time)
        bus.deliver("/clock", encode(clock))
    bus.deliver(STEP_CHANNEL, STEP.pack(number))


def test_a_step_is_answered_after_all_callbacks_and_what_they_published(node, bus):
    publisher = node.create_publisher(Float64, "/out")
    node.create_subscription(Float64, "/in", publisher.publish)
    for data in (1.0, 2.0):
        bus.deliver("/in", encode(Float64(data=data)))
    step(bus, 7)
    spin_once(node)
    assert answers(bus) == []
    spin_once(node)
    assert answers(bus) == [(7, NEVER)]
    sent = [channel for channel, _ in bus.published if channel in ("/out", DONE_CHANNEL)]
    assert sent == ["/out", "/out", DONE_CHANNEL]


def test_timers_follow_the_clock_and_the_answer_has_the_next_one(node, bus):
    times = []
    node.create_timer(0.5, lambda: times.append(node.get_clock().now()))
    assert node.get_clock().now() == _START
    for number, time in enumerate((_START, _START + _SECOND // 2, _START + _SECOND)):
        step(bus, number, time)
        spin_once(node)
        spin_once(node)
    assert times == [_START + _SECOND // 2, _START + _SECOND]
    half = _SECOND // 2
    assert answers(bus) == [(n, _START + (n + 1) * half) for n in range(3)]


def test_a_loop_with_a_rate_waits_for_the_clock(node, bus):
    rate = node.create_rate(4.0)
    ended = threading.Thread(target=rate.sleep)
    ended.start()
    while node.callbacks.awaited is None:
        pass
    assert node.callbacks.next_due() == _START + _SECOND // 4
    step(bus, 1, _START + _SECOND // 4)
    ended.join()
    assert node.callbacks.next_due() == NEVER


def test_the_last_of_several_threads_that_spin_answers(node, bus):
    other = Node("other", context=node.context)
    for number, one in enumerate((node, other), 1):
        one.callbacks.spinning_thread = number
    other.create_subscription(Float64, "/in", lambda _: None)
    bus.deliver("/in", encode(Float64()))
    step(bus, 1)
    spin_once(node)  # it is idle while the other has work
    spin_once(other)
    assert answers(bus) == []
    spin_once(other)
    assert answers(bus) == [(1, NEVER)]


def test_a_node_that_runs_as_usual_answers_nothing(begin):
    assert begin().lockstep is begin(environment={LOCKSTEP: ""}).lockstep is None
