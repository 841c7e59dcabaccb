"""node kill, on real processes: which end, how, and what is said of those that do not."""

import json
import os
import pty
import signal
import socket
from collections.abc import Callable
from typing import Any

import pytest
from fixtures.says import assert_line, assert_says

pytestmark = pytest.mark.usefixtures("on_bus")

Run = Callable[..., Any]
HOST = socket.gethostname()

_TWO = """
import lcmtools
lcmtools.init()
one, two = lcmtools.Node("one"), lcmtools.Node("two")
print("ready", flush=True)
lcmtools.spin(one, two)
lcmtools.shutdown()
print("ended in order", flush=True)
"""

_HANGS = """
import time
import lcmtools
lcmtools.init()
node = lcmtools.Node("hangs")
def hang():
    print("ready", flush=True)
    while True:
        try:
            time.sleep(1)
        except KeyboardInterrupt:
            pass
node.create_timer(0.01, hang)
lcmtools.spin(node)
"""

_WITHOUT_SPIN = """
import time
import lcmtools
lcmtools.init()
node = lcmtools.Node("loops")
print("ready", flush=True)
while lcmtools.ok():
    time.sleep(0.05)
lcmtools.shutdown()
"""


def test_a_node_ends_with_exit_code_0_and_a_goodbye(node, cli):
    talker = node("talker")
    result = cli("node", "kill", "talker")
    assert (result.code, result.out) == (0, "killing /talker\nkilled\n")
    assert result.err == ""
    assert talker.wait() == 0
    assert "[/talker]: shutdown requested by " in talker.output
    assert cli("node", "list").out == ""


def test_a_node_that_does_not_spin_hears_it_too(start_python, cli):
    program = start_python(_WITHOUT_SPIN)
    program.wait_for("ready")
    assert cli("node", "kill", "loops").code == 0
    assert program.wait() == 0


def test_all_nodes_of_a_process_end_and_that_is_said(start_python, cli):
    program = start_python(_TWO)
    program.wait_for("ready")
    result = cli("node", "kill", "/one")
    assert (result.code, result.out) == (0, "killing /one\nkilled\n")
    assert_line(result.err, "ended with /one", "same process: /two")
    assert program.wait() == 0
    program.wait_for("ended in order")


def test_a_node_that_hangs_is_exit_code_1_with_what_to_type(start_python, node, cli):
    hangs = start_python(_HANGS)
    hangs.wait_for("ready")
    talker = node("talker")
    result = cli("node", "kill", "--timeout", "800ms", "hangs", "talker")
    assert result.code == 1
    assert result.out == "killing:\n * /hangs\n * /talker\nkilled /talker\n"
    parts = ("/hangs", "still runs", "0.8 s; ", f"kill -9 {hangs.pid}\n")
    assert_line(result.err, "lcmtools node kill: ", *parts)
    assert talker.wait() == 0


def test_a_node_that_is_stopped_does_not_answer(node, cli):
    talker = node("talker")
    talker.send_signal(signal.SIGSTOP)
    result = cli("node", "kill", "--timeout", "300ms", "--json", "talker")
    assert result.code == 1
    (record,) = json.loads(result.out)
    assert (record["pid"], record["heard"], record["ended"]) == (talker.pid, False, False)
    parts = ("/talker", "not answer; ", f"kill -9 {talker.pid}\n")
    assert_line(result.err, "lcmtools node kill: ", *parts)


def test_a_node_that_was_killed_is_not_waited_for(node, cli):
    talker = node("talker")
    talker.send_signal(signal.SIGKILL)
    talker.wait()
    result = cli("node", "ping", "talker", "--timeout", "1h")
    assert result.code == 4
    assert_says(result.err, "/talker ended without saying goodbye; ", "lcmtools node cleanup")


