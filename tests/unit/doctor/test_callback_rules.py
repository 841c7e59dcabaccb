"""Callbacks that are too slow, and why messages are lost in a node's queue."""

from dataclasses import replace

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import callbacks
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness

MS = 1_000_000
SECOND = 1000 * MS
START = 1_000_000 * SECOND
OF_PARAMETERS = Endpoint("/n/_parameters", Role.SERVICE)


def ear(topic="/scan", depth=10, **values):
    """A subscription that has heard 100 messages, the last one at the start."""
    known = {"messages": 100, "calls": 100, "busy": SECOND, "longest": 90 * MS, "last_time": START}
    return Endpoint(topic, Role.SUBSCRIBER, depth=depth, **{**known, **values})


def later(before, *, rate, calls, busy, drops=0):
    """The same after a second, with so many messages and calls more."""
    return before._replace(
        messages=before.messages + rate,
        last_time=before.last_time + SECOND,
        calls=before.calls + calls,
        busy=before.busy + busy,
        drops=before.drops + drops,
    )


def look(*pairs, timers=0, **values):
    """Two looks at a node with these subscriptions, a second apart."""
    before, after = ((*endpoints, OF_PARAMETERS) for endpoints in zip(*pairs, strict=True))
    node = Node("/n", "n", "h", 1, endpoints=before, sent=START, **values)
    node = node._replace(busy=sum(e.busy for e in before))
    busy = sum(e.busy for e in after) + timers
    now = node._replace(endpoints=after, sent=START + SECOND, busy=busy)
    return Evidence("udpm://x", before=Graph((node,)), graph=Graph((now,)), listened=1.0)


def dropped(evidence):
    (finding,) = judge(evidence, [callbacks.queues_have_room])
    assert not judge(evidence, [callbacks.callbacks_are_quick])  # it is said once
    return finding


def slow(evidence):
    (finding,) = judge(evidence, [callbacks.callbacks_are_quick])
    assert not judge(evidence, [callbacks.queues_have_room])
    assert finding.severity is Severity.WARNING
    return finding


def silent(evidence):
    return not judge(evidence, [callbacks.queues_have_room, callbacks.callbacks_are_quick])


def test_a_quick_callback_is_no_finding():
    scan = ear()
    assert silent(look((scan, later(scan, rate=10, calls=10, busy=800 * MS))))


def test_a_callback_that_takes_all_the_time_between_two_messages_is_named():
    scan = ear()
    finding = slow(look((scan, later(scan, rate=10, calls=10, busy=980 * MS))))
    assert finding.items == (" * /n, /scan: its callback takes 98 ms, messages come every 100 ms",)
    assert finding.remedies == ("let the callback of /scan do less",)


def test_a_callback_that_never_ends_is_named():
    scan = ear(longest=30 * SECOND)
    now = later(scan, rate=10, calls=0, busy=SECOND)
    finding = slow(look((scan, now._replace(longest=31 * SECOND))))
    assert finding.items == (" * /n, /scan: a call of its callback has not ended for 31 s",)
    assert finding.remedies == ("let the callback of /scan of /n do less, and never wait",)
    lossy = later(scan, rate=10, calls=0, busy=SECOND, drops=10)._replace(longest=31 * SECOND)
    finding = dropped(look((scan, lossy)))
    assert finding.items == (
        " * /n lost 10 messages of /scan (depth 10): a call of its callback has not ended for 31 s",
    )
    assert finding.remedies == ("let the callback of /scan of /n do less, and never wait",)


def test_a_long_call_that_was_earlier_does_not_hang_now():
    scan = ear(longest=30 * SECOND)
    finding = slow(look((scan, later(scan, rate=10, calls=0, busy=SECOND))))
    assert finding.items == (" * /n, /scan: its callback takes 1 s, messages come every 100 ms",)


def test_the_first_calls_may_be_slow():
    scan = ear(messages=1, calls=1, busy=0, longest=SECOND)
    assert silent(
        look((scan, later(scan, rate=10, calls=1, busy=930 * MS)))
    )  # what it needs is loaded


