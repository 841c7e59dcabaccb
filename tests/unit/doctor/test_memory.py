"""The pace of publishers over several looks: slower, silent, and what is neither."""

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import Evidence, LcmProcess, Stream
from lcmtools.doctor.memory import Memory
from lcmtools.graph.model import Graph
from lcmtools.wire.packet import Sender

SECOND = 1_000_000_000
NOW = 1_000_000 * SECOND
ALICE = Sender("127.0.0.1", 4000)


def look(number, rate=0, pid=7, sender=ALICE, **values):
    """A look of a second, in which a plain program publishes on /a."""
    end = NOW + number * SECOND
    times = tuple(end - round(n * SECOND / rate) for n in range(int(rate), 0, -1))
    streams = (Stream("/a", sender, "sender.py", times, pid=pid),) if times else ()
    processes = (LcmProcess(pid, "sender.py"),) if pid else ()
    known = {"streams": streams, "processes": processes, "graph": Graph(time=end), **values}
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


def test_a_program_that_publishes_once_in_five_seconds_is_neither():
    looks = [look(n, 1) if n % 5 == 0 else look(n) for n in range(40)]
    assert watched(*looks) == [[]] * 40


def test_programs_that_have_gone_are_forgotten():
    memory = Memory()
    for number in range(0, 400, 2):
        sender = Sender("127.0.0.1", 10_000 + number)
        memory.remember(memory.recall(look(number, 20, pid=number + 100, sender=sender)))
    assert memory.count() < 40
