"""The causes of wrong velocities: by keys, and by the Dolly's timer; and of wrong ranges."""

import math

import pytest

from lcmtools.labs.checks import dolly
from lcmtools.labs.checks.diagnosis import misplaced
from lcmtools.labs.checks.driving_keys import DRIVING_KEYS, KeyPress, key_cause
from lcmtools.labs.checks.observations import Touch
from lcmtools.labs.nodes.driving.motion import Motion
from lcmtools.types.geometry_msgs import Twist


def twist(forward, turn_rate, **others):
    message = Twist()
    message.linear.x, message.angular.z = forward, turn_rate
    message.linear.y = others.get("sideways", 0.0)
    return message


def presses(change):
    motion, found = Motion(0.5, 1.0), {}
    for key in DRIVING_KEYS:
        motion = motion.after(key)
        wanted = motion.forward, motion.turn_rate
        found[key] = KeyPress(key, wanted, change(key, *wanted))
    return found


@pytest.mark.parametrize(
    ("change", "key", "cause", "words"),
    [
        (lambda _, v, w: twist(v, -w), "u", "turn-sign", "wrong sign of turn: left is angular.z"),
        (lambda _, v, w: twist(-v, w), "i", "speed-sign", "wrong sign of speed"),
        (
            lambda k, v, w: twist(v, -w if k in "jl" else w),
            "j",
            "key-jl",
            "'j' does what 'l' should do (right on the spot): the keys are mixed up",
        ),
        (lambda _, v, w: twist(0, w, sideways=v), "i", "field", "it sets linear.y"),
        (lambda k, v, w: twist(v, w) if k != "o" else twist(0, 0), "o", "key-o", "'o' stops"),
        (lambda k, v, w: None if k == "o" else twist(v, w), "o", "unanswered", "nothing is publ"),
    ],
)
def test_the_cause_of_a_wrong_key_is_named(change, key, cause, words):
    drives = presses(change)
    found = key_cause(drives[key], drives)
    assert (found.key, words in found.text) == (cause, True), found


@pytest.mark.parametrize(
    ("message", "key"),
    [
        (twist(-0.5, 0.3), "speed-sign"),
        (twist(0.5, -0.3), "turn-sign"),
        (twist(0.3, 0.5), "exchanged"),
        (twist(0.5, 17.2), "unit"),
        (twist(0.0, 0.3, sideways=0.5), "field"),
        (twist(0.4, 0.3), "velocity"),
    ],
)
def test_the_cause_of_a_wrong_velocity_is_named(message, key):
    assert dolly.velocity_cause(message).key == key
    assert dolly.circle_cause(1.0, [], message).key == key or key == "speed-sign"


def test_a_rate_of_0_has_its_reason():
    assert "one command came, and no other for 8.0 s" in dolly.rate_cause(1, 0.0, 8.0).text
    assert "9 commands came, and then none for 5.0 s" in dolly.rate_cause(9, 2.0, 5.0).text
    assert "too seldom, every 1 s" in dolly.rate_cause(8, 1.0, 0.5).text
    assert "too often, every 0.1 s" in dolly.rate_cause(8, 10.0, 0.0).text


def test_a_circle_that_ended_at_a_thing_says_at_which():
    cause = dolly.circle_cause(9.0, [Touch(3.0, "shed", 5.0, -0.01)], twist(0.5, 0.3))
    assert "stuck on shed, at (5.0, 0.0) m" in cause.text


def test_ranges_in_another_unit_are_recognised():
    ranges = [3.36, 3.31, 5.05, math.inf]
    cause = dolly.ranges_cause("[336.0, 331.0, 505.0]", ranges, [])
    assert cause.text.startswith("it prints centimetres")
    assert dolly.ranges_cause("hello 17", ranges, []).key == "ranges"


def test_a_twist_for_a_robot_on_wheels_has_two_fields():
    assert misplaced(twist(0.5, 0.3)) is None
    found = misplaced(twist(0.5, 0.3, sideways=0.1))
    assert found is not None
    assert "it sets linear.y" in found.text
