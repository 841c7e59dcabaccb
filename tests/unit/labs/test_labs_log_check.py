"""A lab's checks on recorded runs that are made up: what they judge, and what they cannot."""

import json

import pytest
from fixtures.drives import STEPS, Drive, dolly, husky, pioneer, twist

from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.messages.codec import encode
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools.wire.packet import Packet


@pytest.fixture
def check(tmp_path, capsys):
    path = tmp_path / "run.lcmlog"

    def run(lab, fill):
        with LogWriter(path, force=True) as log:
            fill(log)
        code = main(["lab", "check", lab, "--bag", str(path), "--json"])
        record = json.loads(capsys.readouterr().out)
        assert main(["lab", "check", lab, "-b", str(path)]) == code
        return code, record, capsys.readouterr().out

    return run


def _by_what(record):
    return {row["what"]: row for row in record["rows"]}


def test_a_recorded_controller_and_evaluator_are_judged(check):
    code, record, text = check("husky", lambda log: husky(log, 1.0, STEPS))
    rows = _by_what(record)
    assert code == 0
    assert record["not_judged"] == []
    assert len(rows) == 8
    assert rows["drive at 0.5 m/s"]["measured"].startswith("0.500 m/s, settled after 0.6 s")
    assert rows["stop from 1 m/s"]["measured"].startswith("at rest after 0.")
    assert rows["samples"]["measured"] == "1 to 1400 in 1400 messages"
    assert "checking a recorded run: " in text
    assert text.endswith("8 of 8 are as the lab specifies\n")


def test_a_recorded_step_that_falls_short_has_its_cause(check):
    code, record, text = check("husky", lambda log: husky(log, 0.8, STEPS))
    row = _by_what(record)["drive at 0.5 m/s"]
    assert (code, row["ok"], row["cause"]) == (1, False, "slow")
    assert row["measured"].startswith("0.400 m/s, never settled")
    assert "-> too slow: its effort is the same whatever the measured speed is" in text
    assert "it printed" not in text


def test_steps_that_were_not_desired_or_too_short_are_not_judged(check):
    steps = [(0, 0, 1), (0.5, 0, 1.2), (1, 0, 4), (0, 0, 2)]
    code, record, text = check("husky", lambda log: husky(log, 1.0, steps))
    found = {one["what"]: one["reason"] for one in record["not_judged"]}
    assert code == 0
    assert found == {
        "drive at 0.1 m/s": "it was never desired from rest",
        "drive at 0.5 m/s": "it was desired for only 1.2 s",
        "drive at 1 m/s": "it was never desired from rest",
        "turn at 0.3 rad/s": "it was never desired from rest",
    }
    assert "\n  controller, drive at 0.5 m/s: it was desired for only 1.2 s\n" in text


def test_a_robot_that_was_steered_without_a_desired_velocity_is_not_judged(check):
    def fill(log):
        Drive(log, "/husky0").send("/husky0/velocity_cmd", JointState())

    code, record, _ = check("husky", fill)
    reasons = [one["reason"] for one in record["not_judged"]]
    assert code == 1
    assert reasons[0] == "it was never desired from rest"


def test_an_evaluator_that_takes_the_sum_of_the_errors_is_found(check):
    def fill(log):
        drive, stat = Drive(log, "/husky0"), ControllerEvaluationStat()
        drive.send("/husky0/desired_velocity", twist(0.3, 0.4))
        for number in range(100):
            drive.move(0.0, 0.0, 0.0, 0.0)
            stat.samples, stat.last_error, stat.average_error = 2 * number, 0.7, 0.7
            drive.send("/husky0/evaluation_stat", stat)

    code, record, _ = check("husky", fill)
    rows = _by_what(record)
    assert code == 1
    assert not rows["samples"]["ok"]
    assert rows["last_error"]["measured"] == "0.700, 0 of 100 right"
    assert "it is the sum |v - desired v| + |w - desired w|" in rows["last_error"]["hint"]
    (controller,) = record["not_judged"]
    assert controller["reason"].startswith("there are no messages on /husky0/velocity_cmd or ")


@pytest.mark.parametrize(
    ("average", "words"),
    [
        (lambda errors: sum(errors) / len(errors), "it is the mean of the errors, and should be"),
        (
            lambda errors: errors[-1],
            "it is the last error alone, and should be the root of the mean of the squares",
        ),
    ],
)
def test_a_recorded_average_that_is_no_root_mean_square_is_found(average, words, check):
    def fill(log):
        drive, stat, errors = Drive(log, "/husky0"), ControllerEvaluationStat(), list[float]()
        drive.send("/husky0/desired_velocity", twist(0.3, 0.4))
        for number in range(100):
            forward = 0.003 * number
            drive.move(0.0, 0.0, forward, 0.4)
            errors.append(0.3 - forward)
            stat.samples, stat.last_error = len(errors), errors[-1]
            stat.average_error = average(errors)
            drive.send("/husky0/evaluation_stat", stat)

    _, record, _ = check("husky", fill)
    row = _by_what(record)["average_error remembers"]
    assert not row["ok"]
    assert row["hint"].startswith(words)


@pytest.mark.parametrize(
    ("seconds", "radius", "circle", "others"),
    [(30, 5 / 3, "1.667 m", 1), (30, 2.0, "2.000 m", 1), (10, 5 / 3, None, 2)],
)
def test_a_recorded_circle_is_judged_where_there_is_a_round(check, seconds, radius, circle, others):
    code, record, text = check("dolly", lambda log: dolly(log, seconds, radius))
    rows = _by_what(record)
    assert rows["rate of commands"]["measured"] == "2.00 Hz"
    assert rows["velocity commanded"]["ok"]
    assert rows.get("circle that it drives", {}).get("measured") == circle
    assert len(record["not_judged"]) == others
    assert code == (radius == 2.0)
    assert "reader, all of it: the lines that it prints are not in a log" in text


def test_a_recorded_path_is_judged_to_its_end(check):
    code, record, _ = check("pioneer", lambda log: pioneer(log, 5.2))
    assert code == 0
    assert _by_what(record)["mean distance from the path"]["measured"] == "0.050 m"
    assert [one["program"] for one in record["not_judged"]] == ["teleop", "viewer"]
    _, record, _ = check("pioneer", lambda log: pioneer(log, 3.0))
    assert record["not_judged"][-1]["reason"] == "the log ends after 3.0 of 5.0 m"
    assert "drives the path" not in _by_what(record)


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--rate", "2"], "--bag simulates nothing; leave out --rate, --time-limit and --plot"),
        ([], "{path} has no topic of the lab dolly; lcmtools bag info {path} shows what it has"),
    ],
)
def test_a_log_of_something_else_is_refused(tmp_path, capsys, words, error):
    path = tmp_path / "run.lcmlog"
    with LogWriter(path) as log:
        log.add(Packet("/other", encode(Twist()), 0))
    assert main(["lab", "check", "dolly", "--bag", str(path), *words]) != 0
    assert error.format(path=path) in capsys.readouterr().err