def test_a_subscription_of_depth_1_may_leave_messages_out():
    image = ear("/image", depth=1)
    assert silent(look((image, later(image, rate=30, calls=5, busy=500 * MS, drops=25))))


def test_a_callback_that_keeps_its_node_busy_is_named_whatever_the_depth():
    image = ear("/image", depth=1)
    finding = slow(look((image, later(image, rate=30, calls=10, busy=980 * MS, drops=20))))
    assert finding.items == (
        " * /n is in its callbacks 98 % of the time, mostly in the callback of /image",
    )
    assert finding.remedies == ("let the callback of /image of /n do less, and never wait",)


def test_timers_that_let_everything_wait_are_named():
    scan = ear()
    evidence = look((scan, later(scan, rate=1, calls=1, busy=MS)), timers=970 * MS)
    finding = slow(evidence)
    assert finding.items == (" * /n is in its callbacks 97 % of the time, mostly in the timers",)
    assert finding.remedies == ("let the timers of /n do less, and never wait",)


def test_timers_of_a_node_without_subscriptions_may_take_all_the_time():
    assert silent(look((OF_PARAMETERS, OF_PARAMETERS), timers=990 * MS))


@pytest.mark.parametrize(
    ("calls", "busy", "timers", "longest", "why", "remedy"),
    [
        (
            10,
            990 * MS,
            0,
            99 * MS,
            "its callback takes 99 ms, messages come every 50 ms",
            "let the callback of /scan do less, or publish it only every 99 ms",
        ),
        (
            10,
            10 * MS,
            950 * MS,
            90 * MS,
            "its node is in the timers most of the time",
            "let the timers of /n do less, and never wait",
        ),
        (
            0,
            0,
            0,
            90 * MS,
            "no callback has run",
            "let /n call spin(node), or spin_once often",
        ),
        (
            15,
            600 * MS,
            0,
            550 * MS,
            "a call of its callback took 550 ms",
            "let the callback of /scan never wait, or increase the queue depth",
        ),
        (
            15,
            15 * MS,
            0,
            2 * MS,
            "they come in bursts",
            "increase the queue depth of the subscription of /scan",
        ),
    ],
)
def test_lost_messages_have_a_reason(calls, busy, timers, longest, why, remedy):
    scan = ear(longest=longest)
    after = later(scan, rate=20, calls=calls, busy=busy, drops=5)
    finding = dropped(look((scan, after), timers=timers))
    assert finding.items == (f" * /n lost 5 messages of /scan (depth 10): {why}",)
    assert finding.remedies == (remedy,)


def test_another_topic_that_holds_the_node_up_is_named():
    scan, image = ear(depth=3), ear("/image")
    finding = dropped(
        look(
            (scan, later(scan, rate=20, calls=10, busy=20 * MS, drops=5)),
            (image, later(image, rate=2, calls=2, busy=960 * MS)),
        )
    )
    assert finding.items == (
        (
            " * /n lost 5 messages of /scan (depth 3):"
            " its node is in the callback of /image most of the time"
        ),
    )
    assert finding.remedies == ("let the callback of /image of /n do less, and never wait",)


def test_work_that_takes_a_third_of_the_time_at_once_is_named():
    scan, image = ear(), ear("/image", depth=1)
    lossy = scan, later(scan, rate=20, calls=10, busy=20 * MS, drops=5)
    finding = dropped(look(lossy, timers=600 * MS))
    lost = " * /n lost 5 messages of /scan (depth 10): its node was in"
    assert finding.items == (f"{lost} the timers for 600 ms meanwhile",)
    assert finding.remedies == ("let the timers of /n do less, and never wait",)
    slow = later(image, rate=1, calls=1, busy=700 * MS)._replace(longest=700 * MS)
    finding = dropped(look(lossy, (image, slow)))
    assert finding.items == (f"{lost} the callback of /image for 700 ms meanwhile",)
    many_short = slow._replace(longest=90 * MS)
    finding = dropped(look(lossy, (image, many_short)))
    assert finding.items[0].endswith("they come in bursts")


