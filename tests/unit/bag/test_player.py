"""When the messages of a log are due: rates, pauses, seeking and loops, on a clock set by hand."""

import math

import pytest

from lcmtools.bag.player import Player, press
from lcmtools.bag.playlist import Played
from lcmtools.terminal import DOWN, ESCAPE, LEFT, RIGHT, UP

S = 1_000_000_000
START = 1_795_000_000 * S


def at(*seconds):
    return [Played(START + round(time * S), "/a", str(time).encode()) for time in seconds]


def player(messages, length=10.0, **options):
    def between(start, end):
        return (one for one in messages if start <= one.time <= end)

    return Player(between, (START, START + round(length * S)), **options)


def played(one, now):
    """The times in the log of what is due until then [s]."""
    found = []
    while message := one.pop_due(round(now * S)):
        found.append((message.time - START) / S)
    return found


@pytest.mark.parametrize(("rate", "last"), [(1.0, 2.0), (2.0, 4.0), (0.5, 1.0)])
def test_a_message_is_due_by_its_time_in_the_log(rate, last):
    one = player(at(last), rate=rate, now=5 * S)
    assert one.wait(5 * S) == 2.0
    assert one.pop_due(7 * S - 1) is None
    assert played(one, 7.0) == [last]
    assert one.is_over


def test_delays_do_not_add_up():
    one = player(at(1, 2, 3))
    assert played(one, 1.05) == [1]
    assert one.wait(round(1.05 * S)) == 0.95
    assert played(one, 2.0) == [2]


def test_after_a_long_delay_the_rest_is_postponed():
    one = player(at(1, 1.01, 2))
    assert played(one, 5.0) == [1]
    assert one.wait(5 * S) == pytest.approx(0.01)
    assert played(one, 5.01) == [1.01]


def test_at_once_nothing_waits():
    one = player(at(1, 5, 9), rate=0.0)
    assert one.wait(0) == 0
    assert played(one, 0) == [1, 5, 9]
    assert one.position(0)[:2] == (9.0, 10.0)


def test_a_pause_holds_the_time_in_the_log():
    one = player(at(1, 2))
    one.pause(S // 2)
    assert (played(one, 50), one.wait(50 * S)) == ([], float("inf"))
    assert one.position(50 * S) == (0.5, 10.0, 1.0, True)
    one.resume(60 * S)
    assert one.wait(60 * S) == 0.5
    assert played(one, 60.5) == [1]


def test_a_step_plays_the_next_message_and_pauses():
    one = player(at(1, 4, 5))
    assert one.step(0) == at(1)[0]
    assert one.is_paused
    assert one.step(0) == at(4)[0]
    one.resume(0)
    assert one.wait(0) == 1.0
    assert one.step(0) == at(5)[0]
    assert one.is_over


def test_another_rate_counts_from_now_on():
    one = player(at(3))
    one.set_rate(2.0, S)
    assert one.wait(S) == 1.0
    assert one.time(round(1.5 * S)) == START + 2 * S


def test_going_somewhere_else_in_the_log():
    one = player(at(*range(10)))
    one.seek_part(0.5, 100 * S)
    assert (played(one, 100.0), played(one, 101.0)) == ([5], [6])
    one.seek_by(-3.0, 101 * S)
    assert played(one, 101.0) == [3]
    one.seek_by(-100.0, 101 * S)
    assert played(one, 101.0) == [0]
    one.seek_by(100.0, 101 * S)
    assert one.is_over


def test_a_loop_begins_again_when_the_last_message_is_due():
    one = player(at(1, 3), 3.0, loops=True)
    assert played(one, 1) == [1]
    assert played(one, 3.05) == [3]
    assert one.wait(4 * S - S // 10) == pytest.approx(0.1)
    assert played(one, 4) == [1]
    one.seek_part(1.0, 4 * S)
    one.pop_due(4 * S)
    assert not one.is_over


def test_time_that_did_not_count_is_made_no_burst_of():
    one = player(at(1, 1.05, 1.09))
    one.postpone(60 * S)
    assert played(one, 60.5) == []
    assert played(one, 61.0) == [1]


def test_a_window_without_messages_is_over():
    assert player([]).is_over


@pytest.mark.parametrize(
    ("keys", "position"),
    [
        ([" "], (5.0, 1.0, True)),
        ([" ", " "], (5.0, 1.0, False)),
        ([RIGHT], (10.0, 1.0, False)),
        ([LEFT, LEFT], (0.0, 1.0, False)),
        (["]"], (65.0, 1.0, False)),
        (["]", "["], (5.0, 1.0, False)),
        ([UP, UP], (5.0, 4.0, False)),
        ([DOWN], (5.0, 0.5, False)),
        ([DOWN] * 20, (5.0, 1 / 64, False)),
        ([UP] * 20, (5.0, 64.0, False)),
        (["7"], (70.0, 1.0, False)),
        (["."], (6.0, 1.0, True)),
        (["s"], (6.0, 1.0, True)),
        (["x", "é"], (5.0, 1.0, False)),
    ],
)
def test_keys(keys, position):
    one = player(at(*range(6, 100)), 100.0)
    for key in keys:
        assert press(one, key, 5 * S)[0]
    seconds, _, rate, is_paused = one.position(5 * S)
    assert (seconds, rate, is_paused) == position


@pytest.mark.parametrize("key", ["q", ESCAPE])
def test_a_key_ends(key):
    assert press(player(at(1)), key, 0) == (False, None)


def test_a_quiet_stretch_is_skipped():
    one = player(at(1, 100, 101), 200.0)
    assert played(one, 1.0) == [1]
    one.skip(2 * S)
    assert played(one, 2.0) == [100]
    assert played(one, 3.0) == [101]
    one = player(at(1, 100), 200.0, is_paused=True)
    one.skip(S)
    assert one.wait(S) == math.inf
