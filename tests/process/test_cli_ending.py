"""The end of commands and nodes: by signals, by a reader who has had enough, by a full disk."""

import os
import re
import signal
import subprocess
import sys
import sysconfig
import threading
from contextlib import suppress
from pathlib import Path

import pytest
from fixtures.says import assert_says

SIGNALS = [signal.SIGINT, signal.SIGTERM]

pytestmark = pytest.mark.usefixtures("use_module_bus")


class Ending:
    """The end of a process."""

    def __init__(self, process, number, watch):
        process.send_signal(number)
        self.seconds = watch.until_end()
        self.out, self.error = process.communicate(timeout=10)
        self.code = process.returncode


@pytest.fixture
def begin(lcmtools_path):
    """``begin("echo", "a")``: a command whose output and errors are told apart."""
    running = []

    def run(*arguments, **options):
        command = [lcmtools_path, *arguments]
        pipe = subprocess.PIPE
        running.append(
            subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, **options)
        )
        return running[-1]

    yield run
    for process in running:
        process.kill()
        process.communicate()


def _path():
    """The PATH with lcmtools on it."""
    return f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"


@pytest.fixture
def shell():
    """Runs a line of bash with lcmtools on the PATH."""

    def run(line):
        return subprocess.run(
            ["bash", "-c", line],  # noqa: S607 - bash is where the system has it
            env={**os.environ, "PATH": _path()},
            capture_output=True,
            text=True,
            timeout=40,
            check=False,
        )

    return run


@pytest.fixture(scope="module")
def talker(module_start, lcmtools_path):
    """A talker on the module's bus."""
    talker = module_start(lcmtools_path, "run", "talker")
    talker.wait_for("hello world")
    return talker


def is_on_the_bus(process):
    """Return whether a process has made a socket, and so is past its command line."""

    def look():
        with suppress(OSError):  # a file that was closed meanwhile
            folder = Path(f"/proc/{process.pid}/fd")
            return any("socket:" in str(path.readlink()) for path in folder.iterdir())
        return False

    return look


@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize(
    ("number", "line"),
    [
        (signal.SIGINT, "echo chatter"),
        (signal.SIGTERM, "echo chatter"),
        (signal.SIGINT, "hz /nothing"),
        (signal.SIGINT, "list --wait 1m"),
        (signal.SIGTERM, "wtf --wait 1m"),
        (signal.SIGINT, "node ping talker"),
        (signal.SIGTERM, "pub /a std_msgs/String x"),
        (signal.SIGINT, "pub -r 100 /a std_msgs/String x"),
    ],
)
def test_command_ends_at_once_with_the_signals_code_and_without_a_word(
    number, line, begin, wait_until, stopwatch
):
    process = begin(*line.split())
    wait_until(is_on_the_bus(process))
    ending = Ending(process, number, stopwatch(process.pid))
    assert ending.code == 128 + number
    assert ending.seconds < 1.0
    assert set(ending.error.splitlines()) <= {
        f"subscribed to [{line.split()[-1]}]",
        "lcmtools pub: no node subscribes to /a yet; publishing anyway",
        "publishing and latching message. Press ctrl-C to terminate",
    }


def _run_program(lines):
    """Run ``lcmtools config`` after these lines; return its exit code, output and errors."""
    begin = "import signal, sys\nfrom lcmtools.__main__ import run\nsys.argv[1:] = ['config']\n"
    program = [sys.executable, "-c", f"{begin}{lines}\nrun()"]
    ended = subprocess.run(program, capture_output=True, check=False, timeout=40)
    return ended.returncode, ended.stdout, ended.stderr


@pytest.mark.parametrize(
    ("number", "place"),
    [
        (signal.SIGINT, "provide_user_types"),
        (signal.SIGTERM, "set_supply"),
        (signal.SIGHUP, "set_supply"),
    ],
)
def test_signal_just_before_or_after_a_command_has_its_code_too(number, place):
    lines = f"""
from lcmtools.cli import main
main.root.invoke = lambda _: 0
main.{place} = lambda *_: signal.raise_signal({number:d})"""
    assert _run_program(lines) == (128 + number, b"", b"")


