"""The dead man's switch."""

import math

from lcmtools.gui.dead_man import HOLD, STOP_GAP, DeadMansSwitch

A, B = 1, 2


def test_a_topic_is_stopped_once_when_it_is_let_go_then_silent() -> None:
    switch = DeadMansSwitch()
    assert switch.drive(A, "/v", 0.0) == ""
    assert list(switch.stops_due(0.1)) == []
    switch.release(A, "/v", 0.2)
    assert switch.next_time == 0.2
    assert list(switch.stops_due(0.2)) == ["/v"]
    assert switch.next_time == math.inf
    assert list(switch.stops_due(9.0)) == []


def test_a_page_that_is_silent_for_too_long_is_stopped() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    switch.drive(A, "/v", 0.3)
    assert switch.next_time == 0.3 + HOLD
    assert list(switch.stops_due(0.3 + HOLD / 2)) == []
    assert list(switch.stops_due(0.3 + HOLD)) == ["/v"]
    assert list(switch.stops_due(9.0)) == []


def test_stops_are_repeated_where_one_may_be_lost() -> None:
    switch = DeadMansSwitch(stops=3)
    switch.drive(A, "/v", 0.0)
    switch.release(A, "/v", 1.0)
    assert list(switch.stops_due(1.0)) == ["/v"]
    assert list(switch.stops_due(1.0)) == []
    assert switch.next_time == 1.0 + STOP_GAP
    assert list(switch.stops_due(1.0 + STOP_GAP)) == ["/v"]
    assert list(switch.stops_due(1.0 + 2 * STOP_GAP)) == ["/v"]
    assert switch.next_time == math.inf


def test_a_new_command_ends_the_repeated_stops() -> None:
    switch = DeadMansSwitch(stops=3)
    switch.drive(A, "/v", 0.0)
    switch.release(A, "/v", 1.0)
    assert list(switch.stops_due(1.0)) == ["/v"]
    assert switch.drive(B, "/v", 1.005) == ""
    assert list(switch.stops_due(1.1)) == []


def test_a_page_that_is_gone_stops_all_that_it_drove() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    switch.drive(A, "/w", 0.0)
    switch.drive(B, "/x", 0.0)
    switch.leave(A, 0.1)
    assert sorted(switch.stops_due(0.1)) == ["/v", "/w"]
    assert switch.next_time == HOLD


def test_the_end_stops_everything() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    switch.drive(B, "/x", 0.0)
    switch.end(0.1)
    assert sorted(switch.stops_due(0.1)) == ["/v", "/x"]


def test_one_page_drives_a_topic_until_it_lets_go() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    assert "another page" in switch.drive(B, "/v", 0.1)
    switch.release(A, "/v", 0.2)
    assert switch.drive(B, "/v", 0.3) == ""


def test_any_page_stops_and_the_one_that_drove_has_to_let_go_first() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    switch.stop(B, "/v", 0.05)
    assert list(switch.stops_due(0.05)) == ["/v"]
    assert "release the controls" in switch.drive(A, "/v", 0.1)
    assert "release the controls" in switch.drive(A, "/v", 0.1 + HOLD / 2)
    assert list(switch.stops_due(0.4)) == []
    switch.release(A, "/v", 0.5)
    assert switch.drive(A, "/v", 0.6) == ""


def test_silence_counts_as_letting_go() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    switch.stop(B, "/v", 0.05)
    assert switch.drive(A, "/v", 0.05 + HOLD) == ""


def test_letting_go_of_what_another_page_drives_is_nothing() -> None:
    switch = DeadMansSwitch()
    switch.drive(A, "/v", 0.0)
    switch.release(B, "/v", 0.1)
    switch.release(B, "/w", 0.1)
    assert list(switch.stops_due(0.1)) == []
    assert switch.drive(A, "/v", 0.2) == ""


def test_a_stop_is_sent_also_where_no_page_drives() -> None:
    switch = DeadMansSwitch()
    switch.stop(A, "/v", 0.0)
    assert list(switch.stops_due(0.0)) == ["/v"]
    assert switch.next_time == math.inf
