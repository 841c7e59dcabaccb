"""lab check of the programs in a folder, each with several mistakes: causes are named, once.

A program's first line is the check, without the program, which is run with the name of a mistake. A
line for each mistake follows: the first row that is not ok, and words of its hint. A program is
right where "nothing" is expected, perhaps with a finding of wtf.
"""

import json
import shlex
import sys
from pathlib import Path

import pytest
from fixtures.says import assert_says

pytestmark = pytest.mark.usefixtures("quiet_network")

PROGRAMS = Path(__file__).parent / "programs"
LONGEST = 25.0
"""Of a check [s], by the simulation's pace; its start and end take less than 5 s more."""


def expected():
    for file in sorted(PROGRAMS.glob("*.py")):
        command, *lines = file.read_text().splitlines()
        words = command.split()[1:]
        for line in lines:
            key, _, values = line.partition("# expects: ")
            if key or not values:
                continue
            mistake, *row = values.split(" | ")
            yield pytest.param(file, words, mistake, *row, id=f"{file.stem}-{mistake}")


CASES = list(expected())
RIGHT = [case for case in CASES if case.values[3] == "nothing"]
WRONG = [case for case in CASES if case.values[3] != "nothing"]


def checked(cli, file, words, mistake):
    """Return the exit code, and the rows of a check."""
    result = cli(*words, shlex.join([sys.executable, str(file), mistake]), "--json")
    answer = json.loads(result.out)
    (program,) = answer["programs"].values()
    assert program["duration"] < LONGEST
    return result.code, answer["rows"]


@pytest.mark.parametrize(("file", "words", "mistake", "row", "hint"), WRONG)
def test_the_cause_is_named_once(file, words, mistake, row, hint, cli):
    code, rows = checked(cli, file, words, mistake)
    first, *others = (one for one in rows if not one["ok"])
    assert (code, first["what"]) == (1, row), first
    assert hint in first["hint"]
    assert all(one["follows"] or hint in one["hint"] for one in others), others
    advice = " ".join([first["hint"], *first["findings"]])
    assert "lcmtools wtf" not in advice
    assert "lcmtools node" not in advice


@pytest.mark.parametrize(
    ("file", "words", "mistake", "findings"),
    [pytest.param(*one.values[:3], list(one.values[4:]), id=one.id) for one in RIGHT],
)
def test_a_program_of_another_style_is_right(file, words, mistake, findings, cli):
    code, rows = checked(cli, file, words, mistake)
    assert (code, [one for one in rows if not one["ok"]]) == (0, [])
    noted = [one.partition(":")[0] for row in rows for one in row["findings"]]
    assert noted == findings


def test_a_robot_that_got_stuck_says_on_what_and_where(cli):
    words = ["lab", "check", "dolly", "--mover"]
    _, rows = checked(cli, PROGRAMS / "mover.py", words, "velocity")
    velocity, circle = (one for one in rows if not one["ok"])
    assert velocity["measured"] == "0.5 m/s, 0 rad/s"
    assert "stuck on shed, at (5.1, 0.0) m" in circle["measured"]


@pytest.fixture
def class_folder(tmp_path):
    folder = tmp_path / "class"
    (folder / "anna" / "anna").mkdir(parents=True)
    source = "def main(): pass\n" + (PROGRAMS / "mover.py").read_text()
    source = source.replace("sys.argv[1]", "''")
    (folder / "anna" / "anna" / "moving_robot.py").write_text(source)
    # a package of which a file is not declared as a node: here the file itself is run
    (folder / "anna" / "pyproject.toml").write_text('[project]\nname = "anna"\n[tool.lcmtools]\n')
    (folder / "anna" / "yaml.py").write_text("raise ImportError('not for the check')")
    (folder / "bo.py").write_text("raise ValueError('/dolly/cmd_vel')")
    (folder / "cy").mkdir()
    yield folder
    assert sorted(path.name for path in folder.iterdir()) == ["anna", "bo.py", "cy"]


def test_a_class_is_checked_with_a_table_a_report_and_pictures(class_folder, tmp_path, cli):
    files = ("--junit", str(tmp_path / "class.xml"), "--plot", str(tmp_path / "plot.png"))
    command = ("lab", "check", "dolly", "--programs", str(class_folder), "--jobs", "2", *files)
    result = cli(*command)
    assert result.code == 1
    table = [row.split(maxsplit=4) for row in result.out.splitlines()[-3:]]
    assert table[0] == ["anna", "4", "of", "4"]
    assert table[1][:4] == ["bo.py", "0", "of", "1"]
    assert "ValueError: /dolly/cmd_vel (bo.py:1)" in table[1][4]
    assert table[2][:2] == ["cy", "-"]
    assert_says(table[2][4], "not contain", "moving_robot or reading_laser")
    report = (tmp_path / "class.xml").read_text()
    assert report.count("<testsuite ") == 3
    assert (tmp_path / "plot_anna_mover.png").read_bytes().startswith(b"\x89PNG")