def test_ctrl_c_that_python_ignores_while_the_command_line_is_imported_ends_it():
    """Python has callbacks in each import, and drops what they raise."""
    lines = """
class Finder:
    def find_spec(self, name, *_):
        if name == "lcmtools.cli.main":
            Finalized()

class Finalized:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Finder())"""
    assert _run_program(lines) == (130, b"", b"")


def test_pub_that_waits_for_standard_input_ends_with_the_signals_code(begin, wait_until, stopwatch):
    process = begin("pub", "-f", "-", "/a", "std_msgs/String")
    wait_until(is_on_the_bus(process))
    ending = Ending(process, signal.SIGINT, stopwatch(process.pid))
    assert (ending.code, ending.out) == (130, "")
    assert ending.seconds < 1.0
    for line in ending.error.splitlines():
        assert_says(line, "lcmtools pub: no node", "/a", "; publishing anyway")


@pytest.mark.parametrize(
    ("number", "node"), [(signal.SIGTERM, "talker"), (signal.SIGINT, "evaluate_controller")]
)
def test_node_ends_within_a_second_quietly_with_0(number, node, begin, cli, wait_until, stopwatch):
    process = begin("run", node, "__ns:=/ending")
    wait_until(lambda: f"/ending/{node}" in cli("node", "list").out)
    ending = Ending(process, number, stopwatch(process.pid))
    assert (ending.code, ending.out) == (0, "")
    assert ending.seconds < 1.0
    assert all(line.startswith("[INFO] ") for line in ending.error.splitlines())
    assert f"/ending/{node}" not in cli("node", "list").out


@pytest.mark.parametrize("number", SIGNALS)
def test_node_that_is_asked_to_end_while_it_starts_ends_with_0(number, begin, tmp_path, stopwatch):
    slow = tmp_path / "lcm"  # takes the place of the real one, and never ends to be imported
    slow.mkdir()
    (slow / "__init__.py").write_text("import sys, time\nprint('hi', flush=True)\ntime.sleep(60)")
    with_lcm = {"PYTHONPATH": str(tmp_path), "LCM_DEFAULT_URL": "memq://"}
    process = begin("run", "talker", env={**os.environ, **with_lcm})
    assert process.stdout is not None
    assert process.stdout.readline() == "hi\n"
    ending = Ending(process, number, stopwatch(process.pid))
    assert (ending.code, ending.error) == (0, "")


@pytest.mark.parametrize("command", ["run talker __ns:=/ending", "echo /nothing", "hz /nothing"])
def test_sigint_ends_what_a_shell_script_has_started_in_the_background(command, shell):
    """There the shell has SIGINT ignored."""
    result = shell(
        f"lcmtools {command} > /dev/null 2>&1 & pid=$!\n"
        "until ls -l /proc/$pid/fd 2> /dev/null | grep -q socket: ; do sleep 0.01; done\n"
        "lcmtools list > /dev/null 2>&1\n"  # so long it takes to be ready
        "kill -INT $pid; wait $pid; echo $?"
    )
    assert result.stdout == ("0\n" if command.startswith("run") else "130\n")
    assert result.stderr == ""


@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize(
    "command",
    [
        "echo --json chatter",
        "info chatter",
        "node ping talker",
        "msg list",
    ],
)
def test_reader_who_has_had_enough_is_no_fault(command, shell):
    result = shell(f"lcmtools {command} | head -1; echo ${{PIPESTATUS[0]}}")
    assert result.stdout.splitlines()[1:] == ["0"]
    assert set(result.stderr.splitlines()) <= {"subscribed to [/chatter]"}


@pytest.mark.parametrize(
    "pipe",
    [
        "echo silent | true",
        "bw silent | true",
        "service call --wait /silent | true",
        "wtf --watch --rule unknown-type | head -1",
    ],
)
def test_reader_who_leaves_ends_what_has_nothing_more_to_say(pipe, shell):
    result = shell(f"lcmtools {pipe}; echo ${{PIPESTATUS[0]}}")
    assert result.stdout.splitlines()[-1] == "0"
    assert "Traceback" not in result.stderr