def test_a_look_goes_on_where_a_node_has_lost_many_messages_but_none_now():
    scan = ear(drops=30)
    now = later(scan, rate=20, calls=20, busy=MS)
    assert callbacks.is_in_doubt(look((scan, now)))
    assert not callbacks.is_in_doubt(look((scan, now._replace(drops=35)))), "it is told already"
    once = ear(drops=30, messages=5000)
    assert not callbacks.is_in_doubt(look((once, later(once, rate=20, calls=20, busy=MS))))
    assert not callbacks.is_in_doubt(look((scan, now), tool=True))


def test_two_subscriptions_to_one_topic_are_told_apart():
    quick, lossy = ear(), ear(drops=70)
    evidence = look(
        (quick, later(quick, rate=10, calls=10, busy=MS)),
        (lossy, later(lossy, rate=10, calls=10, busy=MS)),
    )
    assert silent(evidence)


@pytest.mark.parametrize("values", [{"tool": True}, {"stale": Staleness.HANGS}])
def test_commands_and_stale_nodes_are_others_business(values):
    scan = ear()
    assert silent(look((scan, later(scan, rate=10, calls=1, busy=SECOND, drops=5)), **values))


def test_who_had_to_wait_for_a_processor_is_not_to_blame():
    scan = ear()
    evidence = look((scan, later(scan, rate=10, calls=10, busy=980 * MS)))
    assert not silent(replace(evidence, processor_wait=0.2))
    assert silent(replace(evidence, processor_wait=0.4))
    hard = look((scan, later(scan, rate=20, calls=5, busy=900 * MS)))
    assert not silent(replace(hard, processor_wait=0.4))  # it would be too slow anyway


def test_timers_are_blamed_on_a_busy_computer_only_where_they_never_pause():
    scan = ear()
    pair = (scan, later(scan, rate=1, calls=1, busy=MS))
    assert silent(replace(look(pair, timers=970 * MS), processor_wait=0.4))
    assert not silent(replace(look(pair, timers=SECOND), processor_wait=0.4))


def test_a_node_that_does_not_spin_is_told_before_its_queue_is_full():
    fed = ear(messages=6, last_time=9 * SECOND, calls=0, busy=0)
    node = Node("/n", "n", "h", 1, endpoints=(fed,), sent=10 * SECOND)
    evidence = Evidence("udpm://", graph=Graph((node,), time=10 * SECOND), listened=1.0)

    def told(evidence):
        return judge(evidence, [callbacks.callbacks_are_quick])

    (finding,) = told(evidence)
    assert finding.text == "The following nodes do not run their callbacks:"
    assert finding.items == (" * /n has received 6 messages of /scan",)
    assert finding.remedies == ("let /n call spin(node), or spin_once often",)
    for quiet in (
        node._replace(start_time=8 * SECOND),
        node._replace(tool=True),
        node._replace(busy=1),
        node._replace(endpoints=(fed._replace(calls=1),)),
        node._replace(endpoints=(fed._replace(messages=4),)),
    ):
        assert told(replace(evidence, graph=Graph((quiet,), time=10 * SECOND))) == []


@pytest.mark.parametrize(
    ("wait", "depth", "longest", "count"),
    [(0.6, 10, 2, 0), (0.6, 1, 2, 0), (0.6, 10, 550, 0), (0.6, 10, 700, 1), (0.3, 10, 2, 1)],
)
def test_losses_that_a_busy_computer_causes_are_no_finding(wait, depth, longest, count):
    scan = ear(depth=depth)
    now = later(scan, rate=20, calls=10, busy=15 * MS, drops=10)._replace(longest=longest * MS)
    assert not silent(look((scan, now)))
    evidence = replace(look((scan, now)), processor_wait=0.9, waits={1: wait})
    assert len(judge(evidence, [callbacks.queues_have_room])) == count
