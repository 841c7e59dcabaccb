"""lcmtools lab: the list, the start, and the checks of a student's own programs."""

import contextlib
import json
import os
import shlex
import signal
import sys
from contextlib import closing
from pathlib import Path

import pytest
from fixtures.typist import Typist

from lcmtools.labs.checks import checked_programs, dolly, program_rows
from lcmtools.processes.child import StopTimeouts

pytestmark = pytest.mark.usefixtures("quiet_network")

TOO_SLOW = """
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState


class TooSlow(Node):
    def __init__(self):
        super().__init__("simple_controller")
        self.commands = self.create_publisher(JointState, "controlled_velocity")
        self.create_subscription(Twist, "desired_velocity", self.take, 1)

    def take(self, twist):
        message = JointState()
        message.effort = [twist.linear.x * 0.8] * 2
        self.commands.publish(message)


lcmtools.init()
lcmtools.spin(TooSlow())
lcmtools.shutdown()
"""
ONE_HERTZ = """
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

lcmtools.init()
node = Node("moving_robot")
publisher = node.create_publisher(Twist, "/dolly/cmd_vel")
twist = Twist()
twist.linear.x, twist.angular.z = 0.5, 0.6
node.create_timer(1.0, lambda: publisher.publish(twist))
lcmtools.spin(node)
lcmtools.shutdown()
"""


@pytest.fixture
def check(cli, tmp_path, left_over):
    """``check("husky", "--controller", source)``: the rows by what they are about."""

    def run(lab, *options, source=""):
        script = tmp_path / "program.py"
        script.write_text(source)
        own = [options[-1], shlex.join([sys.executable, str(script)])] if source else []
        result = cli(
            "lab", "check", lab, *options[:-1], *own, "--json", env={"TMPDIR": str(tmp_path)}
        )
        assert result.out, result.err
        answer = json.loads(result.out)
        assert result.code == (0 if answer["ok"] else 1), result.err
        return {row["what"]: row for row in answer["rows"]}

    yield run
    assert left_over() == []


def not_ok(rows):
    return [what for what, row in rows.items() if not row["ok"]]


@pytest.mark.parametrize("lab", ["husky", "pioneer", "dolly"])
def test_our_own_programs_do_what_the_labs_ask_for(lab, check):
    rate = ["--rate", "12"] if lab == "dolly" else []  # nothing there depends on it
    rows = check(lab, *rate, "")
    assert not_ok(rows) == [], rows
    assert all(row["hint"] == "" for row in rows.values())


def test_a_controller_that_is_too_slow_is_measured_and_advised(check):
    rows = check("husky", "--rate", "8", "--controller", source=TOO_SLOW)
    row = rows["drive at 0.5 m/s"]
    assert not row["ok"]
    assert str(row["measured"]).startswith("0.400 m/s, never settled")
    assert row["follows"] == "drive at 0.1 m/s"
    assert str(rows["drive at 0.1 m/s"]["hint"]).startswith("too slow")
    assert rows["stop from 1 m/s"]["ok"]
    assert str(rows["turn at 0.3 rad/s"]["hint"]).startswith("it does not move")


def test_a_mover_with_the_wrong_rate_and_circle_is_measured(check, monkeypatch):
    monkeypatch.setattr(dolly, "SOME", 5)
    rows = check("dolly", "--rate", "12", "--mover", source=ONE_HERTZ)
    assert not_ok(rows) == ["rate of commands", "velocity commanded", "circle that it drives"]
    rate = str(rows["rate of commands"]["measured"]).removesuffix(" Hz")
    assert float(rate) == pytest.approx(1.0, rel=0.1)
    assert rows["circle that it drives"]["measured"] == "0.833 m"


def test_a_program_that_crashes_gets_a_row_with_its_last_words(check):
    rows = check("dolly", "--reader", source="raise ValueError('oops')")
    row = rows["prints ranges"]
    assert not_ok(rows) == ["prints ranges"]
    assert "oops" in str(row["measured"]) + str(row["hint"])


