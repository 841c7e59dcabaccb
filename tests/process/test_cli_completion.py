"""A shell's candidates: with nodes, plain LCM programs, floods, and no bus at all."""

import os
import socket
import subprocess
import threading
from contextlib import closing

import pytest
from fixtures.says import assert_says
from fixtures.typist import Typist

from lcmtools.bus import quick_probe
from lcmtools.bus.multicast import sending_socket
from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.url import parse_url
from lcmtools.cli.completion.answer import answer
from lcmtools.messages.supply import set_supply
from lcmtools.publish import quick_parameters
from lcmtools.wire.datagram import fragments, short_message

BREAKS = " \t\n\"'><=;|&(:"

_SERVER = """
import lcmtools
from lcmtools.types.std_srvs import SetBool
lcmtools.init()
node = lcmtools.Node("server")
node.declare_parameter("gain", 2.5)
node.create_service(SetBool, "reset", lambda request, response: response)
print("ready", flush=True)
lcmtools.spin(node)
"""


@pytest.fixture
def ask(bus_url, monkeypatch):
    """``ask("lcmtools echo /", **environment)``: the lines that bash gets."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    monkeypatch.setattr(quick_probe, "AT_MOST", 5.0)  # nodes of a busy computer answer late

    def run(line, *, shell="bash", **environment):
        with pytest.MonkeyPatch.context() as patch:
            for name, value in environment.items():
                patch.setenv(name, value)
            return answer(shell, [line, BREAKS])

    yield run
    set_supply(None)


@pytest.fixture
def ask_process(lcmtools_path, bus_url):
    """The same from a process, which is silent whatever happens."""

    def run(line, **environment):
        own = {"LCM_DEFAULT_URL": bus_url, "_LCMTOOLS_COMPLETE": "bash", **environment}
        ended = subprocess.run(
            [lcmtools_path, line, BREAKS],
            env={**os.environ, **own},
            capture_output=True,
            text=True,
            timeout=40,
            check=False,
        )
        assert (ended.returncode, ended.stderr) == (0, "")
        return ended.stdout.splitlines()

    return run


def test_commands_groups_aliases_and_options_are_completed(ask):
    commands = ask("lcmtools ")
    assert {"list", "echo", "pub", "node", "msg", "topic", "run", "completion"} <= set(commands)
    assert ask("lcmtools ec") == ["closed", "echo"]
    assert "ping" in ask("lcmtools node ")
    assert "echo" in ask("lcmtools topic ")
    assert "--once" in ask("lcmtools echo --on")
    assert ask("lcmtools bogus ") == ["closed"]
    assert ask("lcmtools completion z") == ["closed", "zsh"]


def test_a_topic_its_type_and_its_prototype_follow_each_other(ask, start, lcmtools_path, bus_url):
    start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url).wait_for("hello")
    assert ask("lcmtools pub /chat") == ["closed", "/chatter"]
    assert ask("lcmtools pub /chatter ") == ["closed", "std_msgs/String"]
    assert ask("lcmtools pub /chatter std_msgs/String ") == ["closed", "\"{data: ''}\""]
    assert ask("lcmtools echo /chatter.") == ["closed", "/chatter.data"]
    assert ask("lcmtools node info tal") == ["closed", "talker"]
    assert ask("lcmtools list --lcm-url=x --json /") == ["closed"]


def test_services_and_parameters_of_a_running_node(ask, start_python, bus_url, monkeypatch):
    monkeypatch.setattr(quick_parameters, "_ANSWER", 40.0)  # of a busy computer
    start_python(_SERVER, LCM_DEFAULT_URL=bus_url).wait_for("ready")
    assert ask("lcmtools service call /") == ["closed", "/reset"]
    assert ask("lcmtools service call /reset ") == ["closed", '"{data: false}"']
    assert ask("lcmtools param get /server ga") == ["closed", "gain"]
    assert ask("lcmtools param get /server/ga") == ["closed", "/server/gain"]
    assert ask("lcmtools param set /server gain ") == ["closed", "2.5"]


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("lcmtools lab start hu", ["husky"]),
        ("lcmtools lab check pio", ["pioneer"]),
        ("lcmtools lab skeleton kin", ["kinect_viewer"]),
        ("lcmtools wtf --rule kernel", ["kernel-drops"]),
        ("lcmtools wtf --ignore=kernel", ["kernel-drops"]),
        ("lcmtools doctor --explain kernel", ["kernel-drops"]),
        ("lcmtools spy --sort band", ["bandwidth"]),
        ("lcmtools graph --format me", ["mermaid"]),
        ("lcmtools pkg create mine --license M", ["MIT"]),
        ("lcmtools sim spawn h", ["husky"]),
    ],
)
def test_names_that_are_always_there_are_completed(ask, line, found):
    assert ask(line) == ["closed", *found]


@pytest.mark.parametrize(
    "line", ["lcmtools lab check husky --mover ./", "lcmtools param load ", "lcmtools echo -b "]
)
def test_files_are_asked_for_where_one_stands(ask, line):
    assert ask(line) == ["files"]


def test_options_behind_a_nodes_name_are_the_nodes(ask):
    assert ask("lcmtools run talker --pa") == ["closed", "--param"]
    assert "--json" not in ask("lcmtools run talker --")
    assert "--json" in ask("lcmtools run --")


def test_spy_and_graph_take_topics_and_namespaces(ask, start, lcmtools_path, bus_url):
    start(lcmtools_path, "run", "talker", "__ns:=/husky0", LCM_DEFAULT_URL=bus_url).wait_for(
        "hello"
    )
    both = ["closed", "/husky0", "/husky0/chatter", "/husky0/talker"]
    for command in ("spy", "graph", "graph --exclude"):
        assert ask(f"lcmtools {command} /hus") == both
    assert ask("lcmtools graph --topics /hus") == ["closed", "/husky0/chatter"]
    assert ask("lcmtools param load gains.yaml /hus") == ["closed", "/husky0/talker"]


def test_a_plain_program_is_remembered_when_it_is_silent_later(ask, bus_url):
    url, over = parse_url(bus_url), threading.Event()

    def publish():
        with sending_socket(url) as program:
            while not over.wait(0.002):
                program.sendto(short_message(1, "SLOW", bytes(8)), (url.host, url.port))

    program = threading.Thread(target=publish)
    program.start()
    try:
        assert ask("lcmtools echo S") == ["closed", "SLOW"]
    finally:
        over.set()
        program.join()
    assert ask("lcmtools echo S") == ["closed", "SLOW"]


@pytest.mark.parametrize(
    "wrong",
    [
        "nonsense",
        "udpm://10.0.0.1:7667",
        "udpm://239.255.76.67:0",
        "tcpq://127.0.0.1:1",
        "file:///x",
    ],
)
def test_a_bus_that_cannot_be_used_is_passed_over_in_silence(ask, wrong):
    assert ask("lcmtools echo /", LCM_DEFAULT_URL=wrong) == ["closed"]
    assert ask("lcmtools pub /a std_msgs/S", LCM_DEFAULT_URL=wrong) == ["closed", "std_msgs/String"]


@pytest.mark.usefixtures("bare_network")
def test_without_a_network_nothing_is_said_and_nothing_waits(ask):
    assert ask("lcmtools echo /") == ["closed"]
    assert "--once" in ask("lcmtools echo --")


@pytest.mark.timing
@pytest.mark.usefixtures("private_network")
def test_a_bus_full_of_images_hides_no_node(start, lcmtools_path, bus_url):
    talker = start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url)
    talker.wait_for("hello")
    url = parse_url(bus_url)
    with QuickProbe(url) as glance, sending_socket(url) as camera:
        for seqno in range(30):
            for datagram in fragments(seqno, "/camera", bytes(300_000)):
                camera.sendto(datagram, (url.host, url.port))
            camera.sendto(short_message(seqno, "/small", bytes(60_000)), (url.host, url.port))
        names = glance.graph(lambda _: ["a node that never answers"]).topic_names()
    assert names == ["/camera", "/chatter", "/rosout", "/small"]


@pytest.mark.parametrize("what", ["", "bogus", "powershell", "bash_complete"])
def test_a_shell_that_is_not_known_gets_nothing(ask, what):
    assert ask("lcmtools ", shell=what) == []


@pytest.mark.parametrize("line", ["", "lcmtools", '"', "'", "lcmtools '", "lcmtools \\", "(((("])
def test_whatever_is_typed_nothing_is_printed_into_the_prompt(ask_process, line):
    ask_process(line)


def test_completion_works_where_no_folder_can_be_written(ask):
    nowhere = {"XDG_CACHE_HOME": "/dev/null", "XDG_RUNTIME_DIR": "", "HOME": ""}
    assert ask("lcmtools ec", **nowhere) == ["closed", "echo"]


def test_what_goes_wrong_is_written_to_a_file_when_that_is_asked_for(ask_process, tmp_path):
    said = {"XDG_STATE_HOME": str(tmp_path), "PYTHONPATH": str(tmp_path)}
    (tmp_path / "socket.py").write_text("raise RuntimeError('a broken socket')")
    assert ask_process("lcmtools echo /", **said) == []
    assert not (tmp_path / "lcmtools").exists()
    assert ask_process("lcmtools echo /", LCMTOOLS_DEBUG="1", **said) == []
    assert "a broken socket" in (tmp_path / "lcmtools" / "completion.log").read_text()


def test_completion_imports_neither_click_nor_dataclasses_nor_lcm_nor_yaml(
    ask_process, tmp_path, start, lcmtools_path, bus_url, wait_until
):
    start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url).wait_for("hello")
    for module in ("click", "dataclasses", "lcm", "yaml", "numpy", "textual"):
        (tmp_path / f"{module}.py").write_text("raise RuntimeError")
    blocked = {"PYTHONPATH": str(tmp_path)}
    for line in ("lcmtools echo /ch", "lcmtools spy /ch"):  # a busy node may answer too late
        wait_until(lambda line=line: ask_process(line, **blocked) == ["closed", "/chatter"])
    (tmp_path / "dataclasses.py").unlink()  # which the table of labs needs
    assert ask_process("lcmtools lab start h", **blocked) == ["closed", "husky"]
    assert ask_process("lcmtools lab skeleton k", **blocked) == ["closed", "kinect_viewer"]
    assert ask_process("lcmtools wtf --rule ttl", **blocked) == ["closed", "ttl"]


def test_the_script_is_printed_for_the_shell_in_use_or_the_one_named(cli):
    assert "compdef" in cli("completion", env={"SHELL": "/usr/bin/zsh"}).out
    assert "complete -c lcmtools" in cli("completion", "fish", env={"SHELL": "/bin/bash"}).out
    bash = cli("completion", "bash")
    assert bash.code == 0
    assert "complete -o nosort -F" in bash.out
    assert bash.err == ""


def test_installing_says_what_it_did_and_what_to_do_next(cli, tmp_path):
    said = {
        "HOME": str(tmp_path),
        "XDG_CONFIG_HOME": "",
        "XDG_DATA_HOME": "",
        "SHELL": "/bin/fish",
    }
    first = cli("completion", "--install", env=said)
    script = tmp_path / ".config/fish/completions/lcmtools.fish"
    wrote, hint = first.err.splitlines()
    assert wrote == f"wrote {script}"
    assert_says(hint, "new shell", "exec fish")
    assert (first.code, first.out) == (0, "")
    again = cli("completion", "--install", env=said)
    assert again.err.startswith(f"{script} already exists\n")
    gone = cli("completion", "--uninstall", env=said)
    assert gone.err == f"removed {script}\n"
    assert not script.exists()


def test_no_socket_stays_behind(ask_process, bus_url):
    ask_process("lcmtools echo /")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", parse_url(bus_url).port))  # fails where anybody has it


def test_on_a_terminal_it_says_how_it_is_installed_and_prints_no_script(lcmtools_path):
    with closing(Typist(lcmtools_path, "completion", "bash")) as person:
        assert person.end() == 0
    shown = person.written.decode()
    assert "type: lcmtools completion bash --install" in shown
    assert "_lcmtools_completion" not in shown
