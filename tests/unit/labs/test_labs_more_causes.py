"""Causes of rows that are not ok: formulas, keys, directions, pictures; no processes."""

import functools
import math
import statistics
from dataclasses import replace
from types import SimpleNamespace

import PIL.Image
import pytest

from lcmtools.labs.checks import dolly, viewer
from lcmtools.labs.checks.diagnosis import explain_number, misplaced, slip
from lcmtools.labs.checks.evaluation import (
    Sample,
    average_cause,
    average_rows,
    error_cause,
    root_mean_square,
    wrong_averages,
)
from lcmtools.labs.checks.observations import Failure, ReceivedMessage, Touch
from lcmtools.labs.checks.step_response import Step, StepRun, judge
from lcmtools.labs.checks.teleop import (
    DRIVING_KEYS,
    KeyPress,
    change_result,
    check_teleop,
    key_cause,
    key_result,
    speeds_result,
)
from lcmtools.labs.checks.viewer import picture_cause
from lcmtools.labs.nodes.driving.motion import Motion
from lcmtools.messages.pictures import Picture
from lcmtools.messages.pixels import Kind
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import Image, LaserScan

GOAL = 0.3, 0.4
"""The velocity that an evaluator is to compare a robot at rest with; the error is 0.5."""


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        (0.0, "always 0"),
        (0.25, "the square, without the root"),
        (0.3, "the error of linear.x only"),
        (0.7, "the sum |v - desired v| + |w - desired w|"),
        (0.4, "the error of angular.z only"),
        (-0.5, "the negative error"),
        (-0.3, "the negative error of linear.x only"),
        (0.35, "the mean of both errors"),
        (math.sqrt(0.125), "the root of the mean of both squares"),
        (3.0, ""),
    ],
)
def test_the_formula_of_an_error_is_recognised(measured, words):
    assert error_cause(measured, GOAL) == words


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        (math.hypot(0.2, 0.2), ""),  # the right one is explained by no mistake
        (0.5, "the length of the desired velocity, without the measured one"),
        (math.hypot(0.5, 0.2), "the length of the measured velocity, without the desired one"),
        (1.0, "made of the sum of both velocities, not of their difference"),
        (math.hypot(0.1, -0.1), "made with linear.x and angular.z exchanged"),
        (0.2, "the error of linear.x only"),
    ],
)
def test_the_formula_of_an_error_of_a_moving_robot_is_recognised(measured, words):
    assert error_cause(measured, GOAL, (0.5, 0.2)) == words


ERRORS = [0.5] * 6 + [0.0] * 6
"""Those of a robot at rest, before and after its desired velocity is 0."""


@pytest.mark.parametrize(
    ("average", "words"),
    [
        (lambda e: sum(e) / len(e), "the mean of the errors"),
        (lambda e: sum(x * x for x in e) / len(e), "the mean of the squares, without the root"),
        (sum, "the sum, not divided by the samples"),
        (
            lambda e: sum(x * x for x in e),
            "the sum of the squares, without the mean and the root",
        ),
        (
            lambda e: math.sqrt(sum(x * x for x in e)),
            "the root of the sum of the squares, not of their mean",
        ),
        (
            lambda e: math.sqrt(sum(x * x for x in e)) / len(e),
            "the root of the sum of the squares, divided by the samples outside of the root",
        ),
        (
            lambda e: math.sqrt(sum(x * x for x in e) / (len(e) - 1)) if e[1:] else 0.0,
            "divided by the samples minus 1",
        ),
        (
            lambda e: math.sqrt(sum(x * x for x in e) / (len(e) + 1)),
            "divided by the samples plus 1",
        ),
        (lambda e: e[-1], "the last error alone"),
        (lambda e: e[-1] / len(e), "the last error, divided by the samples"),
        (max, "the greatest error"),
        (statistics.pstdev, "the standard deviation"),
        (lambda e: math.sqrt(sum(e) / len(e)), "the root of the mean of the errors"),
        (
            lambda e: functools.reduce(lambda value, x: (value + x) / 2, e, 0.0),
            "the mean of the last average and the newest error",
        ),
        (
            lambda e: functools.reduce(lambda a, x: (a + x[1]) / x[0], enumerate(e, 1), 0.0),
            "the last average and the newest error, divided by the samples",
        ),
        (lambda _: 0.0, "always 0"),
        (
            lambda e: 0.6 * math.sqrt(sum(x * x for x in e) / len(e)),
            "the root of the mean square of the error of linear.x only",
        ),
        (
            lambda e: 1.4 * sum(e) / len(e),
            "the mean of the sum |v - desired v| + |w - desired w|",
        ),
        (lambda e: 3.0 + len(e), ""),
    ],
)
def test_the_formula_of_an_average_is_recognised(average, words):
    averages = [average(ERRORS[:number]) for number in range(1, len(ERRORS) + 1)]
    differences = [GOAL if error else (0.0, 0.0) for error in ERRORS]
    assert wrong_averages(averages, differences)
    assert average_cause(averages, differences) == words


