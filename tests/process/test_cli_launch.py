"""launch: processes that are started, shown, started again and surely ended."""

import json
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
from fixtures.says import assert_says

STUBBORN = "trap '' INT; echo ready; while true; do sleep 0.05; done"
DEAF = "trap '' INT TERM HUP; sleep 100 & echo ready $!; while true; do sleep 0.05; done"


@pytest.fixture(autouse=True)
def _state(tmp_path, bus_url, monkeypatch):
    """A bus, a folder for logs, and a workspace of the test's own: nobody else's packages count."""
    (tmp_path / "mine").mkdir()
    project = '[project]\nname = "mine"\n[tool.lcmtools]\n'
    (tmp_path / "mine" / "pyproject.toml").write_text(project)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def launch(start, lcmtools_path, tmp_path):
    """``launch(text, *arguments)``: a launch of a file that has this text."""

    def run(text, *arguments, **environment):
        (tmp_path / "a.yaml").write_text(text)
        return start(lcmtools_path, "launch", "a.yaml", *arguments, **environment)

    return run


@dataclass(frozen=True)
class Done:
    """A launch that has ended."""

    code: int
    output: str

    @property
    def lines(self):
        """Standard output, then standard error."""
        return self.output.splitlines()


@pytest.fixture
def launched(cli, tmp_path):
    """``launched(text, *arguments, until="", ends_by=...)``: the same to its end, in here."""

    def run(text, *arguments, **options):
        (tmp_path / "a.yaml").write_text(text)
        result = cli("launch", "a.yaml", *arguments, **options)
        return Done(result.code, result.out + result.err)

    return run


def shell(script, name="node", more=""):
    """A node that is a shell's script, as part of the list of nodes."""
    return f"  - {{exec: {json.dumps(f'sh -c {json.dumps(script)}')}, name: {name}{more}}}\n"


def nodes(*scripts):
    """A launch file with these nodes."""
    return "nodes:\n" + "".join(scripts)


def is_running(pid):
    """Return whether a process runs; one that only waits for its parent to look does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state not in "ZX"


def pid_of(program, name):
    """Return the process of a node, once it was started."""
    return int(program.wait_for(f"[{name}] started").rpartition(" ")[2])


def pid_in(program, name):
    """Return the process that a node had."""
    line = next(line for line in program.lines if line.startswith(f"[{name}] started"))
    return int(line.rpartition(" ")[2])


def table(program):
    """The closing table: the cells behind each node's name."""
    first = next(i for i, line in enumerate(program.lines) if line.startswith("node  "))
    rows = [line.split("  ") for line in program.lines[first + 1 :]]
    return {row[0].strip(): [cell.strip() for cell in row[1:] if cell.strip()] for row in rows}


def test_labs_file_runs_its_node_in_the_namespace_until_ctrl_c(
    start, cli, lcmtools_path, wait_until
):
    program = start(lcmtools_path, "launch", "simple_controller.launch", "__ns:=/husky0")
    name = "/husky0/husky_simple_controller"
    wait_until(lambda: cli("node", "list").out == f"{name}\n")
    assert " * /husky0/velocity_cmd [sensor_msgs/JointState]" in cli("node", "info", name).out
    program.send_signal(signal.SIGINT)
    assert program.wait() == 0
    assert table(program)[name][:2] == ["ended when asked to", "0"]
    assert cli("node", "list").out == ""


_INTERRUPTED_START = """
import os, signal, sys
if sys.orig_argv[2:3] == ["run"]:
    os.kill(os.getpid(), signal.SIGINT)
"""


def test_a_node_that_is_interrupted_while_python_starts_prints_no_traceback(
    launched, tmp_path, monkeypatch
):
    (tmp_path / "sitecustomize.py").write_text(_INTERRUPTED_START)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    done = launched("nodes: [{run: talker}]\n")
    assert "Traceback" not in done.output
    assert any("died with exit code 130" in line for line in done.lines)