@pytest.mark.parametrize(
    ("option", "says", "shown"),
    [
        (
            "--reader=python3 reading_laser.py",
            "simulates a program: about 8 s, longer if something fails",
            "your program: python3 reading_laser.py",
        ),
        (
            "--programs=.",
            "simulates the programs, 1 at a time: about 10 s each, longer if something fails",
            "the submissions in .",
        ),
    ],
)
def test_a_terminal_shows_what_is_checked_before_the_first_row(
    option, says, shown, lcmtools_path, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("reading_laser.py").write_text("raise ValueError('oops')")
    jobs = ["--jobs=1"] if "programs" in option else []
    with closing(Typist(lcmtools_path, "lab", "check", "dolly", option, *jobs)) as person:
        person.wait_for("NOT OK")
        assert person.end() == 1
    first = f"lcmtools lab check: {says}\r\n"
    assert person.written.decode().startswith(f"{first}\rchecking {shown} ...\x1b[K\r\x1b[K\r\n")


def test_what_a_check_does_is_told_before_the_simulator_starts(start, lcmtools_path):
    program = start(lcmtools_path, "lab", "check", "husky")
    program.wait_for("there is no simple_controller or evaluate_controller in this folder", 5.0)
    program.wait_for("simulates 2 programs, one after the other: about 16 s", 5.0)


def test_a_program_that_prints_without_end_is_stopped_before_the_disk_is_full(check):
    rows = check("dolly", "--reader", source="while True: print('no range' * 100)")
    row = rows["prints ranges"]
    assert not row["ok"]
    assert len(str(row["measured"]) + str(row["hint"])) < 400


def test_a_program_that_is_silent_and_ignores_signals_is_ended(check, monkeypatch):
    monkeypatch.setattr(program_rows, "_FIRST_MESSAGE", 2.0)
    monkeypatch.setattr(checked_programs, "_TIMEOUTS", StopTimeouts(0.5, 0.5))
    source = (
        "import signal, subprocess, time\n"
        "for number in (signal.SIGINT, signal.SIGTERM): signal.signal(number, signal.SIG_IGN)\n"
        "subprocess.Popen(['sleep', '1000'])\ntime.sleep(1000)\n"
    )
    rows = check("husky", "--controller", source=source)
    assert rows["commands the robot"]["measured"] == "none within 2 s"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_check_that_is_broken_off_leaves_no_process(
    number, start, lcmtools_path, tmp_path, left_over, wait_until
):
    program = start(lcmtools_path, "lab", "check", "husky", TMPDIR=str(tmp_path))
    program.wait_for("drive at 0.1 m/s", 60.0)
    assert len(left_over()) >= 3
    os.kill(program.pid, number)
    code = program.wait()
    assert code == (-number if number == signal.SIGKILL else 128 + number)
    wait_until(lambda: left_over() == [], 20.0)


def test_a_simulator_that_dies_is_not_the_fault_of_the_program(start, lcmtools_path, tmp_path):
    program = start(lcmtools_path, "lab", "check", "husky", TMPDIR=str(tmp_path))
    program.wait_for("drive at 0.1 m/s", 60.0)
    mark = f"TMPDIR={tmp_path}".encode()
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            is_ours = mark in (folder / "environ").read_bytes().split(b"\0")
            if is_ours and b"\0--world\0" in (folder / "cmdline").read_bytes():
                os.kill(int(folder.name), signal.SIGKILL)
    assert program.wait() == 1
    assert "the simulator ended during the check, with code -9" in program.output
    assert "NOT OK" not in program.output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_class_that_is_broken_off_leaves_no_process_and_no_file(
    number, start, lcmtools_path, tmp_path, left_over, wait_until
):
    folder = tmp_path / "class"
    folder.mkdir()
    for name in ("anna", "bo", "cy"):
        (folder / f"{name}.py").write_text(ONE_HERTZ)
    command = ("lab", "check", "dolly", "--programs", str(folder), "--jobs", "2")
    program = start(lcmtools_path, *command, TMPDIR=str(tmp_path))
    wait_until(lambda: sum(" sim --world " in one for one in left_over()) == 2)
    os.kill(program.pid, number)
    assert program.wait() == 128 + number
    assert left_over() == []
    assert [path.name for path in tmp_path.iterdir() if "lcmtools" in path.name] == []


def test_start_says_what_to_type_runs_the_simulator_and_refuses_a_second_one(
    start, cli, lcmtools_path, bus_url
):
    bus = {"LCM_DEFAULT_URL": bus_url}
    program = start(lcmtools_path, "lab", "start", "dolly", "--rate", "2", **bus)
    program.wait_for("lcmtools run moving_robot")
    program.wait_for("simulating dolly", 30.0)
    second = cli("lab", "start", "dolly", env=bus)
    assert second.code == 1
    assert "/gazebo is already running on this bus" in second.err
    program.send_signal(signal.SIGINT)
    assert program.wait() == 0


def test_list_shows_the_labs_and_their_programs(cli):
    assert [row.split()[0] for row in cli("lab", "list").out.splitlines()] == [
        "husky",
        "pioneer",
        "dolly",
    ]
    labs = json.loads(cli("lab", "list", "--json").out)
    assert labs[2]["programs"]["mover"] == "lcmtools run moving_robot"
