"""When a relay may begin to carry: relays between a robot's bus and a line to an office."""

from dataclasses import replace

from lcmtools.graph.relay_report import End, Link, State
from lcmtools.relay.hold import Hold


def _relay(name, here="", there="", state=State.STANDBY):
    """A relay that hears one end on the robot's bus, and one over the line; "" for none."""
    one, other = (
        End(f"{name}/{number}", heard=(heard,) if heard else ())
        for number, heard in enumerate((here, there))
    )
    return Link(name, f"/{name}", "robot", (one, other), state)


def _hold(now=100.0):
    return Hold(["own/1"], now)


def test_it_waits_for_a_moment_to_hear_of_others():
    hold = _hold()
    hold.update((_relay("own"),), frozenset({"own"}), 100.1)
    assert hold.lasts(100.5)
    assert not hold.lasts(101.0)


def test_who_hears_a_relay_beside_it_and_none_over_the_line_waits_for_the_line():
    hold = _hold()
    beside = _relay("beside", "own/0", "office/1", State.ACTIVE)
    for time in (100.1, 102.0, 104.9):
        hold.update((_relay("own", "beside/0"), beside), frozenset({"own", "beside"}), time)
        assert hold.lasts(time)
        assert hold.awaited(time) == ("own/1" if time > 101.0 else "")
    assert not hold.awaited(105.1)
    assert not hold.lasts(105.1)  # nobody is there, or the connection would have ended by now


def test_it_does_not_wait_for_a_bus_that_is_no_line():
    hold = _hold()
    hold.update((_relay("own", there="office/1"),), frozenset({"own"}), 100.1)
    assert not hold.lasts(101.0)


def test_a_line_that_falls_silent_is_waited_for_from_then_on():
    hold = _hold()
    beside = _relay("beside", "own/0", "office/1", State.ACTIVE)
    hold.update((_relay("own", "beside/0", "office/1"), beside), frozenset({"beside"}), 200.0)
    assert not hold.lasts(200.0)
    hold.update((_relay("own", "beside/0"), beside), frozenset({"own", "beside"}), 203.0)
    assert hold.lasts(204.9)
    hold.begin(204.0)  # it was lost, and is back
    assert hold.lasts(208.9)
    hold.update((_relay("own", "beside/0", "office/1"), beside), frozenset({"own"}), 206.0)
    assert hold.lasts(207.1)  # for what the other one has sent
    assert not hold.lasts(207.3)


def test_what_a_relieved_relay_has_sent_comes_first():
    hold = _hold()
    own, beside = _relay("own", "beside/0", "office/1"), _relay("beside", "own/0", "office/1")
    carries = replace(beside, state=State.ACTIVE)
    hold.update((own, carries), frozenset({"beside"}), 200.0)
    hold.update((own, carries), frozenset({"own"}), 300.0)
    hold.update((own, beside), frozenset({"own"}), 300.1)
    assert hold.lasts(301.1)
    assert not hold.lasts(301.3)


def test_one_that_has_left_or_is_gone_is_not_waited_for():
    own = _relay("own", "beside/0", "office/1")
    left = _relay("beside", "own/0", "office/1", State.LEFT)
    for links in ((own, left), (own,)):
        hold = _hold()
        hold.update((own, replace(left, state=State.ACTIVE)), frozenset({"beside"}), 200.0)
        hold.update(links, frozenset({"own"}), 300.0)
        assert not hold.lasts(300.0)
