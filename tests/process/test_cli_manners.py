"""The manners of every command, by the examples in its own help: a new command is tested at once.

Each command's first examples run as typed, on a bus with a talker and a robot, in four ways: into
a pipe, with --json, onto a full disk, and for a reader who has had enough.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import pytest

from lcmtools.cli.main import root
from lcmtools.cli.manual import commands

_ROBOT = """
import lcmtools
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState, LaserScan
from lcmtools.types.std_msgs import String

lcmtools.init()
robot, controller = lcmtools.Node("morse"), lcmtools.Node("simple_controller")
controller.create_subscription(Odometry, "/husky0/odometry", lambda odometry: None)
chatter = robot.create_publisher(String, "EXAMPLE", literal=True)
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
_PATIENCE = 3.0  # [s] for a command that says nothing, before it is asked to end
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
    )
}
"""Commands that do something, and so have nothing to give as JSON."""
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f]")


def command_of(path: tuple[str, ...]) -> click.Command:
    command: click.Command = root
    for word in path[1:]:
        assert isinstance(command, click.Group)
        below = command.get_command(click.Context(command), word)
        assert below is not None
        command = below
    return command


COMMANDS = [  # topic list and the like are the same commands as list and the like
    path
    for path in commands()
    if not isinstance(command_of(path), click.Group) and path[1] != "topic"
]


def examples(path: tuple[str, ...]) -> list[str]:
    """The lines of the examples in a command's help."""
    _, _, rest = (command_of(path).help or "").partition("Examples:\n")
    return [line.strip() for line in rest.split("\n\n")[0].splitlines()]


def has_json(path: tuple[str, ...]) -> bool:
    return any("--json" in parameter.opts for parameter in command_of(path).params)


@dataclass(frozen=True)
class Outcome:
    """What came of a line that was typed."""

    code: int
    out: str
    error: str
    signal: int  # that it was sent, 0 for none


@pytest.fixture(scope="module")
def robot(
    module_start: Callable[..., Any], lcmtools_path: str, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[], None]:
    """Sees to it that the robot and the talker are on the bus, whatever an example has ended."""
    script = tmp_path_factory.mktemp("robot") / "robot.py"
    script.write_text(_ROBOT)
    running: dict[tuple[str, ...], Any] = {}

    def ensure() -> None:
        for words, ready in (
            ((sys.executable, str(script)), "ready"),
            ((lcmtools_path, "run", "talker"), "hello"),
        ):
            if words not in running or running[words]._process.poll() is not None:
                running[words] = module_start(*words)
                running[words].wait_for(ready)

    return ensure


@pytest.fixture
def typed(
    lcmtools_path: str,
    robot: Callable[[], None],
    tmp_path: Path,
    module_bus_url: str,
    stopwatch: Callable[[int], Any],
) -> Iterator[Callable[..., Outcome]]:
    """``typed(line, signal.SIGINT)``: runs a line of bash; ends what goes on by itself."""
    robot()
    home = tmp_path / "home"
    home.mkdir()
    environment = {
        **{name: value for name, value in os.environ.items() if not name.startswith("XDG_CONFIG")},
        "PATH": f"{Path(lcmtools_path).parent}:{os.environ['PATH']}",
        "HOME": str(home),
        "LCM_DEFAULT_URL": module_bus_url,
        "LC_ALL": "C",
        "COLUMNS": "40",
        "TERM": "xterm-256color",
    }
    environment.pop("DISPLAY", None)

    def run(line: str, number: int = signal.SIGINT) -> Outcome:
        with (tmp_path / "out").open("w+b") as out, (tmp_path / "error").open("w+b") as error:
            process = subprocess.Popen(
                ["bash", "-c", line],  # noqa: S607 - bash is where the system has it
                cwd=home,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=error,
                start_new_session=True,
            )
            try:
                sent = _end(process, stopwatch, Path(out.name), number)
            finally:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            texts = [Path(file.name).read_bytes().decode() for file in (out, error)]
        return Outcome(process.returncode, *texts, signal=sent)

    yield run
    left = {path.name for path in home.iterdir()} - {".config", ".cache", ".local"}
    of_shells = {".bashrc", ".zshrc"}  # completion writes there, as it says
    assert not {name for name in left - of_shells if name.startswith((".", "lcmtools"))}


