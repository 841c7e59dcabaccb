"""The pace of publishers over one look and over several: slower, silent, and what is neither."""

from dataclasses import replace

import pytest
from fixtures.judging import STEP, judge

from lcmtools.doctor.evidence import Evidence, LcmProcess, SenderFacts, Stream
from lcmtools.doctor.memory import Memory
from lcmtools.doctor.rules import traffic
from lcmtools.doctor.rules.pace import is_in_doubt
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.wire.packet import Sender

SECOND = 1_000_000_000
NOW = 1_000_000 * SECOND
ALICE, BOB = Sender("127.0.0.1", 4000), Sender("127.0.0.1", 5000)
START = NOW - 100 * SECOND


def look(number, *rates, pid=7, **values):
    """A look of a second; each rate [Hz] is that of a plain program on /a."""
    end = NOW + number * SECOND
    streams = []
    for sender, rate in zip((ALICE, BOB), rates, strict=False):
        times = tuple(end - round(n * SECOND / rate) for n in range(int(rate), 0, -1))
        streams.append(Stream("/a", sender, "sender.py", times, pid=pid))
    processes = (LcmProcess(pid, "sender.py"),) if pid else ()
    known = {"streams": tuple(s for s in streams if s.times), "processes": processes, **values}
    known = {"graph": Graph(time=end), **known}
    return Evidence("udpm://", listened=1.0, **known)


def watched(*looks):
    """The rules that find something, look by look."""
    memory, found = Memory(), []
    for one in looks:
        evidence = memory.recall(one)
        found.append([finding.rule for finding in judge(evidence) if finding.rule != "no-traffic"])
        memory.remember(evidence)
    return found


@pytest.mark.parametrize(("usual", "now"), [(50, 5), (10, 1), (20, 8)])
def test_a_program_that_became_slow_stays_slow(usual, now):
    looks = [look(n, usual) for n in range(3)] + [look(n, now) for n in range(3, 30)]
    assert watched(*looks) == [[]] * 3 + [["slow-rate"]] * 27