def test_nohup_lets_a_launch_go_on(start, lcmtools_path, tmp_path):
    (tmp_path / "a.yaml").write_text(nodes(shell("while sleep 0.05; do echo tick; done")))
    program = start("nohup", lcmtools_path, "launch", "a.yaml")
    program.wait_for("tick")
    program.send_signal(signal.SIGHUP)
    for _ in range(20):
        program.wait_for("tick")
    assert "asking" not in program.output
    program.send_signal(signal.SIGINT)
    assert program.wait() == 0


def test_lines_have_their_nodes_name_and_are_in_its_log(launched, tmp_path):
    program = launched(
        nodes(
            shell("echo one; echo two >&2; printf last", "first", ", ns: a"),
            shell("echo quiet; echo loud >&2", "second", ", output: log"),
            shell("echo shown", "third", ", output: screen"),
        )
    )
    assert program.code == 0
    shown = {line for line in program.lines if "] started" not in line and "] ended" not in line}
    assert {"[a/first-1] one", "[a/first-1] two", "[a/first-1] last"} <= shown
    assert {"[second-2] loud", "[third-3] shown"} <= shown
    assert "[second-2] quiet" not in shown
    latest = tmp_path / "state" / "lcmtools" / "log" / "latest"
    assert {path.name for path in latest.iterdir()} == {"a-first-1.log", "second-2.log"}
    assert sorted((latest / "a-first-1.log").read_text().splitlines()) == ["last", "one", "two"]
    assert set((latest / "second-2.log").read_text().splitlines()) == {"quiet", "loud"}
    assert table(program)["/a/first"][1:] == ["0", str(latest.resolve() / "a-first-1.log")]
    assert table(program)["/third"] == ["ended", "0", "-"]


@pytest.mark.parametrize(("option", "is_shown"), [("--screen", True), ("--log", False)])
def test_output_of_all_nodes_is_said_on_the_command_line(
    launched,
    option,
    is_shown,
):
    program = launched(nodes(shell("echo a line", "n")), option)
    assert program.code == 0
    assert ("[n-1] a line" in program.lines) is is_shown


def test_node_that_fails_makes_exit_code_1_and_the_others_go_on(launched):
    program = launched(nodes(shell("exit 3", "bad"), shell("sleep 0.3; echo well", "good")))
    assert program.code == 1
    assert "[good-2] well" in program.lines
    rows = table(program)
    assert rows["/bad"][0] == "died with exit code 3"
    assert rows["/good"][0] == "ended"


def test_node_that_dies_by_a_signal_is_told(launched):
    program = launched(nodes(shell("kill -SEGV $$", "bad")))
    assert program.code == 1
    assert table(program)["/bad"][0] == "died by SIGSEGV"


def test_node_is_started_again_after_its_delay(launched, tmp_path):
    script = "echo run >> runs; exit 1"
    text = nodes(shell(script, "n", ", respawn: true, respawn_delay: 0.2"))
    program = launched(text, until="starts again in 1 s")
    assert program.code == 0
    events = [line for line in program.lines if " again" in line and "log" not in line]
    # one that keeps dying is given ever more time
    parts = ("0.2 s", ", pid", "0.5 s", ", pid", "1 s", "Ctrl-C")
    for event, part in zip(events, parts, strict=True):
        assert_says(event, part)
    assert all(event.startswith("[n-1]") for event in events[:-1])
    assert table(program)["/n"][:2] == ["died with exit code 1", "2"]
    assert (tmp_path / "runs").read_text() == "run\n" * 3


@pytest.mark.parametrize(("code", "result"), [(0, 0), (4, 1)])
def test_end_of_a_required_node_ends_all(launched, code, result):
    program = launched(
        nodes(
            shell("echo ready; exec sleep 100", "other"),
            shell(f"sleep 0.2; exit {code}", "must", ", required: true"),
        )
    )
    assert_says(program.output, "[must-2]", "required", "all nodes")
    assert program.code == result
    assert table(program)["/other"][0] == "ended by SIGINT"


def test_signals_follow_each_other_in_the_times_that_are_set(launch, wait_until):
    program = launch(
        nodes(shell(STUBBORN, "stubborn"), shell(DEAF, "deaf")),
        *("--sigint-timeout", "300ms", "--sigterm-timeout", "300ms"),
    )
    wait_until(lambda: program.output.count("] ready") == 2)
    sleeper = int(program.wait_for("[deaf-2] ready").rpartition(" ")[2])
    program.send_signal(signal.SIGINT)
    started = time.monotonic()
    assert program.wait() == 0
    assert 0.6 <= time.monotonic() - started < 5
    rows = table(program)
    assert (rows["/stubborn"][0], rows["/deaf"][0]) == ("ended by SIGTERM", "ended by SIGKILL")
    assert not is_running(sleeper)


