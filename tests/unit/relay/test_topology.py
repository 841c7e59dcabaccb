"""Which relays carry messages: every small network of buses and relays."""

from dataclasses import replace
from itertools import combinations, product

import pytest

from lcmtools.graph.relay_report import End, Link, Report, State, decode_report, encode_report
from lcmtools.relay.topology import KnownRelays, StartDelay, carrying

SECOND = 1_000_000_000


def _links(pairs):
    """Relays that join these buses, each hearing all others on its buses."""
    at = [(relay, side, bus) for relay, pair in enumerate(pairs) for side, bus in enumerate(pair)]

    def end(relay, side, bus):
        heard = [f"{r}/{s}" for r, s, b in at if b == bus and (r, s) != (relay, side)]
        return End(f"{relay}/{side}", heard=tuple(heard))

    return [
        Link(str(relay), f"/r{relay}", "host", (end(relay, 0, pair[0]), end(relay, 1, pair[1])))
        for relay, pair in enumerate(pairs)
    ]


def _parts(pairs):
    """The connected part that each bus is in."""
    part = {bus: bus for bus in range(4)}
    for _ in pairs:
        for one, other in pairs:
            part[one] = part[other] = min(part[one], part[other])
    return part


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_carrying_relays_connect_all_that_relays_can_and_make_no_circle(count):
    buses = list(product(range(4), repeat=2)) if count < 4 else list(combinations(range(4), 2))
    for pairs in product(buses, repeat=count):
        active = [pairs[int(relay)] for relay in carrying(_links(pairs))]
        whole, chosen = _parts(list(pairs)), _parts(active)
        for relays in (whole, chosen):
            for _ in range(4):
                relays.update({bus: relays[part] for bus, part in relays.items()})
        assert whole == chosen, pairs
        assert len(active) == 4 - len(set(chosen.values())), pairs  # a forest


def test_the_oldest_of_parallel_relays_carries():
    assert carrying(_links(((0, 1), (0, 1), (1, 0)))) == {"0"}


def test_a_relay_that_carries_goes_on_when_an_older_one_is_back():
    older, younger = _links(((0, 1), (0, 1)))
    assert carrying([older, replace(younger, state=State.ACTIVE)]) == {"1"}
    both = [replace(one, state=State.ACTIVE) for one in (older, younger)]
    assert carrying(both) == {"0"}  # neither has heard of the other before


def test_one_of_a_ring_stands_by():
    assert carrying(_links(((0, 1), (1, 2), (2, 0)))) == {"0", "1"}


def test_both_ends_on_one_bus_carry_nothing():
    assert carrying(_links(((0, 0),))) == set()


def test_it_is_enough_that_one_of_two_hears_the_other():
    one, other = _links(((0, 1), (0, 1)))
    deaf = replace(one, ends=tuple(replace(end, heard=()) for end in one.ends))
    assert carrying([deaf, other]) == {"0"}


def test_a_relay_with_a_bus_that_is_down_or_that_left_makes_way():
    one, other = _links(((0, 1), (0, 1)))
    down = replace(one, ends=(one.ends[0], replace(one.ends[1], is_up=False)))
    assert carrying([down, other]) == {"1"}
    assert carrying([replace(one, state=State.LEFT), other]) == {"1"}


def test_a_report_comes_back_as_it_was():
    end = End("a/0", "udpm://", ("b/1",), (7, 8), is_up=False, trouble="down", lost=5)
    link = Link("a", "/r", "host", (end, End("a/1")), State.ACTIVE, 9)
    report = Report("a/0", (link,))
    decoded = decode_report(encode_report(report))
    assert decoded == report
    assert isinstance(decoded.links[0].ends[0].ports, tuple)  # as JSON needs it
    assert decode_report(b"nothing") is None


def _known(pairs, own):
    bare = [
        replace(one, ends=tuple(replace(end, heard=()) for end in one.ends))
        for one in _links(pairs)
    ]
    return KnownRelays(bare[own])


def test_relays_learn_of_each_other_by_reports_over_several_buses():
    pairs = ((0, 1), (1, 2), (2, 3), (3, 0))
    known = [_known(pairs, own) for own in range(4)]
    for _ in range(4):  # rounds of reports
        for relay, side in product(range(4), (0, 1)):
            known[relay].update(State.STANDBY, known[relay].own.ends)
            report = Report(f"{relay}/{side}", known[relay].links())
            for other, there in product(range(4), (0, 1)):
                if pairs[other][there] == pairs[relay][side]:
                    known[other].add_report(report, f"{other}/{there}", SECOND)
    assert {one.carrying() for one in known} == {frozenset({"0", "1", "2"})}


