"""The schedule of announcements, on a clock of the test's own."""

from lcmtools.graph.announcing import Announcing
from lcmtools.graph.protocol import PERIOD, Probe


def _settled():
    """A schedule after its first announcement, at 0.0 s."""
    schedule = Announcing(-1.0)
    assert schedule.take(0.0) == {"": 0}
    schedule.rest(0.0, 0.0)
    return schedule


def test_nodes_are_announced_each_period_and_soon_after_a_change():
    schedule = _settled()
    assert schedule.due() == PERIOD
    assert schedule.take(0.5 * PERIOD) == {}
    schedule.change(0.2)
    assert 0.2 < schedule.due() < 0.21
    assert schedule.take(0.21) == {"": 0}
    assert schedule.due() == 0.21 + PERIOD


def test_who_asks_is_answered_with_the_last_nonce_and_without_waiting_for_a_rest():
    schedule = _settled()
    schedule.rest(0.0, 0.05)
    schedule.rest(0.0, 0.05)  # of half a second
    schedule.change(0.0)
    assert schedule.due() == 0.5
    for nonce in (1, 2, 0):
        schedule.ask(Probe("/a", nonce), 0.1)
    schedule.ask(Probe("/b", 3), 0.1)
    assert schedule.take(0.1) == {"/a": 2, "/b": 3}
    assert schedule.due() == 0.5


def test_answers_take_a_tenth_of_the_time():
    schedule = _settled()
    for nonce in (1, 2):
        schedule.ask(Probe("/a", nonce), 0.0)
        assert schedule.take(0.0) == {"/a": nonce}
        schedule.rest(0.0, 0.01)
    schedule.ask(Probe("/a", 3), 0.0)
    assert schedule.take(0.0) == {}
    assert schedule.due() == 0.1
    assert schedule.take(0.1) == {"/a": 3}


def test_two_probes_of_all_before_the_answer_get_two():
    schedule = _settled()
    for _ in range(5):
        schedule.ask(Probe(), 0.1)
    assert [schedule.take(0.1) for _ in range(3)] == [{"": 0}, {"": 0}, {}]
