"""The mistake in a path follower's angle, on drives of a point that obeys at once. SI units."""

import math
from itertools import cycle, pairwise

import pytest

from lcmtools.labs.checks.observations import ReceivedMessage, Touch, TrueState
from lcmtools.labs.checks.path import DrivenPath, drive_cause
from lcmtools.labs.checks.steering_formula import steering_cause
from lcmtools.types.geometry_msgs import Twist

CORNERS = [(-1, 0), (0.3, 0), (1, 0.9), (0.7, 2), (-0.4, 2.7), (-1.5, 2.2), (-1.9, 1), (-2.8, 0.5),
           (-3.5, -0.6), (-3.1, -1.2), (-1.9, -1), (-1, 0)]  # fmt: skip
PATH = [
    (x0 + part / 10 * (x1 - x0), y0 + part / 10 * (y1 - y0))
    for (x0, y0), (x1, y1) in pairwise(CORNERS)
    for part in range(10)
]
"""A path such as the lab's."""


def right(dx, dy, heading):
    return math.remainder(math.atan2(dy, dx) - heading, math.tau)


def proportional(angle):
    return 0.4, 2.0 * angle


def turn_then_drive(angle):
    return (0.0, math.copysign(0.8, angle)) if abs(angle) > 0.2 else (0.4, angle)


def slow_in_bends(angle):
    return 0.4 * max(0.0, math.cos(angle)), max(-1.5, min(1.5, 2.5 * angle))


def on_a_circle(angle):
    return 0.4, 2.0 * math.sin(angle)


def run(angle, law=proportional, points=PATH, reach=0.4, delays=(0,)):
    """Drive to one point after the other, as long as a check would look on.

    A command comes some periods after the state that it is of; ``delays`` has their numbers, which
    are taken in turn. States that come meanwhile are not used.
    """
    x, y, heading, goal, speed, turn = -1.0, 0.0, 0.0, 0, 0.0, 0.0
    drive, commands, periods = DrivenPath(PATH), list[ReceivedMessage](), cycle(delays)
    left = -1
    for time in (n / 50 for n in range(1500)):
        drive.add(TrueState(time, x, y, speed, turn, heading))
        while goal < len(points) - 1 and math.dist(points[goal], (x, y)) < reach:
            goal += 1
        if left < 0:
            wanted = law(angle(points[goal][0] - x, points[goal][1] - y, heading))
            left = next(periods)
        if left == 0:
            speed, turn = wanted
            twist = Twist()
            twist.linear.x, twist.angular.z = wanted
            commands.append(ReceivedMessage(time, "/RosAria/cmd_vel", twist))
        left -= 1
        # as 2*atan2(z, w) has it
        heading = math.remainder(heading + max(-4.0, min(4.0, turn)) / 50, 2 * math.tau)
        x, y = x + speed / 50 * math.cos(heading), y + speed / 50 * math.sin(heading)
        if drive.is_over(time):
            break
    return [state for state, _ in drive.offsets], commands


MISTAKES = [
    (lambda dx, dy, heading: math.remainder(math.atan(dy / dx) - heading, math.tau), "atan(dy/dx)"),
    (lambda dx, dy, heading: right(dy, dx, heading), "atan2(dx, dy)"),
    (lambda dx, dy, heading: right(dx, dy, math.sin(heading / 2)), "orientation.z in place"),
    (lambda dx, dy, heading: right(dx, dy, heading / 2), "half of the heading"),
    (lambda dx, dy, _: math.atan2(dy, dx), "the direction to the point alone"),
    (lambda dx, dy, heading: right(dx, dy, math.degrees(heading)), "a heading in degrees"),
    (
        lambda dx, dy, h: math.remainder(math.degrees(math.atan2(dy, dx)) - h, math.tau),
        "a direction to the point in degrees",
    ),
]


@pytest.mark.parametrize(
    ("angle", "words", "law"),
    [
        (*mistake, law)
        for mistake, law in zip(MISTAKES, cycle([proportional, on_a_circle]), strict=False)
    ],
    ids=[words for _, words in MISTAKES],
)
def test_a_mistake_in_the_angle_is_named(angle, words, law):
    cause = steering_cause(PATH, *run(angle, law))

    assert cause is not None
    assert cause.key == "angle"
    assert cause.text.startswith(f"its turns fit {words}")