def test_ctrl_c_again_goes_on_at_once(launch):
    program = launch(nodes(shell(DEAF, "deaf")))
    program.wait_for("ready")
    program.send_signal(signal.SIGINT)
    program.wait_for("Ctrl-C again: at once")
    for _ in range(2):
        time.sleep(0.1)  # two signals that come together are one
        program.send_signal(signal.SIGINT)
    assert program.wait(5) == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_other_signals_end_it_in_order_too(launched, number):
    program = launched("nodes: [{run: talker}]", until="hello world", ends_by=number)
    assert program.code == 0
    assert table(program)["/talker"][0] == "ended when asked to"


def test_nothing_outlives_a_launcher_that_is_killed(launch, wait_until):
    quick = 'trap "echo asked >> end; exit" INT; echo ready; while true; do sleep 0.05; done'
    program = launch(
        nodes(
            shell(DEAF, "deaf"),
            shell("sleep 100; true", "plain"),
            shell(quick, "quick"),
            "  - run: talker\n",
        )
    )
    pids = [pid_of(program, name) for name in ("deaf-1", "plain-2", "quick-3", "talker-4")]
    program.wait_for("hello world")
    pids += [int(line.split()[-1]) for line in program.lines if line.startswith("[deaf-1] ready")]
    assert len(pids) == 5
    program.send_signal(signal.SIGKILL)
    wait_until(lambda: not any(map(is_running, pids)), 2.5)
    assert Path("end").read_text() == "asked\n", "a node that heeds SIGINT is asked once"


def test_nothing_is_started_where_a_program_is_missing(launched, tmp_path):
    program = launched(nodes(shell("touch started", "a"), "  - run: talkr\n"))
    assert program.code == 2
    (line,) = program.lines
    assert_says(line, "lcmtools launch: a.yaml:3: ", "'talkr'", "did you mean talker?")
    assert not (tmp_path / "started").exists()
    assert not (tmp_path / "state").exists()


def test_program_that_the_system_refuses_ends_what_was_started(launched, tmp_path):
    (tmp_path / "broken").write_bytes(b"\x7fELF nothing more")
    (tmp_path / "broken").chmod(0o755)
    program = launched(nodes(shell("exec sleep 100", "a"), "  - {exec: ./broken, name: b}\n"))
    assert program.code == 1
    rows = table(program)
    assert rows["/a"][0] == "ended by SIGINT"
    assert_says(rows["/b"][0], "cannot", "Exec format error")


@pytest.mark.parametrize(("more", "expected"), [("", ""), (", stdin: true", "hello\n")])
def test_standard_input_is_for_the_node_that_asks_for_it(cli, tmp_path, more, expected):
    (tmp_path / "a.yaml").write_text(f"nodes: [{{exec: cat{more}}}]")
    result = cli("launch", "a.yaml", input="hello\n")
    assert (result.code, result.out) == (0, expected)


def test_launch_file_comes_from_a_pipe(cli):
    text = '<launch><node pkg="lcmtools" type="talker" name="t"/></launch>'
    result = cli("launch", "-", "--nodes", "__ns:=/a", input=text)
    assert (result.code, result.out) == (0, "/a/t\n")


def test_reader_that_has_had_enough_ends_it(lcmtools_path, tmp_path):
    (tmp_path / "a.yaml").write_text(nodes(shell("while echo line; do sleep 0.01; done", "n")))
    done = subprocess.run(
        ["bash", "-c", '"$0" launch a.yaml | head -n 2; echo ${PIPESTATUS[0]}', lcmtools_path],  # noqa: S607 - bash, wherever it is
        capture_output=True,
        text=True,
        timeout=40,
        check=False,
    )
    assert done.stdout.splitlines() == ["[n-1] line", "[n-1] line", "0"]