def test_a_program_that_publishes_in_bursts_is_neither_slow_nor_silent():
    def burst(number):
        end = NOW + number * SECOND
        times = tuple(end - (50 - n) * SECOND // 100 for n in range(10))
        return look(number, streams=(Stream("/a", ALICE, "sender.py", times, pid=7),))

    found = watched(*(burst(n) if n % 3 == 0 else look(n) for n in range(30)))
    assert [rules for rules in found[6:] if rules] == []


def test_a_look_goes_on_where_a_program_has_just_stopped():
    stopped = look(1, graph=Graph(time=NOW + 3 * SECOND), streams=look(1, 20).streams)
    assert is_in_doubt(stopped)
    assert not is_in_doubt(look(1, 20))


def test_a_slow_program_that_sends_in_every_other_look_is_told_in_each():
    looks = [look(n, 50) for n in range(3)]
    looks += [look(n, 1) if n % 2 else look(n) for n in range(3, 30)]
    assert watched(*looks)[5:] == [["slow-rate"]] * 25


def test_a_program_that_fell_silent_stays_silent_until_it_publishes_again():
    looks = [look(0, 10), *(look(n) for n in range(1, 20)), look(20, 10)]
    assert watched(*looks) == [[], *([["silent"]] * 19), []]


def test_a_program_that_ended_is_forgotten():
    assert watched(look(0, 10), look(2), look(3, processes=())) == [[], ["silent"], []]


def test_a_sender_without_a_known_process_is_forgotten_after_a_while():
    looks = [look(0, 10, pid=None), look(30, pid=None), look(90, pid=None)]
    assert watched(*looks) == [[], ["silent"], []]


def test_a_stopped_program_is_told_once():
    stopped = (LcmProcess(7, "sender.py", state="T"),)
    found = watched(look(0, 10), look(2, processes=stopped))
    assert found == [[], ["silent"]]  # as one that is stopped, with what wakes it


def test_a_program_that_publishes_once_in_five_seconds_is_neither():
    looks = [look(n, 1) if n % 5 == 0 else look(n) for n in range(40)]
    assert watched(*looks) == [[]] * 40


def test_a_program_that_is_started_again_every_second_competes_with_nobody():
    first, second = look(0, 10).streams[0], look(1, 10).streams[0]
    streams = (replace(first, has_ended=True), replace(second, sender=BOB, name="sender.py 2"))
    assert watched(look(1, streams=streams)) == [[]]
    both = (second, replace(second, sender=BOB, name="sender.py 2"))
    assert watched(look(1, streams=both)) == [["competing-publishers"]]


def test_a_look_goes_on_where_two_programs_may_publish_at_the_same_time():
    first, second = look(1, 1, 1).streams
    second = replace(second, name="other.py")
    assert traffic.is_in_doubt(look(1, streams=(first, second)))
    assert not traffic.is_in_doubt(look(1, streams=(replace(first, has_ended=True), second)))
    assert not traffic.is_in_doubt(look(1, streams=(first,)))


def test_a_plain_program_is_compared_with_its_average_since_its_start():
    facts = SenderFacts(ALICE, "sender.py", messages=5, process_age=100.0, average_rate=45.0)
    finding = _only(look(0, 5, senders=(facts,)))
    assert finding.items == (" * sender.py: 5 Hz in all, and 45 Hz on average since its start",)
    assert watched(look(0, 5, senders=(replace(facts, process_age=1.0),))) == [[]]
    assert watched(look(0, 5, senders=(replace(facts, messages=40),))) == [[]]
    assert watched(look(0, 5, senders=(facts,), own_drops=1)) == [[]], "wtf missed some of them"


def _only(evidence):
    (finding,) = [one for one in judge(evidence) if one.rule != "no-traffic"]
    return finding


def _node(messages, age, now=NOW):
    end = Endpoint("/a", Role.PUBLISHER, messages=messages, last_time=now - round(age * SECOND))
    mouth = Node("/mouth", "m", "h", 1, START, endpoints=(end,), sent=now)
    ear = Node("/ear", "e", "h", 2, endpoints=(Endpoint("/a", Role.SUBSCRIBER),))
    return Graph((ear, mouth), time=now)


def _graphs(before, after):
    return Evidence("udpm://", before=before, graph=after, listened=1.0)


def test_a_node_that_fell_from_ten_messages_a_second_to_one_is_slow():
    evidence = _graphs(_node(990, 0.5, NOW - SECOND), _node(991, 0.5))
    (finding,) = judge(evidence)
    assert finding.items == (" * /mouth: /a, 1 Hz instead of 10.1 Hz",)
    assert not is_in_doubt(evidence)


def test_a_node_that_sent_nothing_during_a_look_is_looked_at_longer():
    before = _node(990, 0.5)
    nodes = (node._replace(sent=NOW + SECOND // 2) for node in before.nodes)  # the same endpoints
    evidence = _graphs(before, Graph(tuple(nodes), time=NOW + SECOND // 2))
    assert is_in_doubt(evidence)


@pytest.mark.parametrize("end", [Endpoint("/clock", Role.PUBLISHER), STEP])
def test_a_simulator_sends_less_of_what_stands_still_and_a_clock_is_judged_apart(end):
    ticks = Stream("/clock", ALICE, "/mouth", (NOW,))
    before, after = (
        graph._replace(nodes=(ear, mouth._replace(endpoints=(*mouth.endpoints, end))))
        for graph in (_node(990, 0.5, NOW - SECOND), _node(991, 0.5))
        for ear, mouth in (graph.nodes,)
    )
    assert "slow-rate" not in {
        one.rule for one in judge(replace(_graphs(before, after), streams=(ticks,)))
    }


def test_a_look_goes_on_where_a_slow_node_may_have_become_slower():
    slow = _graphs(_node(297, 1.5, NOW - SECOND), _node(297, 2.5))  # 3 Hz, and nothing for 2.5 s
    assert judge(slow) == []
    assert is_in_doubt(slow)
    usual = _graphs(_node(297, 0.5, NOW - SECOND), _node(299, 0.6))
    assert not is_in_doubt(usual)
    beat = _graphs(_node(99, 0.5, NOW - SECOND), _node(99, 1.2))  # 1 Hz, a little late
    assert not is_in_doubt(beat)


def test_a_node_that_fell_silent_is_told_without_subscribers_too_but_no_simulator():
    (ear, mouth) = _node(500, 60).nodes
    alone = Evidence("udpm://", graph=Graph((mouth,), time=NOW), listened=1.0)
    assert "silent" in {one.rule for one in judge(alone)}
    clock = Endpoint("/clock", Role.PUBLISHER)
    simulator = mouth._replace(endpoints=(*mouth.endpoints, clock, STEP))
    tick = Stream("/clock", ALICE, "/mouth", (NOW,))
    resting = replace(alone, graph=Graph((simulator,), time=NOW), streams=(tick,))
    assert "silent" not in {one.rule for one in judge(resting)}
    heard = replace(resting, graph=Graph((ear, simulator), time=NOW))
    assert "silent" in {one.rule for one in judge(heard)}


@pytest.mark.parametrize(("now", "rules"), [(1000, set()), (992, {"slow-rate"})])
def test_an_announcement_that_the_bus_has_kept_lacks_its_time(now, rules):
    kept, new = _node(990, 0.05, NOW - SECOND), _node(now, 0.05)
    untimed = kept._replace(nodes=tuple(node._replace(sent=0) for node in kept.nodes))
    found = {one.rule for one in judge(_graphs(untimed, new))}
    assert found == rules


def test_programs_that_have_gone_are_forgotten():
    memory = Memory()
    for number in range(0, 400, 2):
        sender = Sender("127.0.0.1", 10_000 + number)
        end = NOW + number * SECOND
        times = tuple(end - n * SECOND // 20 for n in range(20, 0, -1))
        one = Stream("/a", sender, "sender.py", times, pid=number + 100)
        running = (LcmProcess(number + 100, "sender.py"),)
        evidence = memory.recall(look(number, streams=(one,), processes=running))
        memory.remember(evidence)
    assert memory.count() < 40