def test_who_waits_for_the_readers_end_ends_with_the_command(cli, wait_until):
    before = threading.active_count()
    assert cli("echo", "silent", "--timeout", "0.1").code == 4
    wait_until(lambda: threading.active_count() <= before)


@pytest.mark.usefixtures("talker")
@pytest.mark.parametrize(
    "command",
    ["echo chatter", "list", "node ping talker", "wtf"],
)
def test_full_disk_is_one_line_and_the_exit_code_of_a_failure(command, shell):
    result = shell(f"lcmtools {command} > /dev/full")
    name = command.removesuffix(" chatter").removesuffix(" talker")
    assert result.returncode == (64 if command == "wtf" else 1)  # wtf's 1 means warnings
    last = result.stderr.splitlines()[-1]
    assert_says(last, f"lcmtools {name}: ", "standard output: No space left on device")
    assert set(result.stderr.splitlines()[:-1]) <= {"subscribed to [/chatter]"}


@pytest.mark.parametrize("command", ["--version", "echo --help"])
def test_help_on_a_full_disk_is_one_line_and_exit_code_1(command, shell):
    result = shell(f"lcmtools {command} > /dev/full")
    assert result.returncode == 1
    assert result.stderr.count("\n") == 1
    assert result.stderr.endswith("No space left on device\n")


def test_node_goes_on_where_its_log_cannot_be_written(start, cli):
    for number, where in enumerate(("2> /dev/full", "2>&-")):
        command = f"exec lcmtools run talker __ns:=/full{number} {where}"
        start("bash", "-c", command, PATH=_path())
        echo = cli("echo", "-n", "2", f"/full{number}/chatter", "--timeout", "10s")
        assert (echo.code, echo.out.count("hello world")) == (0, 2)


@pytest.mark.parametrize("command", ["list", "bogus", "msg show Nope"])
def test_exit_code_is_the_same_where_nothing_can_be_said(command, shell):
    code = 0 if command == "list" else 2
    assert shell(f"lcmtools {command} 2> /dev/full").returncode == code
    assert shell(f"lcmtools {command} 0<&- 1>&- 2>&-").returncode == code


@pytest.mark.parametrize("stream", ["0", "1", "2"])
def test_closed_stream_is_no_fault(stream, shell):
    result = shell(f"lcmtools list -v /nothing {stream}>&-")
    assert result.returncode == 0
    assert "Traceback" not in result.stderr


def test_data_goes_to_standard_output_and_talk_to_standard_error(cli, bus_url):
    result = cli("list", env={"LCM_DEFAULT_URL": bus_url})
    assert (result.code, result.out) == (0, "")
    assert result.err == f"no topics on {bus_url}\n"
    result = cli("node", "list", env={"LCM_DEFAULT_URL": bus_url})
    assert (result.code, result.out) == (0, "")
    assert result.err == f"no nodes on {bus_url}\n"


def test_a_deleted_working_directory_is_told_with_a_remedy(shell, tmp_path):
    result = shell(f"mkdir {tmp_path}/a; cd {tmp_path}/a; rmdir {tmp_path}/a; lcmtools run talker")
    told = "lcmtools run: the working directory has been deleted; go to another one: cd\n"
    assert result.returncode == 1
    # a path with blanks is started by a shell, which complains first
    assert re.sub(r"sh: .*getcwd.*\n", "", result.stderr) == told


def test_an_lcm_package_without_its_library_is_told_with_a_remedy(lcmtools_process, tmp_path):
    (tmp_path / "lcm").mkdir()
    (tmp_path / "lcm" / "__init__.py").write_text(
        "try:\n    raise ImportError('libglib-2.0.so.0: cannot open shared object file')\n"
        "except ImportError:\n    from .Release import _lcm\n"  # as the package's own file does
    )
    with_lcm = {"PYTHONPATH": str(tmp_path), "LCM_DEFAULT_URL": "memq://"}
    result = lcmtools_process("run", "talker", **with_lcm)
    assert result.returncode == 3
    assert_says(result.stderr, "lcmtools run talker: ", "package lcm", "libglib-2.0.so.0: cannot")
    assert result.stderr.count("\n") == 1
    assert "apt install libglib2.0-0" in result.stderr