def test_prefixes_have_colour_only_where_it_is_wanted(launched):
    text = nodes(shell("echo a", "n"))
    colored, plain = launched(text, env={"LCMTOOLS_COLOR": "always"}), launched(text)
    assert (colored.code, plain.code) == (0, 0)
    assert "\x1b[32m[n-1]\x1b[0m a" in colored.lines
    assert "\x1b" not in plain.output


def test_a_nodes_colours_pass_and_what_else_controls_the_terminal_is_escaped(launched):
    says = r"printf '\033[31mred\033[0m \033[2J\033]0;title\007\n'"
    for text in (nodes(shell(says, "n")), nodes(shell(f"{says} >&2", "n"))):
        assert "[n-1] \x1b[31mred\x1b[0m \\x1b[2J\\x1b]0;title\\x07" in launched(text).lines


def test_all_nodes_are_on_the_chosen_bus_but_those_that_the_file_puts_elsewhere(launched, bus_url):
    say = "echo url=$LCM_DEFAULT_URL ns=$LCMTOOLS_NAMESPACE"
    text = nodes(shell(say, "a", ", ns: x"), shell(say, "b", ', env: {LCMTOOLS_DOMAIN: "5"}'))
    program = launched(text, "--lcm-url", bus_url, env={"LCM_DEFAULT_URL": ""})
    assert program.code == 0
    assert f"[x/a-1] url={bus_url} ns=/x" in program.lines
    assert "[b-2] url=udpm://239.255.76.67:7672?ttl=0 ns=" in program.lines


def test_questions_are_answered_and_nothing_is_run(cli, tmp_path):
    (tmp_path / "a.launch").write_text(
        """<launch><arg name="who" doc="whom to greet"/><arg name="n" default="1"/>
        <node pkg="lcmtools" type="talker" name="t$(arg n)" args="$(arg who)"/></launch>"""
    )

    def ask(*words):
        result = cli("launch", "a.launch", *words)
        assert (result.code, result.err) == (0, "")
        return result.out

    line = "lcmtools run talker bob __ns:=/ __name:=t1"
    assert ask("--nodes", "who:=bob") == "/t1\n"
    assert json.loads(ask("--nodes", "who:=bob", "--json")) == ["/t1"]
    assert ask("--args", "t1", "who:=bob") == f"{line}\n"
    assert json.loads(ask("--args", "/t1", "who:=bob", "--json"))["command"] == line.split()
    assert ask("--files", "who:=bob") == f"{tmp_path}/a.launch\n"
    expected = 'Required Arguments:\n  who: whom to greet\nOptional Arguments:\n  n (default "1")\n'
    assert ask("--show-args") == ask("--ros-args") == expected
    assert json.loads(ask("--show-args", "--json"))[0] == {
        "name": "who",
        "default": None,
        "doc": "whom to greet",
    }
    dry = ask("--dry-run", "who:=bob")
    assert dry == f"# /t1 (a.launch:2; output log)\n{line}\n"
    assert json.loads(ask("--dry-run", "who:=bob", "--json"))[0]["line"] == line
    assert not (tmp_path / "state").exists()


def test_a_node_is_found_with_file_and_line(cli, tmp_path):
    (tmp_path / "a.yaml").write_text(nodes("  - run: talker\n", "  - run: listener\n"))
    found = cli("launch", "a.yaml", "--find-node", "listener")
    assert (found.code, found.out) == (0, "a.yaml:3\n")
    record = cli("launch", "a.yaml", "--find-node", "/listener", "--json").out
    assert json.loads(record) == {"node": "/listener", "place": "a.yaml:3"}


def test_parameters_are_dumped_as_param_load_takes_them(cli, tmp_path):
    (tmp_path / "a.yaml").write_text(
        "nodes:\n"
        "  - {run: talker, ns: a, param: {rate: 2.5, who: 'true', gains: [1, 2], 'deep/down': x}}\n"
        "  - {run: listener, args: _queue:=5 not_a_parameter:=6}\n"
        "  - {run: sim, name: without}\n"
    )
    dumped = cli("launch", "a.yaml", "--dump-params")
    assert dumped.out.splitlines() == [
        "/a/talker:",
        "  rate: 2.5",
        '  who: "true"',
        "  gains: [1, 2]",
        "  deep/down: x",
        "/listener:",
        "  queue: 5",
    ]
    records = json.loads(cli("launch", "a.yaml", "--dump-params", "--json").out)
    assert records[0]["parameters"] == {
        "rate": 2.5,
        "who": "true",
        "gains": [1, 2],
        "deep/down": "x",
    }
    assert records[2] == {"node": "/without", "parameters": {}}


