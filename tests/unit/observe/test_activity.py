"""The traffic of channels, from packets: rates, jitter, bandwidth, and silence."""

import pytest

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.observe.channels.activity import Activity, Flow
from lcmtools.wire.packet import Packet, Sender

S = 1_000_000_000
START = 1_795_000_000 * S


def arrived(*times, window=2.0, size=10):
    """An activity after messages on A at some times [s]."""
    activity = Activity(window)
    for time in times:
        activity.add(Packet("A", bytes(size), START + round(time * S)))
    return activity


def flow(activity, now):
    found = activity.flow("A", START + round(now * S))
    assert found is not None
    return found


def test_rate_is_one_over_the_mean_interval_and_jitter_their_spread():
    found = flow(arrived(0, 0.1, 0.3, 0.4), 0.4)
    assert found.rate == pytest.approx(3 / 0.4)
    assert found.jitter == pytest.approx(0.1)
    assert found.bandwidth == pytest.approx(30 / 0.4)
    assert (found.messages, found.bytes, found.last_time) == (4, 40, START + round(0.4 * S))


def test_a_channel_of_which_nothing_has_come_has_no_flow():
    assert arrived().flow("A", START) is None


def test_one_message_is_no_rate_and_two_are_no_jitter():
    first, second = flow(arrived(0), 0), flow(arrived(0, 0.5), 0.5)
    assert (first.messages, first.rate, first.jitter, first.bandwidth) == (1, None, None, None)
    assert (second.rate, second.jitter) == (pytest.approx(2), None)


def test_what_is_older_than_the_window_no_longer_counts():
    slow = [i * 1.0 for i in range(5)]
    fast = [4 + i * 0.1 for i in range(1, 31)]
    activity = arrived(*slow, *fast)
    assert flow(activity, 7.0).rate == pytest.approx(10)
    assert flow(activity, 7.0).messages == 35


def test_without_a_window_everything_counts_and_nothing_is_ever_silent():
    times = [0.0, 1.0, 2.0, 2.1, 2.2]
    found = flow(arrived(*times, window=None), 100.0)
    assert found.rate == pytest.approx(4 / 2.2)
    assert found.jitter == pytest.approx(0.9)


def test_a_slow_channel_keeps_its_rate_between_messages():
    activity = arrived(0, 5, 10, 15)
    assert flow(activity, 19).rate == pytest.approx(0.2)
    assert flow(activity, 29).rate == pytest.approx(0.2)
    assert flow(activity, 31).rate == 0.0


def test_a_channel_falls_silent_and_wakes_again():
    activity = arrived(*(i * 0.1 for i in range(11)))
    assert flow(activity, 3.9).rate == pytest.approx(10)
    assert flow(activity, 4.1) == Flow(11, 110, START + S, 0.0, None, 0.0)
    for i in range(40):
        activity.add(Packet("A", b"", START + 10 * S + i * S // 10))
    assert flow(activity, 13.9).rate == pytest.approx(10)


def test_bandwidth_counts_whole_messages_where_only_heads_came():
    activity = Activity(None)
    for i in range(3):
        activity.add(Packet("A", bytes(8), START + i * S, whole_bytes=1000))
    assert flow(activity, 3).bandwidth == pytest.approx(1000)


def test_times_that_go_back_are_no_harm():
    found = flow(arrived(1.0, 0.5, 1.5), 1.5)
    assert found.rate == pytest.approx(2)
    assert flow(arrived(1.0, 1.0), 1.0).rate is None


def test_clear_begins_again():
    activity = arrived(0, 1)
    activity.clear()
    assert activity.flow("A", START) is None


def test_all_topics_at_once_are_those_one_by_one():
    here, there = Sender("127.0.0.1", 1), Sender("127.0.0.1", 2)
    ends = (Endpoint("/a", Role.PUBLISHER), Endpoint("/b", Role.SUBSCRIBER))
    nodes = (
        NodeInfo("/n", "1", "h", 1, endpoints=ends, sender=here),
        NodeInfo("/m", "2", "h", 2, endpoints=ends[:1]),
        NodeInfo("/_tool", "3", "h", 3, tool=True, endpoints=(Endpoint("/c", Role.SUBSCRIBER),)),
    )
    traffic = tuple(
        Traffic(channel, sender, (7,), 1, 8, 0, 1)
        for channel in ("/a", "/x")
        for sender in (here, there, None)
    )
    graph = Graph(nodes, traffic)
    assert graph.topics() == [graph.topic(name) for name in graph.topic_names()]
    assert [topic.name for topic in graph.topics()] == ["/a", "/b", "/x"]
