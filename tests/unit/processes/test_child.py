"""Child processes: their environment, their failures, their keyboard, and their end."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.processes.reaper import is_gone

TIMEOUTS = StopTimeouts(20.0, 20.0)
ENVIRONMENT = {"PATH": os.environ["PATH"]}

_OF_THE_C_LIBRARY = 0b11 << 31  # signals 32 and 33, which no program can change (signal(7))


@pytest.fixture
def guard():
    with ProcessGuard() as guard:
        yield guard


def run(guard, script, tmp_path, **options):
    """Return all that a shell's script prints."""
    start = Start(["sh", "-c", script], ENVIRONMENT, output=tmp_path / "output", **options)
    with ChildProcess(start, guard, TIMEOUTS) as child:
        assert child.wait(20)
        return child.output(10_000)


def test_it_has_the_given_environment_and_signals_and_no_descriptors(guard, tmp_path):
    script = "env | grep -v -E '^(LCMTOOLS_GUARD|_|PWD|SHLVL|OLDPWD)='; ls /proc/self/fd; "
    script += "grep -e SigIgn -e SigBlk /proc/self/status"
    names, *rest = run(guard, script, tmp_path).split("\n0\n")
    assert names == f"PATH={os.environ['PATH']}"
    assert rest[0].split()[:3] == ["1", "2", "3"], "3 is the folder that ls reads"
    masks = [int(word, 16) for word in rest[0].split()[3:] if not word.startswith("Sig")]
    assert [mask & ~_OF_THE_C_LIBRARY for mask in masks] == [0, 0]


def test_what_cannot_be_started_raises_the_systems_error(guard, tmp_path):
    broken = tmp_path / "broken"
    broken.write_bytes(b"\x7fELF nothing more")
    broken.chmod(0o755)
    missing = ["./there_is_none"]
    for start, error in (
        (Start(missing, ENVIRONMENT), FileNotFoundError),
        (Start(missing, ENVIRONMENT, has_keyboard=True), FileNotFoundError),
        (Start([__file__], ENVIRONMENT, has_keyboard=True), PermissionError),
        (Start([str(broken)], ENVIRONMENT), OSError),
    ):
        with pytest.raises(error):
            ChildProcess(start, guard, TIMEOUTS)


def test_lines_come_from_both_streams(guard):
    start = Start(["sh", "-c", "echo one; echo two >&2; printf three"], ENVIRONMENT)
    with ChildProcess(start, guard, TIMEOUTS) as child:
        assert child.wait(20)
        assert list(child.rest()) == [(False, "one"), (False, "three"), (True, "two")]
        assert child.code == 0


def test_keys_come_through_a_controlling_terminal(guard, tmp_path):
    script = "read line < /dev/tty; echo got $line"
    start = Start(["sh", "-c", script], ENVIRONMENT, has_keyboard=True, output=tmp_path / "output")
    with ChildProcess(start, guard, TIMEOUTS) as child:
        child.press("w\n")
        assert child.wait(20)
        assert child.output(100) == "got w\n"


def test_what_it_prints_on_its_terminal_and_as_errors_is_in_its_file(guard, tmp_path):
    script = "read line; test -t 1 && echo got $line; echo error >&2; test -t 2 || exec false"
    start = Start(["sh", "-c", script], ENVIRONMENT, has_keyboard=True, output=tmp_path / "output")
    with ChildProcess(start, guard, TIMEOUTS) as child:
        child.press("w\n")
        assert child.wait(20)
        assert sorted(child.output(100).splitlines()) == ["error", "got w"]
        assert child.code == 1


def test_files_that_it_writes_are_limited(guard, tmp_path):
    start = Start(
        ["sh", "-c", "read line; yes"],
        ENVIRONMENT,
        has_keyboard=True,
        output=tmp_path / "output",
        most_bytes=5000,
    )
    with ChildProcess(start, guard, TIMEOUTS) as child:
        child.press("\n")
        assert child.wait(20)
        assert len(child.output(10_000)) == 5000


def test_it_is_started_while_other_threads_run(guard, tmp_path):
    stop = threading.Event()
    thread = threading.Thread(target=stop.wait)
    thread.start()
    try:
        assert run(guard, "echo it runs", tmp_path) == "it runs\n"
    finally:
        stop.set()
        thread.join()


def test_end_reaches_what_ignores_signals_and_what_it_has_started(guard, tmp_path, wait_until):
    script = "trap '' INT TERM; sleep 1000 & echo $!; wait; sleep 1000"
    start = Start(["sh", "-c", script], ENVIRONMENT, output=tmp_path / "output")
    with ChildProcess(start, guard, StopTimeouts(0.1, 0.1)) as child:
        wait_until(lambda: child.output(100).endswith("\n"))
        child.end()
        assert child.code == -signal.SIGKILL
        wait_until(child.group_is_gone)


def test_the_guard_ends_what_is_left(tmp_path, wait_until):
    start = Start(["sleep", "1000"], ENVIRONMENT, output=tmp_path / "output")
    with ProcessGuard() as guard:
        child = ChildProcess(start, guard, TIMEOUTS)
    wait_until(lambda: child.code is not None)
    child.release()


_KILLED_BEFORE_ITS_REPORT = """
import os, signal
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.processes.reaper import is_gone

class Killed(ProcessGuard):
    def _tell(self, text):
        if text != "+":
            os.kill(os.getpid(), signal.SIGKILL)
        super()._tell(text)

Killed().start(["sh", "-c", "echo $$ > pid; sleep 1000"], os.environ, "", (None, None, None))
"""


def test_a_child_ends_whose_parent_is_killed_before_it_can_report_the_start(tmp_path, wait_until):
    command = [sys.executable, "-c", _KILLED_BEFORE_ITS_REPORT]
    assert subprocess.run(command, cwd=tmp_path, check=False).returncode == -signal.SIGKILL
    wait_until(lambda: (tmp_path / "pid").is_file() and (tmp_path / "pid").read_text())
    wait_until(lambda: is_gone(int((tmp_path / "pid").read_text())))