@pytest.mark.usefixtures("bare_network")
def test_nodes_start_when_there_is_a_network(launch, ip):
    program = launch(nodes(shell("echo it runs", more=", output: screen")), "--wait")
    program.wait_for("lcmtools launch: waiting for the bus: no multicast route")
    assert "it runs" not in program.output
    ip("link", "set", "lo", "up")
    ip("route", "add", "224.0.0.0/4", "dev", "lo")
    program.wait_for("it runs")
    assert program.wait() == 0
    assert sum("waiting for the bus" in line for line in program.lines) == 1


def test_printed_command_line_is_what_a_shell_takes(cli, tmp_path):
    (tmp_path / "a.yaml").write_text(
        "nodes:\n"
        '  - exec: sh -c \'echo "$X" "$0" "$PWD"\' "it\'s"\n'
        "    name: n\n    cwd: .\n    env: {X: a b}\n"
    )
    line = cli("launch", "a.yaml", "--args", "n").out
    printed = subprocess.run(["sh", "-c", line], capture_output=True, text=True, check=True)  # noqa: S607
    assert printed.stdout == f"a b it's {tmp_path}\n"


def test_notes_are_told_and_the_rest_is_run(cli, tmp_path):
    (tmp_path / "a.launch").write_text(
        '<launch>\n<nodde/><node pkg="lcmtools" type="talker" name="t"/></launch>'
    )
    result = cli("launch", "a.launch", "--nodes")
    assert (result.code, result.out) == (0, "/t\n")
    (line,) = result.err.splitlines()
    assert_says(line, "lcmtools launch: a.launch:2: ", "'nodde'", "did you mean node?")


def test_launcher_that_has_no_place_for_logs_says_so_before_it_starts_anything(launched, tmp_path):
    (tmp_path / "file").touch()
    program = launched(
        nodes(shell("touch started")), env={"XDG_STATE_HOME": str(tmp_path / "file")}
    )
    assert program.code == 1
    assert_says(program.output, "cannot", "folder", "log files")
    assert not (tmp_path / "started").exists()


def test_many_nodes_are_launched_and_ended_together(launched):
    text = nodes(*(shell("echo up; exec sleep 100", f"n{i}") for i in range(20)))
    program = launched(text, until=lambda text: text.count("] up") == 20)
    assert program.code == 0
    assert len(table(program)) == 20
    assert not any(is_running(pid_in(program, f"n{i}-{i + 1}")) for i in range(20))


def test_ctrl_c_counts_while_nobody_reads_what_is_shown(lcmtools_path, tmp_path, wait_until):
    text = nodes(shell("echo $$ > pid; while true; do echo much to read; done", "n"))
    (tmp_path / "a.yaml").write_text(text)
    command = [lcmtools_path, "launch", "a.yaml"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
        wait_until(lambda: Path("pid").is_file() and Path("pid").read_text().endswith("\n"))
        pid = int(Path("pid").read_text())
        log = tmp_path / "state" / "lcmtools" / "log" / "latest" / "n-1.log"
        sizes = [-1]
        # it is stuck when nothing more comes into the log
        wait_until(lambda: sizes.append(log.stat().st_size) or sizes[-1] == sizes[-2] > 30_000)
        program.send_signal(signal.SIGINT)
        assert program.wait() == 0
        assert not is_running(pid)


def test_log_shows_a_nodes_warnings_only(launched):
    script = "echo '[INFO] [1] [/n]: fine' >&2; echo '[WARN] [1] [/n]: not fine' >&2"
    program = launched(nodes(shell(script, "n", ", output: log")))
    assert program.code == 0
    assert "[n-1] [WARN] [1] [/n]: not fine" in program.lines
    assert "[INFO]" not in program.output