def test_the_root_mean_square_is_right_and_an_average_of_the_samples_so_far():
    averages = [root_mean_square(ERRORS[:number]) for number in range(1, len(ERRORS) + 1)]
    differences = [GOAL if error else (0.0, 0.0) for error in ERRORS]
    assert wrong_averages(averages, differences) == []
    assert wrong_averages([*averages[:-1], 0.5], differences) == [len(ERRORS) - 1]


def test_each_part_of_the_averages_is_judged_by_its_own():
    stats = [
        ControllerEvaluationStat(samples=n, last_error=e, average_error=math.sqrt(0.25 * 6 / n))
        for n, e in enumerate(ERRORS, 1)
    ]
    samples = [
        Sample(stat, [(GOAL if stat.last_error else (0.0, 0.0), (0.0, 0.0))]) for stat in stats
    ]
    assert [row.is_ok for row in average_rows(samples, 6)] == [False, True]
    stats[-1].average_error = 0.5
    assert [row.is_ok for row in average_rows(samples, 6)] == [False, False]


def test_a_number_that_no_formula_gives_is_not_explained():
    assert explain_number(0.7, {"half": 0.35}) == ""
    assert explain_number(0.351, {"half": 0.35}) == "half"


def twist(forward, turn_rate, sideways=0.0):
    message = Twist()
    message.linear.x, message.angular.z, message.linear.y = forward, turn_rate, sideways
    return message


def presses(change):
    motion, found = Motion(0.5, 1.0), {}
    for key in DRIVING_KEYS:
        motion = motion.after(key)
        wanted = motion.forward, motion.turn_rate
        found[key] = KeyPress(key, wanted, change(key, *wanted))
    return found


@pytest.mark.parametrize(
    ("change", "is_ok", "cause"),
    [
        (lambda _, v, w: twist(v, w), True, ""),
        (lambda _, v, w: twist(v, 57.3 * w), False, "angular.z is in rad/s, not in degrees"),
        (lambda _, v, w: twist(-v, w), False, "wrong sign of speed: forward is linear.x above 0"),
        (lambda _, v, w: twist(v, -w), False, "wrong sign of turn: left is angular.z above 0"),
        (
            lambda k, v, w: twist(v, w) if k != "i" else twist(0, 0),
            False,
            "'i' stops the robot: is it in the program's table of keys, in lower case?",
        ),
    ],
)
def test_the_speeds_of_the_basic_keys(change, cause, *, is_ok):
    row = speeds_result(presses(change))
    assert row.is_ok is is_ok
    assert is_ok or row.hint == cause


@pytest.mark.parametrize(
    ("got", "measured", "words"),
    [
        (None, "nothing comes", "nothing is published for 'u': is each key read at once, and"),
        (twist(0, 0), "+0.000 m/s, +0.000 rad/s", "'u' stops the robot"),
        (twist(0.5, -1.0), "+0.500 m/s, -1.000 rad/s", "'u' does what 'o' should do (forward to"),
        (twist(0.5, 0.7), "+0.500 m/s, +0.700 rad/s", "compare 'u' with the table of keys"),
    ],
)
def test_a_key_with_another_command_has_its_row(got, measured, words):
    drives = presses(lambda k, v, w: got if k == "u" else twist(v, w))
    row = key_result(drives["u"], "u  forward to the left", drives)
    assert (row.is_ok, row.measured) == (False, measured)
    assert row.hint.startswith(words)
    assert key_cause(drives["u"], drives).text == row.hint


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"changes": False}, "'u' changes nothing: is it in the program's table of keys, in lower"),
        ({"as_capital": True}, "'U' does it, and 'u' does not: the keys are lower-case letters"),
    ],
)
def test_a_key_that_is_not_known_is_not_taken_for_another_one(facts, words):
    drives = presses(lambda k, v, w: twist(0.5, -1.0) if k == "u" else twist(v, w))
    press = replace(drives["u"], **facts)
    assert key_result(press, "u  forward to the left", drives).hint.startswith(words)