@pytest.mark.parametrize(
    ("angle", "words", "delays"),
    [
        (angle, words, delays)
        for (angle, words), delays in zip(
            MISTAKES, cycle([(1,), (0, 0, 2, 1), (0, 3, 1, 0)]), strict=False
        )
    ],
)
def test_a_mistake_is_named_if_commands_arrive_late(angle, words, delays):
    cause = steering_cause(PATH, *run(angle, delays=delays))
    assert cause is not None
    # which of two angles is in degrees may be unclear
    assert ("in degrees" if "in degrees" in words else words) in cause.text


@pytest.mark.parametrize(
    ("law", "delays"),
    [
        (proportional, (1,)),
        (turn_then_drive, (0, 3, 1, 0)),
        (slow_in_bends, (1,)),
        (on_a_circle, (0, 3, 1, 0)),
    ],
)
def test_a_right_angle_is_no_mistake_if_commands_arrive_late(law, delays):
    assert steering_cause(PATH, *run(right, law, delays=delays)) is None


@pytest.mark.parametrize("law", [proportional, on_a_circle])
def test_exchanged_points_are_named(law):
    cause = steering_cause(PATH, *run(right, law, [(y, x) for x, y in PATH]))

    assert cause is not None
    assert "points whose x and y are exchanged" in cause.text


@pytest.mark.parametrize(
    ("law", "points", "reach"),
    [
        (proportional, PATH, 0.15),
        (turn_then_drive, PATH, 2.0),
        (slow_in_bends, PATH[::-1], 0.5),
        (on_a_circle, PATH[::8], 0.5),
        (turn_then_drive, PATH[::-1], 0.15),
    ],
)
def test_a_right_angle_is_no_mistake(law, points, reach):
    assert steering_cause(PATH, *run(right, law, points, reach)) is None


@pytest.mark.parametrize(
    ("angle", "law"),
    [
        (lambda dx, dy, heading: -right(dx, dy, heading), proportional),  # the wrong sign
        (lambda dx, dy, heading: math.degrees(right(dx, dy, heading)), proportional),
        (lambda *_: 0.0, proportional),  # straight on
        (right, lambda angle: (0.4, 12.0 * angle)),
        (right, lambda angle: (0.5, 0.2 * angle)),
        (right, lambda angle: (0.4, abs(angle))),
        (right, lambda _: (0.4, 0.5)),  # a circle
        (right, lambda _: (0.0, 0.0)),
        (right, lambda _: (0.4, math.nan)),
    ],
    ids=["sign", "degrees", "straight", "hot", "weak", "left", "circle", "rest", "nan"],
)
def test_another_fault_is_no_mistake_in_the_angle(angle, law):
    assert steering_cause(PATH, *run(angle, law)) is None


@pytest.mark.parametrize(
    ("law", "number"),
    [(proportional, 30), (turn_then_drive, 52), (slow_in_bends, 80), (proportional, 109)],
)
def test_a_wrong_goal_is_no_mistake_in_the_angle(law, number):
    assert steering_cause(PATH, *run(right, law, [PATH[number]])) is None


def test_a_second_of_commands_is_too_little_to_tell():
    states, commands = run(MISTAKES[1][0])

    assert steering_cause(PATH, states, commands[:49]) is None
    assert steering_cause(PATH, states[:0], commands) is None


def test_commands_after_the_drive_tell_nothing():
    states, commands = run(MISTAKES[0][0])
    late = [ReceivedMessage(states[-1].time + 1 + n / 50, "", Twist()) for n in range(3000)]
    for one in late:
        assert isinstance(one.message, Twist)
        one.message.angular.z = 0.9

    cause = steering_cause(PATH, states, [*commands, *late])

    assert cause == steering_cause(PATH, states, commands)
    assert cause is not None


def test_the_cause_names_what_is_touched_and_the_mistake():
    states, commands = run(MISTAKES[0][0])
    drive = DrivenPath(PATH)
    for state in states:
        drive.add(state)

    cause = drive_cause(drive, [Touch(3.0, "table1", 1.7, 0.5)], commands)

    assert cause.text.startswith("the robot touches table1 at (1.7, 0.5): its turns fit atan(dy/dx")
    assert cause.key == drive_cause(drive, [], commands).key == "angle"
