"""The reports of checks: text, JSON, JUnit, the table of a class, and the picture."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import PIL.Image
import pytest
from fixtures.json_page import unlisted

from lcmtools.errors import UsageError
from lcmtools.labs.catalogue import LABS
from lcmtools.labs.checks.check_report import (
    class_rows,
    heading,
    junit,
    read_json,
    summary,
    to_json,
)
from lcmtools.labs.checks.check_report import to_lines as rows_of
from lcmtools.labs.checks.class_check import ClassCheck
from lcmtools.labs.checks.observations import (
    Desire,
    Observations,
    ReceivedMessage,
    Touch,
    TrueState,
)
from lcmtools.labs.checks.plot import draw_check, velocity_curves
from lcmtools.labs.checks.results import CheckResult, Report, as_specified
from lcmtools.labs.checks.submissions import copy_submission, programs_of, submissions_in
from lcmtools.labs.commands.checking import picture_file
from lcmtools.observe.measuring.curves import Curve
from lcmtools.types.geometry_msgs import Twist

OK = CheckResult("commands the robot", "messages that come", "they come", is_ok=True)
WRONG = CheckResult(
    "drive at 0.1 m/s",
    "0.1 m/s",
    "-1.0 m/s",
    is_ok=False,
    hint="wrong sign of speed",
    cause="speed-sign",
    said="KeyError: 'a\x1b' (c.py:3)",
    findings=("unconnected: /a -> start it with a:=b",),
)
FOLLOWS = CheckResult(
    "drive at 0.5 m/s",
    "0.5 m/s",
    "not measured",
    is_ok=False,
    hint="follows from: drive at 0.1 m/s",
    cause="speed-sign",
    follows="drive at 0.1 m/s",
)
CONTROLLER = LABS["husky"].programs[0]
OBSERVED = Observations(
    CONTROLLER,
    desired=[Desire(0.0, 0.0, 0.0), Desire(1.0, 0.5, 0.0)],
    motion=[TrueState(t / 10, t / 20, 0.0, 0.5, float("nan")) for t in range(40)],
    touches=[Touch(3.0, "pillar", 4.0, -3.0)],
)
REPORT = Report("controller", ("python", "my c.py"), [OK, WRONG, FOLLOWS], OBSERVED, duration=12.34)
WORLD = {
    "objects": [
        {"type": "walls", "points": [[-6, -5], [6, -5], [6, 5]], "closed": True},
        {"type": "box", "size": [1, 2, 1], "pose": [3, 3, "30 deg"]},
        {"type": "cylinder", "radius": 0.5, "pose": [-3, 2, 0]},
        {"type": "sdf", "file": "a.sdf"},
    ]
}


def test_a_heading_says_whose_program_is_checked():
    assert heading("controller", ["python", "my c.py"])[1] == (
        "checking your program: python 'my c.py'"
    )
    answer = heading("controller", ["lcmtools"], is_answer=True)
    assert answer[1] == "checking the model answer of lcmtools: lcmtools"


def test_a_row_that_is_not_ok_has_its_cause_the_last_words_and_findings_below_it():
    assert len(rows_of(OK)) == 1
    assert [row.strip() for row in rows_of(WRONG)[1:]] == [
        "-> wrong sign of speed",
        "it printed last: KeyError: 'a\x1b' (c.py:3)",
        "wtf: unconnected: /a -> start it with a:=b",
    ]
    assert rows_of(FOLLOWS)[1].strip() == "-> follows from: drive at 0.1 m/s"


def test_the_summary_ends_with_the_first_cause():
    assert summary([REPORT]) == [
        "1 of 3 are as the lab specifies",
        "first of all, controller: wrong sign of speed",
    ]
    assert summary([Report("controller", (), [OK])]) == ["1 of 1 are as the lab specifies"]


def test_json_says_whose_programs_and_what_follows_from_what():
    plain = to_json("husky", [REPORT])
    assert plain["programs"] == {
        "controller": {"command": "python 'my c.py'", "model_answer": False, "duration": 12.3}
    }
    assert not plain["ok"]
    rows = plain["rows"]
    assert isinstance(rows, list)
    assert [row["follows"] for row in rows] == ["", "", "drive at 0.1 m/s"]
    assert rows[1]["cause"] == "speed-sign"
    assert not as_specified([])
    written = json.loads(json.dumps(plain))
    assert unlisted("lab check", [written, [{"submission": "anna", **written}]]) == []


def test_a_record_can_be_read_back():
    plain = json.loads(json.dumps(to_json("husky", [REPORT])))
    (report,) = read_json(plain)
    assert report == replace(
        REPORT, observations=None, command=["python", "my c.py"], duration=12.3
    )


def test_findings_about_a_program_that_is_right_are_a_note():
    rows = rows_of(replace(OK, findings=("2 nodes have the name /a",)))
    assert rows[0].split()[0] == "note"
    assert rows[1].strip() == "wtf: 2 nodes have the name /a"


def test_junit_counts_a_cause_once_and_is_legal_xml():
    root = ET.fromstring(junit("husky", {"anna": [REPORT]}))  # noqa: S314 - our own
    (suite,) = root
    assert suite.attrib == {
        "name": "anna.controller", "tests": "3", "failures": "1", "skipped": "1", "time": "12.3",
    }  # fmt: skip
    assert [child.tag for case in suite for child in case] == ["failure", "skipped"]
    failure = suite[1][0]
    assert failure.attrib["message"] == "-1.0 m/s: wrong sign of speed"
    assert "KeyError: 'a?'" in str(failure.text)


def test_a_class_gets_a_table_with_each_submission_s_first_cause():
    row = CheckResult("can be run", "a program", "none", is_ok=False, hint="no program")
    missing = Report("", (), [row])
    rows = list(class_rows({"anna": [REPORT], "bo": [missing]}))
    assert [row.split() for row in rows] == [
        ["submission", "controller", "first", "cause"],
        ["anna", "1", "of", "3", "controller:", "wrong", "sign", "of", "speed"],
        ["bo", "-", "no", "program"],
    ]


def test_the_picture_shows_steps_of_what_was_desired_and_measurements():
    desired, measured = velocity_curves(OBSERVED, 0)
    assert desired == Curve("desired", [0.0, 1.0, 1.0, 3.9], [0.0, 0.0, 0.5, 0.5])
    assert (measured.label, measured.times[0], measured.values[0]) == ("measured", 0.0, 0.5)
    commands = [ReceivedMessage(2.0, "/cmd_vel", Twist())]
    commanded, nothing = velocity_curves(Observations(CONTROLLER, commands), 1)
    assert commanded == Curve("commanded", [2.0, 0.0], [0.0, 0.0])
    assert nothing == Curve("measured")


def test_a_picture_has_a_row_for_each_program_that_was_observed(tmp_path):
    one, two = tmp_path / "one.png", tmp_path / "two.svg"
    draw_check(WORLD, [REPORT, REPORT, Report("evaluator", (), [])], one)
    with PIL.Image.open(one) as picture:
        assert (picture.format, picture.size) == ("PNG", (1560, 960))
        colors = {color for _, color in picture.convert("RGB").getcolors(1 << 24) or ()}
    assert {(191, 175, 150), (214, 39, 40), (44, 160, 44)} <= colors  # things, desired, the start
    draw_check({}, [Report("controller", (), [], Observations(CONTROLLER))], two)
    assert b"</svg>" in two.read_bytes()
    draw_check(WORLD, [Report("", (), [])], one)  # nothing ran


def test_a_check_goes_on_where_its_picture_cannot_be_drawn(tmp_path, monkeypatch, capsys):
    file = tmp_path / "a.png"
    assert (picture_file(None), picture_file(file)) == (None, file)
    with pytest.raises(UsageError, match=r"a is not a picture; use a suffix \(\.png"):
        picture_file(tmp_path / "a")
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert picture_file(file) is None
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("lcmtools lab check: pictures of curves need the extra 'plot'")
    assert line.endswith("checking without a picture")


def test_programs_of_a_submission_are_found_by_name_by_topics_or_by_the_command(tmp_path):
    dolly, source = LABS["dolly"], tmp_path / "class"
    (source / "anna" / "src").mkdir(parents=True)
    (source / "anna" / "src" / "my_Moving_Robot.py").write_text("pass")
    (source / "anna" / "notes.txt").write_text("laser_scan")
    (source / "bo.py").write_text("subscribe('/dolly/laser_scan')")
    (source / ".git").mkdir()
    anna, bo = submissions_in(source)
    found = []
    for number, path in enumerate((anna, bo)):
        folder = tmp_path / str(number)
        folder.mkdir()
        copy_submission(path, folder)
        found.append({o: text.split()[1] for o, text in programs_of(dolly, folder, {}).items()})
    assert found == [{"mover": "src/my_Moving_Robot.py"}, {"reader": "bo.py"}]
    command = {"mover": "python {program} -x"}
    assert programs_of(dolly, folder, command) == {"mover": "python bo.py -x"}


@pytest.mark.parametrize(
    ("files", "found"),
    [
        (["evaluate_controller.py"], {"evaluator": "evaluate_controller.py"}),
        (
            ["evaluate_controller.py", "my_controller.py"],
            {"evaluator": "evaluate_controller.py", "controller": "my_controller.py"},
        ),
        (["a_controller.py", "my_simple_controller.py"], {"controller": "my_simple_controller.py"}),
        (["evaluator_of_controller.py"], {"evaluator": "evaluator_of_controller.py"}),
    ],
)
def test_a_file_is_one_program_of_a_submission(files, found, tmp_path):
    for name in files:
        (tmp_path / name).write_text("ControllerEvaluationStat evaluation_stat")
    programs = programs_of(LABS["husky"], tmp_path, {})
    assert {option: text.split()[1] for option, text in programs.items()} == found


@pytest.mark.parametrize(
    ("files", "found"),
    [
        (["moving_robot.cpp"], {"mover": "moving_robot.cpp"}),
        (["moving_robot", "moving_robot.cpp"], {"mover": "moving_robot.cpp"}),
        (["moving_robot.cpp", "moving_robot.py"], {"mover": "python moving_robot.py"}),
        (["src/main.cc"], {"mover": "src/main.cc"}),
        (["a b/moving_robot.cxx"], {"mover": "'a b/moving_robot.cxx'"}),
        (["moving_robot.hpp"], {}),
        (["build/CMakeCache.txt", "build/moving_robot"], {}),
    ],
)
def test_a_source_in_cpp_is_a_program_and_comes_before_what_is_built_from_it(
    files, found, tmp_path
):
    for name in files:
        path = tmp_path / "anna" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('int main() { publish("/dolly/cmd_vel", Twist()); }')
        path.chmod(0o755)
    copy_submission(tmp_path / "anna", tmp_path / "own")
    programs = programs_of(LABS["dolly"], tmp_path / "own", {})
    python = Path(sys.executable).name
    assert {o: text.replace(f"{python} ", "python ") for o, text in programs.items()} == found


def test_a_file_in_cpp_without_main_is_no_program(tmp_path):
    (tmp_path / "moving_robot.cpp").write_text("void publish_cmd_vel() {}")
    assert programs_of(LABS["dolly"], tmp_path, {}) == {}


def test_a_command_for_a_class_that_is_wrong_is_refused_at_once(tmp_path):
    (tmp_path / "anna.py").touch()
    check = ClassCheck(LABS["dolly"], {"teleop": "python {program}"}, (), None, 1)
    with pytest.raises(UsageError, match="--teleop is not a program of the lab dolly"):
        check.run(tmp_path, lambda *_: None)


def test_a_folder_without_submissions_is_refused(tmp_path):
    with pytest.raises(UsageError, match="is empty"):
        submissions_in(tmp_path)
    with pytest.raises(UsageError, match="takes a folder"):
        submissions_in(tmp_path / "none")


@pytest.mark.parametrize(
    ("errors", "reason"),
    [
        (["lcmtools lab check: no space left"], "no space left"),
        ([], "its check was ended"),
    ],
)
def test_a_part_of_a_report_ends_one_check_and_not_that_of_the_class(
    errors, reason, tmp_path, monkeypatch
):
    (tmp_path / "anna.py").write_text("# /dolly/cmd_vel")
    monkeypatch.setattr(ClassCheck, "_lines", lambda *_: (['{"lab": "do'], errors))
    reports = ClassCheck(LABS["dolly"], {}, (), None, 1).run(tmp_path, lambda *_: None)
    (report,) = reports["anna.py"]
    assert (report.program, report.first_cause) == ("mover", reason)
