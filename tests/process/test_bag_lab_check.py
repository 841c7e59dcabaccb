"""Programs of the labs judged by recorded drives, without physics."""

import json
import math
import shlex
import sys
from pathlib import Path

import pytest
from fixtures.drives import REST, STEPS, Drive, dolly, husky
from fixtures.says import assert_says

from lcmtools.bag.writer import LogWriter
from lcmtools.types.geometry_msgs import PoseStamped
from lcmtools.types.nav_msgs import Path as NavPath
from lcmtools.types.sensor_msgs import LaserScan

_CONTROLLER = Path(__file__).parent / "programs/lab_controller.py"
_SPEED, _TURN = "answers a new desired speed", "answers a new desired turn rate"
_MORE_SPEED, _MORE_TURN = "at a higher measured speed", "at a higher measured turn rate"


@pytest.fixture
def check(cli, tmp_path):
    """``check(lab, fill, word...)``: the code, the failed rows with their hints, and the record."""

    def run(lab, fill, *words):
        log = tmp_path / "drive.lcmlog"
        with LogWriter(log, force=True) as writer:
            fill(writer)
        done = cli("lab", "check", lab, *words, "--bag", str(log), "--json")
        record = json.loads(done.out)
        records = record if isinstance(record, list) else [record]
        failed = {r["what"]: r["hint"] for one in records for r in one["rows"] if not r["ok"]}
        return done.code, failed, record

    return run


def _husky(log):
    husky(log, 1.0, STEPS)


def _short(log):
    husky(log, 1.0, [(0.5, 0, 1), REST, (0, 0.3, 1)])


@pytest.mark.parametrize(
    ("fault", "failed", "says"),
    [
        ("none", [], ""),
        ("backward", [_SPEED, _MORE_SPEED], "with linear.x of the desired velocity the command"),
        ("positive", [_MORE_SPEED], "the error is the desired velocity minus the measured one"),
        ("open", [_MORE_SPEED, _MORE_TURN], "its effort is the same whatever the measured speed"),
        ("straight", [_TURN, _MORE_TURN], "does it use angular.z of each desired velocity?"),
        ("raises", ["runs with the drive"], "callback of /husky0/odometry raised ValueError: too"),
        ("silent", ["runs with the drive"], "it published nothing"),
    ],
)
def test_a_controller_is_judged_by_its_answers_to_a_drive(fault, failed, says, check):
    command = shlex.join([sys.executable, str(_CONTROLLER), fault])
    code, found, record = check("husky", _short, "--controller", command)
    assert (code, list(found)) == (bool(failed), failed), record
    assert_says(next(iter(found.values()), ""), says)


def _circle(log):
    """A robot of the Pioneer on its path, a circle to the left of 2 m."""
    drive, path = Drive(log, ""), NavPath()
    for number in range(60):
        pose = PoseStamped()
        angle = number / 20
        pose.pose.position.x, pose.pose.position.y = 2 * math.sin(angle), 2 * (1 - math.cos(angle))
        path.poses.append(pose)
    drive.send("/path", path)
    while (angle := drive.time / 4) < 2.5:
        drive.move(2 * math.sin(angle), 2 * (1 - math.cos(angle)), 0.5, 0.25, heading=angle)


def _scanned(log):
    drive = Drive(log, "/dolly")
    for number in range(100):
        ranges = [1.2, 2.34, 3.4 + number / 100]
        scan = LaserScan(angle_min=-1.0, angle_increment=1.0, range_max=9.0, ranges=ranges)
        drive.send("/dolly/laser_scan", scan)
        drive.move(0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("lab", "fill", "option", "answer"),
    [
        ("husky", _husky, "controller", "simple_controller"),
        ("husky", _husky, "evaluator", "evaluate_controller"),
        ("pioneer", _circle, "path", "path_follower"),
        ("dolly", lambda log: dolly(log, 5), "mover", "moving_robot"),
        ("dolly", _scanned, "reader", "reading_laser"),
    ],
)
def test_the_model_answers_pass_on_a_drive(lab, fill, option, answer, check):
    code, failed, record = check(lab, fill, f"--{option}", f"lcmtools run {answer}")
    assert (code, failed) == (0, {}), record
    assert len(record["rows"]) > 1


def test_a_class_is_judged_by_one_drive(check, tmp_path):
    folder = tmp_path / "class"
    for name in ("anna", "bert"):
        (folder / name).mkdir(parents=True)
        fault = "none" if name == "anna" else "backward"
        text = _CONTROLLER.read_text().replace("sys.argv[1]", repr(fault))
        (folder / name / "simple_controller.py").write_text(text)
    code, _, record = check("husky", _short, "--programs", str(folder))
    assert code == 1
    assert {one["submission"]: one["ok"] for one in record} == {"anna": True, "bert": False}


def test_a_drive_of_something_else_is_refused_and_what_it_lacks_is_said(check, cli, tmp_path):
    command = shlex.join([sys.executable, str(_CONTROLLER), "none"])
    code, failed, record = check(
        "husky", lambda log: husky(log, 1.0, [(0.5, 0, 2)]), "--controller", command
    )
    assert (code, failed) == (0, {})
    (left_out,) = record["not_judged"]
    assert left_out["what"] == "answers a new desired turn rate"
    log = str(tmp_path / "drive.lcmlog")
    done = cli("lab", "check", "dolly", "--mover", command, "--bag", log)
    assert_says(done.err, f"{log} has no topic of the lab dolly")


def test_what_keys_or_a_picture_would_show_is_not_judged(check):
    code, failed, record = check("pioneer", _circle, "--teleop", "true", "--viewer", "true")
    assert (code, failed, record["rows"]) == (1, {}, [])
    assert [one["program"] for one in record["not_judged"]] == ["teleop", "viewer"]


def test_a_program_here_is_named_where_the_recording_itself_is_judged(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with LogWriter("drive.lcmlog") as writer:
        husky(writer, 1.0, STEPS)
    Path("simple_controller.py").write_text(_CONTROLLER.read_text())
    done = cli("lab", "check", "husky", "--bag", "drive.lcmlog")
    assert done.code == 0
    typed = "lcmtools lab check husky simple_controller.py --bag drive.lcmlog"
    assert_says(done.err, f"judges the recording itself; {typed} runs what is here with it")