def test_of_two_equal_names_the_pid_tells_which(node, cli):
    first, second = node("talker"), node("talker")
    result = cli("node", "kill", "talker")
    assert (result.code, result.out) == (1, "")
    assert_says(result.err, "2 nodes", "talker; ", "pid: ")
    assert f"{first.pid} on {HOST}" in result.err
    assert cli("node", "kill", str(second.pid)).code == 0
    assert second.wait() == 0
    (left,) = json.loads(cli("node", "list", "--json").out)
    assert left["pid"] == first.pid


def test_nothing_is_killed_where_one_of_the_names_is_unknown(node, cli, wait_until):
    node("talker")
    result = cli("node", "kill", "talker", "listner")
    assert (result.code, result.out) == (1, "")
    wait_until(lambda: cli("node", "list").out == "/talker\n")


def test_a_command_that_listens_ends_as_by_sigterm(start, cli, lcmtools_path, wait_until):
    echo = start(lcmtools_path, "echo", "/chatter")
    name = f"_lcmtools_echo_{echo.pid}"
    wait_until(lambda: name in cli("node", "list", "-a").out)
    assert cli("node", "kill", name).code == 0
    assert echo.wait() == 143


def test_a_program_that_is_no_node_is_left_alone(start, cli, lcm_program):
    source = start(lcm_program("lcm-source"), "-m", "EXAMPLE")
    for word in ("lcm-source", str(source.pid)):
        result = cli("node", "kill", word)
        assert (result.code, result.out) == (1, "")
        program = f"lcm-source -m EXAMPLE (pid {source.pid})"
        parts = (program, "not a node", f"; type: kill {source.pid}\n")
        assert_line(result.err, "lcmtools node kill: ", *parts)
        answer = cli("node", "ping", word)
        assert answer.code == 1
        place = f"{socket.gethostname()}:{source.pid}"
        parts = (program, "not a node and answers no ping", f"; lcmtools node info {place} shows")
        assert_line(answer.err, "lcmtools node ping: ", *parts)
    os.kill(source.pid, 0)


def test_all_needs_yes_without_a_terminal(node, cli):
    talker, listener = node("talker"), node("listener")
    result = cli("node", "kill", "--all")
    assert (result.code, result.out) == (2, "")
    assert_line(result.err, "lcmtools node kill: --all", "2 nodes", "; add --yes\n")
    result = cli("node", "kill", "--all", "--yes")
    assert (result.code, result.err) == (0, "")
    assert result.out == "killing:\n * /listener\n * /talker\nkilled\n"
    assert (talker.wait(), listener.wait()) == (0, 0)
    result = cli("node", "kill", "-a", "-y")
    assert (result.code, result.out, result.err) == (0, "", "no nodes running\n")


@pytest.mark.parametrize(("typed", "is_killed"), [("y\n", True), ("n\n", False), ("\x04", False)])
def test_all_asks_a_person(typed, *, is_killed, node, cli, lcmtools_path, wait_until):
    node("talker")
    text = _at_a_terminal([lcmtools_path, "node", "kill", "--all"], typed)
    assert " * /talker" in text
    assert "Kill all nodes? [y/N]" in text
    wait_until(lambda: cli("node", "list").out == ("" if is_killed else "/talker\n"))


def test_without_a_name_a_person_chooses_from_a_list(node, cli, lcmtools_path, wait_until):
    node("talker")
    node("listener")
    text = _at_a_terminal([lcmtools_path, "node", "kill"], "2\n")
    assert "1. /listener\r\n2. /talker\r\n" in text
    wait_until(lambda: cli("node", "list").out == "/listener\n")


def _at_a_terminal(command, typed):
    """Run a command at a terminal of its own and type something; what is on the screen then."""
    pid, terminal = pty.fork()
    if pid == 0:  # pragma: no cover - another process
        os.execv(command[0], command)  # noqa: S606 - no shell is wanted
    text = b""
    asked = False
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:  # it has ended
            break
        if not part:
            break
        text += part
        if not asked and text.rstrip().endswith((b"[y/N]:", b"to kill:", b"(1<=x<=2):")):
            asked = True
            os.write(terminal, typed.encode())
    os.waitpid(pid, 0)
    os.close(terminal)
    return text.decode()
