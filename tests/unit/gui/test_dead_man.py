"""The dead man's switch."""

import math

import pytest

from lcmtools.gui.dead_man import HOLD, STOP_GAP, TOO_LATE, Command, DeadMansSwitch

A, B = 1, 2
TWIST, STAMPED = ("geometry_msgs/Twist", 17), ("geometry_msgs/TwistStamped", 18)


def drive(page, topic, now, kind=TWIST, hold=HOLD):
    return Command("drive", page, topic, kind, b"go", b"halt", now + hold)


def release(page, topic=""):
    return Command("release", page, topic)


def stop(page, topic, kind=TWIST):
    return Command("stop", page, topic, kind, b"", b"halt")


def stopped(switch, now):
    """The topics on which a stop is sent."""
    return sorted(one.topic for one in switch.stops_due(now))


def test_a_topic_is_stopped_once_when_it_is_let_go_then_silent():
    switch = DeadMansSwitch()
    assert switch.take(drive(A, "/v", 0.0), 0.0) == ""
    assert stopped(switch, 0.1) == []
    switch.take(release(A, "/v"), 0.2)
    assert switch.next_time == 0.2
    assert stopped(switch, 0.2) == ["/v"]
    assert switch.next_time == math.inf
    assert stopped(switch, 9.0) == []


def test_a_page_that_is_silent_for_too_long_is_stopped():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(drive(A, "/v", 0.3), 0.3)
    assert switch.next_time == 0.3 + HOLD
    assert stopped(switch, 0.3 + HOLD / 2) == []
    assert stopped(switch, 0.3 + HOLD) == ["/v"]
    assert stopped(switch, 9.0) == []


def test_a_command_that_was_late_is_valid_for_less_time_and_one_that_is_too_late_for_none():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0, hold=HOLD - 0.2), 0.0)
    assert switch.next_time == pytest.approx(HOLD - 0.2)
    assert switch.take(drive(A, "/v", 0.1, hold=-0.01), 0.1) == TOO_LATE
    assert switch.next_time == pytest.approx(HOLD - 0.2)


def test_stops_are_repeated_where_one_may_be_lost():
    switch = DeadMansSwitch(stops=3)
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(release(A, "/v"), 1.0)
    assert stopped(switch, 1.0) == ["/v"]
    assert stopped(switch, 1.0) == []
    assert switch.next_time == 1.0 + STOP_GAP
    assert stopped(switch, 1.0 + STOP_GAP) == ["/v"]
    assert stopped(switch, 1.0 + 2 * STOP_GAP) == ["/v"]
    assert switch.next_time == math.inf


def test_a_new_command_ends_the_repeated_stops():
    switch = DeadMansSwitch(stops=3)
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(release(A, "/v"), 0.1)
    assert stopped(switch, 0.1) == ["/v"]
    assert switch.take(drive(B, "/v", 0.105), 0.105) == ""
    assert stopped(switch, 0.2) == []


def test_a_page_that_is_gone_stops_all_that_it_drove():
    switch = DeadMansSwitch()
    for page, topic in ((A, "/v"), (A, "/w"), (B, "/x")):
        switch.take(drive(page, topic, 0.0), 0.0)
    switch.take(release(A), 0.1)
    assert stopped(switch, 0.1) == ["/v", "/w"]
    assert switch.next_time == HOLD


def test_the_end_stops_everything():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(drive(B, "/x", 0.0), 0.0)
    switch.end(0.1)
    assert stopped(switch, 0.1) == ["/v", "/x"]


def test_one_page_drives_a_topic_until_it_lets_go():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    assert "another page" in switch.take(drive(B, "/v", 0.1), 0.1)
    assert "another page" in switch.take(drive(B, "/v", 0.1, STAMPED), 0.1)
    switch.take(release(A, "/v"), 0.2)
    assert switch.take(drive(B, "/v", 0.3), 0.3) == ""


def test_a_stop_has_the_type_of_the_command_whatever_another_page_asks_for():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(drive(B, "/v", 0.1, STAMPED), 0.1)
    switch.take(release(A, "/v"), 0.2)
    assert [one.kind for one in switch.stops_due(0.2)] == [TWIST]


def test_a_stop_by_a_page_with_another_type_is_sent_as_both():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(stop(B, "/v", STAMPED), 0.1)
    assert sorted(one.kind for one in switch.stops_due(0.1)) == [TWIST, STAMPED]


def test_a_page_that_changes_its_type_stops_the_first_when_its_time_is_over():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    assert switch.take(drive(A, "/v", 0.1, STAMPED), 0.1) == ""
    assert [one.kind for one in switch.stops_due(HOLD)] == [TWIST]
    assert [one.kind for one in switch.stops_due(0.1 + HOLD)] == [STAMPED]


def test_any_page_stops_and_the_one_that_drove_has_to_let_go_first():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(stop(B, "/v"), 0.05)
    assert stopped(switch, 0.05) == ["/v"]
    for now in (0.1, 0.1 + HOLD / 2):
        assert "release the controls" in switch.take(drive(A, "/v", now), now)
    assert stopped(switch, 0.4) == []
    switch.take(release(A, "/v"), 0.5)
    assert switch.take(drive(A, "/v", 0.6), 0.6) == ""


def test_silence_counts_as_letting_go():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    switch.take(stop(B, "/v"), 0.05)
    assert switch.take(drive(A, "/v", 0.05 + HOLD), 0.05 + HOLD) == ""


def test_letting_go_of_what_another_page_drives_is_nothing():
    switch = DeadMansSwitch()
    switch.take(drive(A, "/v", 0.0), 0.0)
    for topic in ("/v", "/w", ""):
        switch.take(release(B, topic), 0.1)
    assert stopped(switch, 0.1) == []
    assert switch.take(drive(A, "/v", 0.2), 0.2) == ""


def test_a_stop_is_sent_also_where_no_page_drives():
    switch = DeadMansSwitch()
    switch.take(stop(A, "/v"), 0.0)
    assert stopped(switch, 0.0) == ["/v"]
    assert switch.next_time == math.inf


def test_a_command_is_the_same_after_its_line():
    command = Command("drive", A, "/v\n\udcff", TWIST, b"\0\xff" * 5000, b"", 1.5)
    assert command.line().count(b"\n") == 1
    assert Command.of(command.line()) == command
