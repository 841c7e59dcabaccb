"""Distances from a path, and their causes, on drives that are made up. Metres, seconds."""

import math

import pytest

from lcmtools.labs.checks.observations import ReceivedMessage, Touch, TrueState
from lcmtools.labs.checks.path import DrivenPath, drive_cause, judge
from lcmtools.types.geometry_msgs import Twist

ROUND = [(2 * math.sin(a / 20), 2 - 2 * math.cos(a / 20)) for a in range(126)]
"""Nearly a whole circle to the left, 12.5 m long."""


def drive_along(states):
    """Drive through places with a speed and a turn rate, ten a second."""
    drive = DrivenPath(ROUND)
    for number, state in enumerate(states):
        drive.add(TrueState(number / 10, *state))
    return drive


def circle(radius, part=1.0):
    """A drive around the path's middle."""
    angles = [math.tau * part * n / 300 for n in range(299)]
    return [(radius * math.sin(a), 2 - radius * math.cos(a), 0.4, 0.2) for a in angles]


@pytest.mark.parametrize(("radius", "offset"), [(2.0, 0.0), (1.9, 0.1), (2.2, -0.2)])
def test_a_robot_that_keeps_its_distance_strays_by_it(radius, offset):
    drive = drive_along(circle(radius))

    assert drive.length == pytest.approx(12.5, abs=0.01)
    assert drive.along == pytest.approx(12.5, abs=0.1)
    assert drive.farthest[1] == pytest.approx(offset, abs=0.002)
    assert drive.mean == pytest.approx(abs(offset), abs=0.002)


def test_a_closed_path_is_not_over_at_its_start():
    drive = drive_along(circle(2.0, 0.05))

    assert not drive.is_over(29.8)
    assert drive.along == pytest.approx(0.05 * math.tau * 2, abs=0.05)


@pytest.mark.parametrize("piece", [0.5, 1.0, 4.0])
def test_a_path_of_long_pieces_is_followed_piece_by_piece(piece):
    drive = DrivenPath([(piece * n, 0.0) for n in range(round(8 / piece) + 1)])
    for number in range(81):
        drive.add(TrueState(number / 10, number / 10, -0.05, 1.0, 0.0))

    assert drive.along == drive.length == pytest.approx(8.0)
    assert {round(offset, 9) for _, offset in drive.offsets} == {-0.05}


def test_a_robot_that_rests_far_from_the_end_is_not_waited_for():
    drive = drive_along([(0, 0, 0, 0)] * 20)

    assert not drive.is_over(7.9)
    assert drive.is_over(8.1)


def test_a_robot_that_creeps_is_not_waited_for():
    drive = drive_along([(n / 500, 0, 0.02, 0) for n in range(120)])  # 0.02 m/s for 12 s

    assert drive.along == pytest.approx(0.24, abs=0.01)
    assert drive.is_over(11.9)


def test_a_good_drive_is_as_specified_in_all_rows():
    rows = list(judge(drive_along(circle(1.95)), []))

    assert [row.is_ok for row in rows] == [True, True, True]
    assert rows[1].measured.startswith("0.05 m to the left, at (")
    assert rows[2].measured == "0.050 m"


@pytest.mark.parametrize(
    ("states", "key"),
    [
        ([(0, 0, 0, 0)] * 10, "no-motion"),
        ([(-n / 10, 0, -0.4, 0) for n in range(12)], "speed-sign"),
        ([(n / 10, -n * n / 100, 0.4, -0.5) for n in range(12)], "turn-sign"),
        (circle(2.0, 0.5), "stops"),
        (circle(2.4), "strays"),
        ([*circle(2.0, 0.5), (0, 2.9, 0.4, 0.2), (0, 2.7, 0.4, 0.2)], "strays"),  # a bend cut
        ([(0.2 * (n % 2), 0, 0.4, 5.2 * (-1) ** (n // 4)) for n in range(12)], "unit"),
        ([(0.1 * n, 0, 0.4, 0.2 if n < 11 else -5.0) for n in range(20)], "wrap"),
        ([(0.04 * n, -0.2 * (n > 2), 0.4, -5.0) for n in range(20)], "turn-sign"),
    ],
)
def test_the_cause_is_told_by_the_places(states, key):
    assert drive_cause(drive_along(states), []).key == key


def test_what_the_robot_touches_is_the_first_cause():
    cause = drive_cause(drive_along(circle(2.4)), [Touch(3.0, "table1", 1.66, 0.5)])

    assert cause.text == "the robot touches table1 at (1.7, 0.5)"


def test_commands_that_no_robot_could_follow_are_a_wrong_unit_or_gain():
    command = Twist()
    command.angular.z = 57.3
    commands = [ReceivedMessage(0.0, "/RosAria/cmd_vel", command)]
    drive = drive_along(circle(2.0, 0.1))

    assert drive_cause(drive, []).key == "stops"
    cause = drive_cause(drive, [], commands)
    assert cause.key == "unit"
    assert "or orientation.z the heading? That is 2*atan2(z, w)" in cause.text