def test_a_silent_relay_is_forgotten_and_one_that_left_at_once():
    other = _links(((0, 1), (0, 1)))[0]
    known = _known(((0, 1), (0, 1)), 1)
    report = Report("0/0", (replace(other, number=1),))
    assert known.add_report(report, "1/0", SECOND)
    assert known.add_report(report._replace(end="0/1"), "1/1", SECOND)
    assert known.carrying() == {"0"}
    assert not known.add_report(report, "1/0", SECOND)  # nothing new
    assert not known.expire(4 * SECOND)
    assert known.expire(4 * SECOND + 1)
    assert known.carrying() == {"1"}
    left = replace(other, number=2, state=State.LEFT)
    known.add_report(report._replace(links=(replace(other, number=1),)), "1/0", 9 * SECOND)
    known.add_report(report._replace(links=(left,)), "1/0", 9 * SECOND)
    late = report._replace(links=(replace(other, number=1),))
    known.add_report(late, "1/1", 9 * SECOND)
    assert known.carrying() == {"1"}


def test_relays_do_not_keep_a_dead_one_alive_by_telling_each_other_of_it():
    pairs = ((0, 1), (0, 1), (0, 1))
    dead = replace(_links(pairs)[0], number=7)
    one, other = _known(pairs, 1), _known(pairs, 2)
    for at, known in ((1, one), (2, other)):
        known.add_report(Report("0/0", (dead,)), f"{known.own.id}/0", at * SECOND)
    for second in range(3, 10):  # each forgets it while the other has it still
        for known, teller in ((one, other), (other, one)):
            known.expire(second * SECOND + 1)
            known.update(State.STANDBY, known.own.ends)
            report = Report(f"{teller.own.id}/0", teller.links())
            known.add_report(report, f"{known.own.id}/0", second * SECOND + 1)
    assert "0" not in {link.id for link in (*one.links(), *other.links())}
    back = replace(dead, number=8)
    assert one.add_report(Report("0/0", (back,)), "1/0", 10 * SECOND)


def test_an_end_that_is_heard_on_both_buses_may_fall_silent():
    pairs = ((0, 1), (0, 1))
    known = _known(pairs, 0)
    report = Report("1/0", (replace(_links(pairs)[1], number=1),))
    known.add_report(report, "0/0", 0)
    known.add_report(report, "0/1", SECOND)  # by a forwarder, or a stranger
    known.expire(3 * SECOND + 1)
    assert [end.heard for end in known.own.ends] == [(), ("1/0",)]
    known.expire(5 * SECOND)
    assert [end.heard for end in known.own.ends] == [(), ()]


def _own(here="", there=""):
    """A relay that hears one end on the robot's bus, and one over the line; "" for none."""
    one, other = (
        End(f"own/{number}", heard=(heard,) if heard else ())
        for number, heard in enumerate((here, there))
    )
    return Link("own", "/own", "robot", (one, other))


@pytest.mark.parametrize(
    ("here", "there", "until", "awaited"),
    [
        ("", "", 100.7, ""),
        ("beside/0", "", 105.0, "own/1"),  # who is parallel may answer over the line yet
        ("", "office/1", 100.7, ""),  # the other bus is no line
        ("beside/0", "office/1", 100.7, ""),
    ],
)
def test_a_relay_waits_for_others_and_longer_for_those_over_a_line(here, there, until, awaited):
    delay = StartDelay(["own/1"], 100.0)
    delay.update(_own(here, there), 100.1)
    assert delay.lasts(until - 0.1)
    assert delay.awaited(until - 0.1) == awaited
    assert not delay.lasts(until + 0.1)


def test_a_line_that_falls_silent_is_waited_for_from_then_on():
    delay = StartDelay(["own/1"], 100.0)
    delay.update(_own("beside/0", "office/1"), 200.0)
    assert not delay.lasts(200.0)
    delay.update(_own("beside/0"), 203.0)
    assert delay.lasts(204.9)
    delay.begin(204.0)  # it was lost, and is back
    assert delay.lasts(208.9)
    delay.update(_own("beside/0", "office/1"), 206.0)
    assert not delay.lasts(206.0)
