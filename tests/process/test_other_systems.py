"""Commands and nodes in processes without the calls, files and options that only Linux has."""

import re
from pathlib import Path

import pytest
from fixtures import macos
from fixtures.says import assert_says

MACOS = {"PYTHONPATH": str(Path(macos.__path__[0]))}
LAUNCH = """
nodes:
  - run: talker
  - run: talker
    name: other
    remap: {chatter: words}
"""


@pytest.fixture(scope="module")
def launched(module_start, lcmtools_path, lcm_program, tmp_path_factory):
    """A launch of two talkers, beside a plain LCM program that sends every 0.4 s."""
    folder = tmp_path_factory.mktemp("launch")
    (folder / "talkers.yaml").write_text(LAUNCH)
    launch = module_start(
        lcmtools_path,
        *("launch", str(folder / "talkers.yaml")),
        **MACOS,
        XDG_STATE_HOME=str(folder),
    )
    launch.wait_for("hello world 1")
    module_start(lcm_program("lcm-source"), "-m", "PLAIN", "-s", "100", "-p", "400000")
    return launch


@pytest.fixture
def run(lcmtools_process, launched, use_module_bus):
    """``run("list") -> output``: a command that is successful."""
    del launched, use_module_bus

    def command(*words):
        result = lcmtools_process(*words, **MACOS)
        assert result.returncode == 0, result
        return result.stdout

    return command


def test_list_shows_topics_of_nodes_and_of_plain_programs(run):
    assert run("list").split() == ["/chatter", "/rosout", "/words", "PLAIN"]
    assert run("type", "/words") == "std_msgs/String\n"


def test_nodes_run_and_are_found(run):
    assert run("node", "list").split() == ["/other", "/talker"]
    assert "reply from /talker" in run("node", "ping", "talker", "-c", "1")
    assert "/chatter: " in run("node", "info", "talker")
    assert re.search(r"messages: \d+, .* rate: \d", run("info", "/chatter"))


def test_echo_hz_and_pub_work(run, start, lcmtools_path):
    assert run("echo", "/words", "-n", "1").startswith('data: "hello world ')
    assert "average rate: " in run("hz", "/chatter", "-n", "1")
    reader = start(lcmtools_path, "echo", "/said", "--json", "-n", "1", **MACOS)
    run("pub", "/said", "std_msgs/String", "{data: hi}", "-1", "-w", "1")
    assert '"hi"' in reader.wait_for("hi")
    assert reader.wait() == 0


def test_wtf_says_which_rules_it_could_not_check(run):
    rows = [line for line in run("wtf").splitlines() if line.startswith("Not checked")]
    listing, reporting = rows
    assert_says(listing, "(", "sockets", "/proc/net/udp))")
    assert_says(reporting, "(", "sockets of programs", "/proc))")


def test_a_killed_node_is_known_to_have_ended(run, start, lcmtools_path):
    node = start(lcmtools_path, "run", "talker", "__name:=victim", **MACOS)
    node.wait_for("hello world 0")
    assert "killed" in run("node", "kill", "victim")
    assert node.wait() == 0
    assert "/victim" not in run("node", "list")


def test_the_launch_ends_its_nodes(run, launched):
    launched.send_signal(2)
    assert launched.wait() == 0
    assert run("list").split() == ["PLAIN"]


ANSWERS = """
import os, socket, sys, time
from lcmtools.bus import kernel, processes, sockets
from lcmtools.bus.socket_filter import heads_only

receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
receiver.bind(("127.0.0.1", 0))
assert kernel.request_arrival(receiver)
socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"x", receiver.getsockname())
while not time.sleep(0.01) and not receiver.recv(1, socket.MSG_PEEK):
    pass
read = time.time_ns()
_, ancillary, *_ = receiver.recvmsg_into([bytearray(9)], kernel.ANCILLARY_BYTES)
received, ttl = kernel.arrival(ancillary)
assert 5_000_000 < read - received < 30_000_000_000, (received, read)
assert ttl is None
assert not kernel.attach(receiver, heads_only())
assert kernel.buffer(receiver) is None
assert kernel.receive_buffer_bytes() == 4 << 20
table = sockets.SocketTable.read()
assert not sockets.sockets_are_known() and table.rows == table.holders == {}
assert table.buffers == table.marks == {} and table.joined_interfaces(1, "239.255.76.67") == ()
assert processes.process_of(os.getppid()) == processes.Process(os.getppid(), "")
assert processes.process_of(2**22 + 1) is None
print("answered")
"""


def test_the_kernel_is_not_asked_for_more_than_it_has(start_python):
    start_python(ANSWERS, **MACOS).wait_for("answered")
