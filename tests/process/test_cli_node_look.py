"""node list, info and ping: more than the plain forms, and programs that are no nodes."""

import json
import re
import signal
import socket
import sys

import pytest
from fixtures.says import assert_says

HOST = socket.gethostname()

_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("POSE", lambda *_: None)
print("ready", flush=True)
while True:
    bus.handle()
"""


@pytest.fixture(scope="module")
def programs(module_start, lcmtools_path, lcm_program):
    """A talker, a listener in a namespace, lcm-source, and a script that only listens."""
    started = {
        "plain": module_start(sys.executable, "-c", _LISTENER),
        "source": module_start(lcm_program("lcm-source"), "-m", "EXAMPLE"),
        "listener": module_start(lcmtools_path, "run", "listener", "__ns:=/r", "chatter:=/chatter"),
        "talker": module_start(lcmtools_path, "run", "talker"),
    }
    started["plain"].wait_for("ready")
    started["listener"].wait_for("I heard: [hello world")
    return started


pytestmark = pytest.mark.usefixtures("use_module_bus", "programs")


def test_all_shows_host_pid_and_up_time_in_rosnodes_order(cli, programs):
    nodes, _, _ = cli("node", "list", "-a").out.partition("\n\n")
    rows = [row for row in nodes.splitlines() if "_lcmtools" not in row]
    expected = [("/r/listener", programs["listener"].pid), ("/talker", programs["talker"].pid)]
    for row, (name, pid) in zip(rows, expected, strict=True):
        assert re.fullmatch(rf"{re.escape(HOST)}:{pid} \t{name}\tup [\d.]+ (s|min)", row)


def test_all_shows_programs_that_are_no_nodes_under_a_heading(cli, programs):
    _, _, others = cli("node", "list", "-a").out.partition("\n\n")
    assert_says(others.partition("\n")[0], "not nodes", "bus")
    source, plain = programs["source"].pid, programs["plain"].pid
    assert re.search(
        rf"{HOST}:{source} \t.*lcm-source -m EXAMPLE \(user .+\)\n\tpublishes EXAMPLE\n", others
    )
    # on a busy computer it may have lost something
    assert re.search(rf"{HOST}:{plain} \t.*\n\tlistens( \(\d+ datagrams .*\))?\n", others)


def test_json_marks_them_as_observed(cli, programs):
    records = json.loads(cli("node", "list", "-a", "--json").out)
    observed = {record["pid"]: record for record in records if record.get("observed")}
    assert observed.keys() == {programs["source"].pid, programs["plain"].pid}
    source = observed[programs["source"].pid]
    assert [seen["topic"] for seen in source["publications"]] == ["EXAMPLE"]
    assert (source["listens"], observed[programs["plain"].pid]["listens"]) == (False, True)


def test_uri_prints_an_address_for_each_node(cli):
    rows = cli("node", "list", "-u").out.splitlines()
    assert len(rows) == 2
    assert all(re.fullmatch(r"udp://[\d.]+:\d+/", row) for row in rows)


def test_info_finds_a_program_by_its_pid_and_its_command(cli, programs):
    pid = programs["source"].pid
    for word in ("lcm-source", str(pid), f"{HOST}:{pid}"):
        result = cli("node", "info", word)
        assert result.code == 0
        assert "lcm-source -m EXAMPLE] (no node: seen on the bus only)\n" in result.out
        assert "Publications: \n * EXAMPLE [" in result.out
        assert f"\nHost: {HOST}\nPid: {pid}\n" in result.out
    (record,) = json.loads(cli("node", "info", "--json", "lcm-source").out)
    assert (record["observed"], record["pid"]) == (True, pid)


def test_info_shows_how_a_programs_listening_fares(cli, programs):
    text = cli("node", "info", str(programs["plain"].pid)).out
    assert re.search(r"^Buffer: \d+ kB of \d+ kB wait, \d+ datagrams dropped", text, re.MULTILINE)
    assert "Buffer" not in cli("node", "info", str(programs["source"].pid)).out


def test_info_json_has_process_counters_and_peers(cli, programs):
    (record,) = json.loads(cli("node", "info", "--json", "talker").out)
    chatter = next(end for end in record["publications"] if end["topic"] == "/chatter")
    assert chatter["messages"] > 0
    assert {"topic": "/chatter", "direction": "to", "node": "/r/listener"} in record["connections"]
    assert record["pid"] == programs["talker"].pid
    assert 1e6 < record["memory_bytes"] < 1e9
    assert record["up_time"] > 0


def test_ping_all_pings_every_node_once_and_sums_up(cli):
    result = cli("node", "ping", "-a")
    assert (result.code, result.err) == (0, "")
    head, rest = result.out.split("\n\n")
    assert head == "Will ping the following nodes: \n * /r/listener\n * /talker"
    assert (
        len(re.findall(r"^reply from (/r/listener|/talker) \(.*\)\ttime=", rest, re.MULTILINE)) == 2
    )
    assert "\n2 of 2 nodes answered\nping average: " in rest


def test_ping_sums_up_on_ctrl_c(start, lcmtools_path):
    ping = start(lcmtools_path, "node", "ping", "talker")
    ping.wait_for("reply")
    ping.wait_for("reply")
    ping.send_signal(signal.SIGINT)
    assert ping.wait() == 130
    assert ping.lines[-2].startswith("ping average: ")
    assert ping.lines[-1].startswith("shortest: ")


def test_machine_takes_localhost_for_this_computer(cli):
    assert cli("node", "machine", "localhost").out == "/r/listener\n/talker\n"


def test_ping_all_goes_on_after_a_node_that_does_not_answer(cli, programs):
    programs["listener"].send_signal(signal.SIGSTOP)
    try:
        result = cli("node", "ping", "-a", "--timeout", "300ms")
    finally:
        programs["listener"].send_signal(signal.SIGCONT)
    assert result.code == 4
    assert_says(result.err, "/r/listener", "not answer", "0.3 s")
    assert "reply from /talker" in result.out
    assert "1 of 2 nodes answered\n" in result.out
