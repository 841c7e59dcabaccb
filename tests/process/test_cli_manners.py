"""The manners of every command, by the examples in its own help: a new command is tested at once.

Each command's first examples run as typed, on a bus with a talker and a robot. Those that are no
more than a command run in the test's process. For full disks and readers who have had enough see
test_cli_ending: all write through cli/output (tests/house/test_rooms.py).
"""

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
_PATIENCE = 0.7  # [s] for a command that says nothing, before it is asked to end
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
        is_ready: Returns whether one that says nothing has begun, for its patience to begin.
    """

    def __init__(self, ending=0.3, is_ready=lambda: True):
        self._ending = ending
        self._is_ready = is_ready
        self._latest = time.monotonic() + 40.0
        self._ends = 0.0
        self.is_over = False

    def __call__(self, written):
        """Return whether it has had its time."""
        is_begun = written or self._is_ready() or time.monotonic() > self._latest
        if is_begun and not self._ends:
            self._ends = time.monotonic() + (self._ending if written else _PATIENCE)
        self.is_over = bool(self._ends) and time.monotonic() > self._ends
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
        # Python 3.11 cannot read an editable install in such a folder in the locale C
        "LC_ALL": "C" if __file__.isascii() else "C.UTF-8",
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
    """``typed(line)``: runs a line; ends what goes on by itself."""

    def run(line):
        words = shlex.split(line)
        if _IS_SHELL.search(line) or words[1] in _STARTS_PROCESSES:
            return _in_shell(line, home, tmp_path)
        patience, number = Patience(), signal.SIGINT
        result = cli(*words[1:], until=patience, ends_by=number)
        return Outcome(result.code, result.out, result.err, number if patience.is_over else 0)

    return run


def _in_shell(line, home, folder):
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
        # a process has to begin and to end its interpreter too
        patience = Patience(1.5, lambda: _has_socket(process.pid))
        try:
            while process.poll() is None and not patience(Path(out.name).stat().st_size):
                time.sleep(0.02)
            if patience.is_over:
                os.killpg(process.pid, signal.SIGINT)
            process.wait(40)
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        texts = [Path(file.name).read_bytes().decode() for file in (out, error)]
    return Outcome(process.returncode, *texts, signal=signal.SIGINT if patience.is_over else 0)


def _has_socket(session):
    """Return whether a process of a session is past its command line, and on the bus."""
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it may end meanwhile
            fields = (process / "stat").read_text().rpartition(")")[2].split()
            if int(fields[3]) == session:
                links = [str(link.readlink()) for link in (process / "fd").iterdir()]
                if any(link.startswith("socket:") for link in links):
                    return True
    return False


def check(outcome, path):
    """Check what every ending has in common."""
    text = outcome.out + outcome.error
    assert "Traceback" not in text
    assert "a fault of lcmtools" not in text
    assert f"(see {' '.join(path)} --help)" not in outcome.error, "an example is wrong usage"
    assert not _CONTROL.search(text)
    assert not _BOXES.search(text) or not __file__.isascii()  # then the locale has them
    if outcome.signal:
        ended_by_signal = 0 if path[1] == "run" else 128 + outcome.signal
        # once it has said its error, the interpreter ends, which has no handlers any more
        at_its_end = -outcome.signal if outcome.error else ended_by_signal
        judged = (1, 2) if outcome.out.startswith("Found ") else (0,)  # wtf, done before it came
        # ending by itself, by an error that it has said, when the signal came
        failed = (1, 64) if "cannot write" in outcome.error else ()
        assert outcome.code in (ended_by_signal, at_its_end, *judged, *failed), outcome
        assert "Aborted" not in text


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_examples_work_as_typed(path, typed):
    for line in examples(path)[:2]:
        check(typed(line), path)


def test_everything_that_lists_reports_or_streams_has_json():
    assert {path for path in COMMANDS if not has_json(path)} <= _NO_DATA