@pytest.mark.parametrize(
    ("printed", "title", "measured"),
    [
        ("ahead 5.05 m, left 7.82 m, nearest 3.25", "ahead, left, nearest", "they are"),
        ("[INFO] front: 5.1", "ahead", "they are"),
        ("ahead 7.82 m", "ahead", "ahead 7.82, which is ranges[150], 29 degrees left"),
        ("Distance in front is inf", "ahead", "ahead inf, which is ranges[0], 57 degrees right"),
        ("left inf, right 7.82", "left, right", "left inf, which is ranges[0], 57 degrees right"),
        ("closest = 5.05", "nearest", "nearest 5.05, which is ranges[90], 6 degrees right"),
        ("speed ahead 0.50, 7.82", "", ""),
        ("7.82 m, ahead", "", ""),
    ],
)
def test_the_direction_that_is_printed_with_a_range_is_that_of_its_beam(printed, title, measured):
    ranges = [math.inf] * 60 + [3.25] * 12 + [math.inf] * 18 + [5.05] * 40 + [8.1] * 20
    scan = LaserScan(angle_min=-1.0, angle_increment=0.01, ranges=[*ranges, *[7.82] * 50])
    ranges[65] = 3.2
    rows = list(dolly.direction_rows(printed, scan))
    assert [(row.what, row.measured) for row in rows] == (
        [(f"prints what is {title}", measured)] if title else []
    )
    assert all(row.is_ok is (measured == "they are") for row in rows)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        ("'Vector3' object has no attribute 'w'", "the angular part of a Twist has no w"),
        ("'geometry_msgs::Vector3' has no member named \u2018w\u2019", "has no w"),
        (
            "no matching function for call to 'M::create_publisher(const char [15], int)'",
            "create_publisher<geometry_msgs::Twist>(...)",
        ),
        ("no matching function for call to 'make_shared()'", "std::make_shared<MovingRobot>()"),
        ("'Vector3' object has no attribute 'q'", ""),
    ],
)
def test_a_slip_of_the_printed_texts_is_answered(error, words):
    assert words in slip(error)
    assert words or not slip(error)


@pytest.mark.parametrize(
    ("before", "words"),
    [
        (twist(0.5, 1.0), "'q' should change the speeds by 10 % and keep the motion"),
        (twist(0.5, 0.2), "compare 'u' with the table of keys in the lab"),  # 'u' itself is wrong
    ],
)
def test_a_key_that_changes_no_speed_is_told_by_the_one_before(before, words):
    drives = presses(lambda k, v, w: before if k == "u" else twist(v, w))
    press = KeyPress("u", (0.55, 1.1), before)
    assert change_result(press, "u  after q, both 10 % more", drives).hint == words


def test_a_first_key_that_brings_a_twist_of_0_is_asked_for_once():
    """The robot does not move, although something is published: the key is not in the table."""
    commands = []
    program = SimpleNamespace(
        code=None,
        press=lambda _: commands.append(ReceivedMessage(0.0, "/RosAria/cmd_vel", Twist())),
    )
    recorder = SimpleNamespace(commands=commands, record_command=lambda _: None)
    bench = SimpleNamespace(
        recorder=recorder, start=lambda *_, **__: program, wait=lambda condition, _: condition()
    )
    (row,) = check_teleop(bench, ["teleop"])
    assert (row.what, row.wanted, row.measured) == (
        "answers to i",
        "a speed above 0",
        "a Twist of 0",
    )
    assert row.hint == "'i' stops the robot: is it in the program's table of keys, in lower case?"


BLOCKS = ("abcdabcc", "bbadcadb", "cabcddab", "dcbaabca")
"""Blocks of 20 columns and 30 rows, each of one of four depths."""


