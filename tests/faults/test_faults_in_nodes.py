"""Faults in nodes: killed, stopped, two of one name; and wtf --watch sees one come and go."""

import json
import signal
from pathlib import Path
from typing import Any


def test_a_node_that_was_killed(world: Any) -> None:
    world.node("listener", "chatter:=/news")
    talker = world.node("talker")
    world.node("talker", "__name:=other", "chatter:=/news")
    talker.send_signal(signal.SIGKILL)
    talker.wait()
    found = world.finds("stale-nodes", "/talker", f"(pid {talker.pid}): ended without")
    world.obey(found)  # lcmtools node cleanup
    world.is_silent()


def test_a_node_that_was_stopped(world: Any) -> None:
    world.node("listener")
    talker = world.node("talker")
    talker.wait_for("hello")  # it has its publisher
    talker.send_signal(signal.SIGSTOP)
    found = world.finds("stale-nodes", "/talker", f"(pid {talker.pid}): runs but does not answer")
    assert found.commands == [f"kill -CONT {talker.pid}", f"kill {talker.pid}"]
    world.type(found.commands[0])
    world.until(lambda: talker.pid in world.pids())
    world.is_silent()


def test_two_nodes_of_one_name(world: Any) -> None:
    world.node("listener")
    first, second = world.node("talker"), world.node("talker")
    found = world.finds("duplicate-names", first.pid, second.pid, "/talker", "__name:=talker2")
    world.again(second, "__name:=talker2", "chatter:=/chatter2")
    world.node("listener", "__name:=ear2", "chatter:=/chatter2")
    world.is_silent()
    assert found.severity == "error"


def test_two_that_steer_under_one_name(world: Any) -> None:
    """One cause, one finding: the old process was left over."""
    world.node("sim", "--world", "dolly")
    first, second = world.node("moving_robot"), world.node("moving_robot")
    world.finds("duplicate-names", first.pid, second.pid, wait="1.2s")
    world.end(first)
    world.is_silent()


def test_a_program_with_nearly_all_files_open(world: Any) -> None:
    command = "import sys; kept = [open('/dev/null') for _ in range(960)]\n"
    hears = (
        "import lcm, time\nbus = lcm.LCM()\nbus.subscribe('A', print)\n"
        "print('listens', flush=True)\ntime.sleep(1000)\n"
    )
    world.node("talker")
    world.node("listener")
    program = world.script(f"{hears.rpartition('time')[0]}{command}time.sleep(1000)\n")
    program.wait_for("listens")
    world.until(lambda: len(list(Path(f"/proc/{program.pid}/fd").iterdir())) > 960)
    found = world.finds("open-files", f"pid {program.pid} has 9", "restart them")
    world.end(program)
    world.script(hears, ready="listens")
    world.is_silent()
    assert found.severity == "warning"


def test_watch_shows_what_appears_and_clears(world: Any) -> None:
    world.sends("bus.publish('/good', Twist().encode())")
    watch = world.start(world.command, "wtf", "--watch", "--json", "--wait", "0.3s")
    text = world.start(world.command, "wtf", "--watch", "--wait", "0.3s")
    text.wait_for("No errors or warnings")
    bad = world.sends("m = Twist(); m.linear.x = math.nan; bus.publish('/bad', m.encode())")
    appeared = json.loads(watch.wait_for("appeared"))
    assert (appeared["change"], appeared["rule"]) == ("appeared", "not-finite")
    text.wait_for("WARNING Numbers that are published are none:")
    world.end(bad)
    assert json.loads(watch.wait_for("cleared"))["rule"] == "not-finite"
    text.wait_for("CLEARED Numbers that are published are none:")
    for program in (watch, text):
        program.send_signal(signal.SIGINT)
        assert program.wait() == 130
    world.is_silent()
