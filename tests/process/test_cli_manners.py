"""The manners of every command, by the examples in its own help: a new command is tested at once.

Each command's first examples run as typed, on a bus with a talker and a robot, in four ways: into
a file, with --json, onto a full disk, and for a reader who has had enough. Those that are no more
than a command run in the test's process.
"""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from fixtures.commands import COMMANDS, command_of, has_json
from fixtures.says import assert_says

_ROBOT = """
import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState, LaserScan
from lcmtools.types.std_msgs import String

lcmtools.init()
robot, controller = lcmtools.Node("morse"), lcmtools.Node("simple_controller")
controller.create_subscription(Odometry, "/husky0/odometry", lambda odometry: None)
chatter = robot.create_publisher(String, "EXAMPLE", plain_channel=True)
others = [
    robot.create_publisher(Odometry, "/husky0/odometry"),
    robot.create_publisher(LaserScan, "/scan"),
    robot.create_publisher(JointState, "/joint_states"),
]

def tick():
    chatter.publish(String())
    for publisher, message in zip(others, (Odometry(), LaserScan(), JointState()), strict=True):
        now = robot.get_clock().now()
        message.header.stamp.sec, message.header.stamp.nsec = divmod(now, 10**9)
        publisher.publish(message)

robot.create_timer(0.05, tick)
print("ready", flush=True)
lcmtools.spin(robot, controller)
"""
_PATIENCE = 1.5  # [s] for a command that says nothing, before it is asked to end
_IS_SHELL = re.compile(r"[|<>]|\$\(")
_STARTS_PROCESSES = {"run", "launch", "lab"}
_BOXES = re.compile("[\u2500-\u259f\u2800-\u28ff]")
_NO_DATA = {
    ("lcmtools", *words.split())
    for words in (
        "help",
        "pub",
        "completion",
        "param load",
        "param set",
        "sim snapshot",
        "lab start",
        "plot",
        "bag play",
        "bag plot",
        "foxglove",
    )
}
"""Commands that do something, and so have nothing to give as JSON."""
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f]")


def examples(path):
    """The lines of the examples in a command's help."""
    _, _, rest = (command_of(path).help or "").partition("Examples:\n")
    return [line.strip() for line in rest.split("\n\n")[0].splitlines()]


@dataclass(frozen=True)
class Outcome:
    """The outcome of a line that was typed."""

    code: int
    out: str
    error: str
    signal: int  # that it was sent, 0 for none


class Patience:
    """Decides when a command that goes on is asked to end: soon after its first output.

    Args:
        ending: Seconds in which one that has printed all comes to its end.
    """

    def __init__(self, ending=0.3):
        self._silent_until = time.monotonic() + _PATIENCE
        self._ending = ending
        self._ends = 0.0
        self.is_over = False

    def __call__(self, written):
        """Return whether it has had its time."""
        now = time.monotonic()
        if written and not self._ends:
            self._ends = now + self._ending
        self.is_over = now > (self._ends or self._silent_until)
        return self.is_over


@pytest.fixture(scope="module")
def robot(module_start, lcmtools_path, tmp_path_factory):
    """Sees to it that the robot and the talker are on the bus, whatever an example has ended."""
    script = tmp_path_factory.mktemp("robot") / "robot.py"
    script.write_text(_ROBOT)
    running = {}

    def ensure():
        for words, ready in (
            ((sys.executable, str(script)), "ready"),
            ((lcmtools_path, "run", "talker"), "hello"),
        ):
            if words not in running or running[words]._process.poll() is not None:
                running[words] = module_start(*words)
                running[words].wait_for(ready)

    return ensure


@pytest.fixture
def home(robot, tmp_path, lcmtools_path, module_bus_url, monkeypatch):
    """An empty home folder, in which nothing is left that a command did not say it would write."""
    robot()
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.chdir(home)
    monkeypatch.delenv("XDG_CONFIG_HOME")
    monkeypatch.delenv("DISPLAY", raising=False)
    for name, value in {
        "PATH": f"{Path(lcmtools_path).parent}:{os.environ['PATH']}",
        "HOME": str(home),
        "LCM_DEFAULT_URL": module_bus_url,
        "LC_ALL": "C",
        "COLUMNS": "40",
        "TERM": "xterm-256color",
    }.items():
        monkeypatch.setenv(name, value)
    yield home
    left = {path.name for path in home.iterdir()} - {".config", ".cache", ".local"}
    of_shells = {".bashrc", ".zshrc"}  # completion writes there, as it says
    assert not {name for name in left - of_shells if name.startswith((".", "lcmtools"))}


@pytest.fixture
def typed(home, cli, tmp_path):
    """``typed(line, signal.SIGINT)``: runs a line; ends what goes on by itself."""

    def run(line, number=signal.SIGINT, out=None):
        words = shlex.split(line)
        if _IS_SHELL.search(line) or words[1] in _STARTS_PROCESSES:
            return _in_shell(line if out is None else f"{line} > /dev/full", home, tmp_path, number)
        patience = Patience()
        result = cli(*words[1:], until=patience, ends_by=number, out=out)
        return Outcome(result.code, result.out, result.err, number if patience.is_over else 0)

    return run