def depth_image():
    """Return a picture of the blocks, with depths from 1 to 4 m."""
    image = Image()
    image.width, image.height, image.step, image.encoding = 160, 120, 320, "16UC1"
    image.data = b"".join(
        (1000 * (1 + "abcd".index(BLOCKS[row // 30][column // 20]))).to_bytes(2, "little")
        for row in range(120)
        for column in range(160)
    )
    image.data_length = len(image.data)
    return image


def grey(image):
    depths = [int.from_bytes(image.data[i : i + 2], "little") for i in range(0, 2 * 160 * 120, 2)]
    picture = PIL.Image.new("L", (160, 120))
    picture.putdata([255 - depth // 25 for depth in depths])
    return picture


@pytest.mark.parametrize(
    ("turn", "words"),
    [
        (PIL.Image.Transpose.FLIP_TOP_BOTTOM, "the picture is upside down: rows go from the top"),
        (PIL.Image.Transpose.FLIP_LEFT_RIGHT, "the picture is mirrored: columns go from the left"),
        (PIL.Image.Transpose.ROTATE_180, "the picture is turned by 180 degrees"),
        (PIL.Image.Transpose.ROTATE_90, "width and height are exchanged: it is 160 wide, 120 high"),
    ],
)
def test_a_picture_that_is_turned_is_recognised(turn, words):
    truth = depth_image()
    shown = Picture(grey(truth).transpose(turn), "L", Kind.GREY)
    assert picture_cause(truth, shown).startswith(words)


def test_a_picture_that_is_black_or_unlike_is_told_apart():
    truth = depth_image()
    black = Picture(PIL.Image.new("L", (160, 120)), "L", Kind.GREY)
    assert picture_cause(truth, black).startswith("the picture is all black: is it the data")
    noise = PIL.Image.effect_noise((160, 120), 80)
    assert picture_cause(truth, Picture(noise, "L", Kind.GREY)) == ""


@pytest.mark.parametrize(
    ("shade", "contrast", "is_ok"),
    [(lambda one: one, 120, True), (lambda one: 255 - one // 12, 10, False)],
)
def test_a_picture_in_which_near_and_far_hardly_differ_is_not_right(
    tmp_path, monkeypatch, shade, contrast, *, is_ok
):
    monkeypatch.setattr(
        viewer, "first", lambda _, has_come, __, row: replace(row, is_ok=has_come())
    )
    truth = depth_image()
    grey(truth).point(shade).save(tmp_path / "picture.png")
    bench = SimpleNamespace(
        folder=tmp_path,
        recorder=SimpleNamespace(record=lambda *_: [truth]),
        start=lambda *_: None,
        wait=lambda condition, _: condition(),
    )
    *others, row = viewer.check_viewer(bench, ["viewer"])
    assert all(other.is_ok for other in others)
    assert (row.what, row.measured, row.is_ok) == ("has contrast", f"{contrast}", is_ok)


def test_a_dolly_that_does_not_drive_as_commanded_says_so():
    right = twist(0.5, 0.3)
    assert "do commands keep coming?" in dolly.circle_cause(None, [], right).text
    assert "before the previous one expires" in dolly.circle_cause(1.2, [], right).text
    assert "speed and turn rate are exchanged" in dolly.circle_cause(0.6, [], twist(0.3, 0.5)).text


@pytest.mark.parametrize(
    ("printed", "found", "words"),
    [
        ("3.36", ["3.36"], "it prints only once"),
        ("3360 3310 5050", [], "it prints millimetres"),
        ("[336.0, 331.0, 505.0]", [], "it prints centimetres"),
        ("hello 17", [], "print some of scan.ranges with two decimals"),
    ],
)
def test_ranges_that_are_printed_otherwise_are_recognised(printed, found, words):
    assert words in dolly.ranges_cause(printed, [3.36, 3.31, 5.05, math.inf], found).text


def test_a_step_without_odometry_asks_for_the_simulator():
    run = StepRun(Step(0.5, 0.0), [], [])
    assert not run.is_over()
    assert judge(run).hint == "does the simulator still run?"


def test_an_exception_without_a_message_is_its_name():
    assert str(Failure("KeyboardInterrupt", place="a.py:3")) == "KeyboardInterrupt (a.py:3)"


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


def test_a_twist_for_a_robot_on_wheels_has_two_fields():
    assert misplaced(twist(0.5, 0.3)) is None
    found = misplaced(twist(0.5, 0.3, sideways=0.1))
    assert found is not None
    assert "it sets linear.y" in found.text