def _end(
    process: subprocess.Popen[bytes], stopwatch: Callable[[int], Any], out: Path, number: int
) -> int:
    """Let a command run until it ends or has printed something; then ask it to end."""
    deadline = time.monotonic() + _PATIENCE
    while time.monotonic() < deadline and not out.stat().st_size:
        with suppress(subprocess.TimeoutExpired):
            process.wait(0.02)
            return 0
    watch = stopwatch(process.pid)
    while watch.seconds() < 0.4:  # [s] in which a process that has printed all comes to its end
        with suppress(subprocess.TimeoutExpired):
            process.wait(0.02)
            return 0
    os.killpg(process.pid, number)
    try:
        process.wait(15)
    except subprocess.TimeoutExpired:
        pytest.fail(f"signal {number} does not end {process.args!r}")
    return number


def check(outcome: Outcome, path: tuple[str, ...]) -> None:
    """What is true of every ending."""
    text = outcome.out + outcome.error
    assert "Traceback" not in text
    assert "a fault of lcmtools" not in text
    assert f"(see {' '.join(path)} --help)" not in outcome.error, "an example is wrong usage"
    assert not _CONTROL.search(text)
    assert not _BOXES.search(text)
    if outcome.signal:
        ended_by_signal = 0 if path[1] == "run" else 128 + outcome.signal
        assert outcome.code in (ended_by_signal, 0), outcome
        assert "Aborted" not in text


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_examples_work_as_typed_into_a_pipe(
    path: tuple[str, ...], typed: Callable[..., Outcome]
) -> None:
    for line in examples(path)[:2]:
        check(typed(line), path)


def test_everything_that_lists_reports_or_streams_has_json() -> None:
    assert {path for path in COMMANDS if not has_json(path)} <= _NO_DATA


@pytest.mark.parametrize("path", [path for path in COMMANDS if has_json(path)], ids=" ".join)
def test_json_is_one_document_or_one_object_a_line(
    path: tuple[str, ...], typed: Callable[..., Outcome]
) -> None:
    line = next(line for line in examples(path) if not re.search(r"[|<>]|--(csv|raw)", line))
    words = line if "--json" in line else line.replace(" ".join(path), f"{' '.join(path)} --json")
    outcome = typed(words, signal.SIGTERM)
    check(outcome, path)
    if path[1] == "run" and "--list" not in line:
        return  # what follows the name is the node's
    try:
        json.loads(outcome.out or "null")
    except json.JSONDecodeError:
        assert [json.loads(row) for row in outcome.out.splitlines()]


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_full_disk_and_closed_input_cost_one_line(
    path: tuple[str, ...], typed: Callable[..., Outcome]
) -> None:
    line = next(line for line in examples(path) if not re.search(r"[|<>]|\$\(", line))
    outcome = typed(f"{line} > /dev/full <&-")
    check(outcome, path)
    if not outcome.signal and "No space left" in outcome.error:
        assert outcome.code == 1
        assert outcome.error.splitlines()[-1] == (
            f"{' '.join(path)}: cannot write to standard output: No space left on device"
        )
    elif not outcome.signal and path not in _NO_DATA:
        assert outcome.error, "what cannot be written must be told"


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_reader_who_has_had_enough_and_closed_error_are_no_fault(
    path: tuple[str, ...], typed: Callable[..., Outcome]
) -> None:
    line = next(line for line in examples(path) if not re.search(r"[|<>]|\$\(", line))
    outcome = typed(f"{line} 2>&- | head -1; exit ${{PIPESTATUS[0]}}")
    check(outcome, path)
    assert outcome.out.count("\n") <= 1