def _in_shell(line, home, folder, number=signal.SIGINT):
    """Run a line of bash in a session of its own."""
    with (folder / "out").open("w+b") as out, (folder / "error").open("w+b") as error:
        process = subprocess.Popen(
            ["bash", "-c", line],  # noqa: S607 - bash is where the system has it
            cwd=home,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=error,
            start_new_session=True,
        )
        patience = Patience(1.5)  # a process has to end its interpreter too
        try:
            while process.poll() is None and not patience(Path(out.name).stat().st_size):
                time.sleep(0.01)
            if patience.is_over:
                os.killpg(process.pid, number)
            process.wait(40)
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        texts = [Path(file.name).read_bytes().decode() for file in (out, error)]
    return Outcome(process.returncode, *texts, signal=number if patience.is_over else 0)


def check(outcome, path):
    """Check what every ending has in common."""
    text = outcome.out + outcome.error
    assert "Traceback" not in text
    assert "a fault of lcmtools" not in text
    assert f"(see {' '.join(path)} --help)" not in outcome.error, "an example is wrong usage"
    assert not _CONTROL.search(text)
    assert not _BOXES.search(text)
    if outcome.signal:
        ended_by_signal = 0 if path[1] == "run" else 128 + outcome.signal
        # once it has said its error, the interpreter ends, which has no handlers any more
        at_its_end = -outcome.signal if outcome.error else ended_by_signal
        judged = (1, 2) if outcome.out.startswith("Found ") else (0,)  # wtf, done before it came
        # ending by itself, by an error that it has said, when the signal came
        failed = (1, 64) if "cannot write" in outcome.error else ()
        assert outcome.code in (ended_by_signal, at_its_end, *judged, *failed), outcome
        assert "Aborted" not in text


def first_plain(path):
    """The first example that is no more than a command."""
    return next(line for line in examples(path) if not _IS_SHELL.search(line))


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_examples_work_as_typed(path, typed):
    for line in examples(path)[:2]:
        check(typed(line), path)


def test_everything_that_lists_reports_or_streams_has_json():
    assert {path for path in COMMANDS if not has_json(path)} <= _NO_DATA


@pytest.mark.parametrize("path", [path for path in COMMANDS if has_json(path)], ids=" ".join)
def test_json_is_one_document_or_one_object_a_line(path, typed):
    line = next(line for line in examples(path) if not re.search(r"[|<>]|--(csv|raw)", line))
    if path[1] == "run":
        line = "lcmtools run --list"  # what follows a node's name is the node's
    words = line if "--json" in line else line.replace(" ".join(path), f"{' '.join(path)} --json")
    outcome = typed(words, signal.SIGTERM)
    check(outcome, path)
    try:
        json.loads(outcome.out or "null")
    except json.JSONDecodeError:
        assert [json.loads(row) for row in outcome.out.splitlines()]


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_full_disk_costs_one_line(path, typed):
    with Path("/dev/full").open("wb", buffering=0) as full:
        outcome = typed(first_plain(path), out=full)
    check(outcome, path)
    check_full(outcome, path)


def check_full(outcome, path):
    """Check what is true where nothing can be written."""
    if not outcome.signal and "No space left" in outcome.error:
        assert outcome.code == (64 if path == ("lcmtools", "wtf") else 1)  # there 1 is a warning
        said = [line for line in outcome.error.splitlines() if "cannot write" in line]
        (line,) = said
        assert_says(line, f"{' '.join(path)}: ", "standard output: No space left on device")
    elif not outcome.signal and path not in _NO_DATA:
        assert outcome.error, "what cannot be written must be told"


SOME = ["list", "echo", "pub", "msg show", "spy", "wtf", "run", "help"]
"""Commands of each kind; how a process deals with its streams is the same for all."""


@pytest.mark.parametrize("command", SOME)
def test_full_disk_and_closed_input_cost_a_process_one_line(command, home, tmp_path):
    path = ("lcmtools", *command.split())
    outcome = _in_shell(f"{first_plain(path)} > /dev/full <&-", home, tmp_path)
    check(outcome, path)
    check_full(outcome, path)


@pytest.mark.parametrize("command", SOME)
def test_reader_who_has_had_enough_and_closed_error_are_no_fault(command, home, tmp_path):
    path = ("lcmtools", *command.split())
    # a head that SIGINT ends after the command would have bash end by it, too
    reader = "(trap '' INT; exec head -1)"
    line = f"{first_plain(path)} 2>&- | {reader}; exit ${{PIPESTATUS[0]}}"
    outcome = _in_shell(line, home, tmp_path)
    check(outcome, path)
    assert outcome.out.count("\n") <= 1


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_reader_who_is_gone_is_no_fault_of_any_command(path, typed):
    line = first_plain(path)
    if shlex.split(line)[1] in _STARTS_PROCESSES:
        line = f"lcmtools {path[1]} --help"
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "wb", buffering=0) as gone:  # noqa: PTH123 - a descriptor
        outcome = typed(line, out=gone)
    check(outcome, path)
    assert "roken pipe" not in outcome.error
