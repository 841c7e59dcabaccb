"""A node in a container on the host's network: its pid is that of another process here."""

import os
import shlex
import shutil
import signal
from pathlib import Path

import pytest

from lcmtools.bus.processes import Process

pytestmark = [pytest.mark.usefixtures("on_bus"), pytest.mark.root]

_PID = 2  # in the container, where its first process is 1


@pytest.fixture
def contained(start, lcmtools_path, cli):
    """``lcmtools run talker`` in a pid namespace of its own; its pid here."""
    unshare = shutil.which("unshare") or pytest.skip("pid namespaces need unshare")
    program = ("sh", "-c", f"{shlex.quote(lcmtools_path)} run talker & wait")
    start(unshare, "-pf", "--kill-child", "--mount-proc", *program)
    while f":{_PID} \t/talker" not in cli("node", "list", "-a", "--wait", "0s").out:
        pass
    (pid,) = (int(one.name) for one in Path("/proc").glob("[0-9]*") if _is_it(int(one.name)))
    return pid


def _is_it(pid):
    own, (namespace, inner) = Process(os.getpid()).innermost_pid, Process(pid).innermost_pid
    if inner != _PID or namespace == own[0]:
        return False
    return b"talker" in Path(f"/proc/{pid}/cmdline").read_bytes()


def test_a_contained_node_is_not_taken_for_the_process_of_its_number(contained, cli):
    shown = cli("node", "info", "talker").out
    assert ", in another container\n" in shown
    assert f"Pid: {_PID}\n" in shown
    assert "Memory" not in shown
    assert f":{contained}" not in cli("node", "list", "-a", "--wait", "0s").out  # no other program
    os.kill(contained, signal.SIGSTOP)
    try:
        killed = cli("node", "kill", "talker", "--timeout", "0.3s")
        assert killed.err.endswith(f"type: kill {contained}\n")  # a program of that number here
        assert "no node has ended" in cli("node", "cleanup").err
        assert "ended without" not in cli("node", "list", "-a", "--wait", "0s").out
    finally:
        os.kill(contained, signal.SIGCONT)
    while "/talker" not in cli("node", "list").out:
        pass
    assert cli("node", "kill", "talker").out == "killing /talker\nkilled\n"
