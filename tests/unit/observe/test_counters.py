"""Rates and durations of callbacks, from two looks at the counters."""

import pytest

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.observe.measuring.counters import (
    Counters,
    average_rate,
    busy_share,
    callback_time,
    duration_text,
)
from lcmtools.observe.reports import node_report
from lcmtools.wire.packet import Sender

SECOND = 1_000_000_000
ENDPOINT = Endpoint("/a", Role.SUBSCRIBER, calls=10, busy=500)
NODE = NodeInfo("/n", "n", "h", 1, sent=5 * SECOND, busy=SECOND)


@pytest.mark.parametrize(
    ("calls", "busy", "mean"),
    [(14, 540, 10), (15, 720, 48), (10, 540, 40), (10, 500, None), (14, 500, None), (3, 600, None)],
)
def test_a_callback_takes_what_it_took_between_two_looks(calls, busy, mean):
    assert callback_time(ENDPOINT, ENDPOINT._replace(calls=calls, busy=busy)) == mean


@pytest.mark.parametrize(
    ("span", "busy", "share"),
    [(1.0, 0.25, 0.25), (1.0, 0.0, 0.0), (1.0, 1.5, 1.0), (0.1, 0.05, None), (1.0, -0.5, None)],
)
def test_a_node_is_busy_for_a_part_of_the_time_between_its_announcements(span, busy, share):
    later = NODE._replace(
        sent=NODE.sent + round(span * SECOND), busy=NODE.busy + round(busy * SECOND)
    )
    assert busy_share(NODE, later) == share


def test_a_node_that_does_not_say_when_it_sent_is_not_judged():
    assert busy_share(NODE._replace(sent=0), NODE) is None


@pytest.mark.parametrize(
    ("nanoseconds", "text"),
    [
        (0, "0 ms"),
        (12_345, "0.012 ms"),
        (1_240_000, "1.2 ms"),
        (9_960_000, "10 ms"),
        (250_000_000, "250 ms"),
        (999_600_000, "1 s"),
        (2_500_000_000, "2.5 s"),
        (5_000 * SECOND, "5000 s"),
    ],
)
def test_times_are_short_for_people(nanoseconds, text):
    assert duration_text(nanoseconds) == text


def _counted(messages, last):
    return Endpoint("/a", Role.PUBLISHER, messages=messages, last_time=round(last * SECOND))


def test_a_counted_rate_is_exact_however_short_the_look_was():
    assert _counted(8, 100.1).rate_since(_counted(7, 100.0)) == pytest.approx(10)
    assert _counted(12, 101.0).rate_since(_counted(7, 100.0)) == pytest.approx(5)


def test_where_nothing_was_counted_there_is_no_rate():
    assert _counted(7, 100.0).rate_since(_counted(7, 100.0)) is None
    assert _counted(1, 100.0).rate_since(_counted(0, 0)) is None
    assert _counted(1, 101.0).rate_since(_counted(9, 100.0)) is None


def test_an_average_rate_is_from_the_nodes_start_to_its_last_message():
    node = NodeInfo("/a", "id", "host", 1, start_time=90 * SECOND)
    assert average_rate(node, _counted(20, 100.0)) == pytest.approx(2)
    assert average_rate(node, _counted(1, 100.0)) is None
    assert average_rate(node, _counted(5, 80.0)) is None


def test_the_announced_rate_counts_where_one_look_has_to_do():
    known = _counted(7, 100.0)._replace(rate=2.5)
    node = NodeInfo("/a", "id", "host", 1, endpoints=(known, known._replace(topic="/b", rate=0.0)))
    counters = Counters(Graph((node,)), Graph((node,)))
    assert counters.to_json(node, known)["rate"] == 2.5
    assert counters.to_json(node, node.endpoints[1])["rate"] is None
    assert "rate: 2.50 Hz" in counters.of_endpoint(node, known)


def test_of_a_publisher_that_counts_nothing_is_told_what_was_seen():
    sender, end = Sender("127.0.0.1", 4000), Endpoint("/a", Role.PUBLISHER)
    node = NodeInfo("/a", "id", "host", 1, endpoints=(end,), sender=sender)
    seen = Traffic("/a", sender, (), 12, 96, 98 * SECOND, 99 * SECOND)
    counters = Counters(Graph((node,)), Graph((node,), (seen,), time=100 * SECOND))
    assert "seen messages: 12, bytes: 96" in counters.of_endpoint(node, end)
    assert "last: 1.0 s ago" in counters.of_endpoint(node, end)


@pytest.mark.parametrize("role", [Role.PUBLISHER, Role.SUBSCRIBER])
def test_counts_of_an_endpoint_that_counts_nothing_are_not_known(role):
    end = Endpoint("/a", role)
    node = NodeInfo("/a", "id", "host", 1, endpoints=(end, end._replace(topic="/b", depth=5)))
    counters = Counters(Graph((node,)), Graph((node,), time=100 * SECOND))
    text, other = (counters.of_endpoint(node, one) for one in node.endpoints)
    assert text == "messages: not known (its program does not count them)"
    assert "messages: 0, bytes: 0" in other
    assert " * /a: messages: not known" in "\n".join(
        node_report.to_lines(node, Graph(), 0, [], show_hidden=True)
    )
    record, zero = (counters.to_json(node, one) for one in node.endpoints)
    for name in ("messages", "bytes", "drops", "incomplete"):
        assert (record[name], zero[name]) == (None, 0)


def test_what_a_simulator_announced_when_its_sensor_became_idle_is_no_rate():
    imu = _counted(40, 100.0)._replace(rate=5.4)
    step = Endpoint("/sim/step", Role.SERVICE, ("sim_msgs/Step_Request",))
    sim = NodeInfo("/sim", "id", "host", 1, start_time=90 * SECOND, endpoints=(imu, step))
    ear = NodeInfo("/ear", "ear", "host", 2, endpoints=(Endpoint("/a", Role.SUBSCRIBER),))

    def shown(*nodes, before=None):
        was = sim._replace(endpoints=(before, step)) if before else sim
        counters = Counters(Graph((was,)), Graph(nodes, time=101 * SECOND))
        record = counters.to_json(nodes[0], imu)
        return counters.of_endpoint(nodes[0], imu), record["rate"], record["average_rate"]

    text, *numbers = shown(sim)
    assert "idle: it publishes only while something subscribes, last: 1.0 s ago" in text
    assert "Hz" not in text
    assert numbers == [None, None]
    assert shown(sim, ear)[1:] == (5.4, None)
    assert "rate: 50.00 Hz" in shown(sim, before=_counted(35, 99.9))[0]
    assert shown(sim._replace(is_recorded=True))[1] == 5.4


@pytest.mark.parametrize(
    ("last", "messages", "now", "is_steady"),
    [
        (99.99, 30, 100.6, True),  # 50 Hz
        (95.0, 30, 100.6, False),  # idle for five seconds before
        (99.1, 1, 100.1, True),  # 1 Hz
        (99.1, 2, 101.1, True),
        (40.0, 1, 100.1, False),  # the first one after a minute
        (40.0, 2, 100.1, False),
    ],
)
def test_a_rate_is_not_counted_over_a_pause(last, messages, now, *, is_steady):
    was, end = _counted(7, last), _counted(7 + messages, now)
    assert end.is_steady_since(was, 100 * SECOND, SECOND) is is_steady
