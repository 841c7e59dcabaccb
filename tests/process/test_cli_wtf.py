"""wtf on a bus and on saved evidence; and node cleanup, which mends one of its findings."""

import json
import shlex
import signal
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from fixtures.wire import encode_event

from lcmtools.bus.url import parse_url
from lcmtools.doctor.evidence import Evidence, Listener, Oddity
from lcmtools.doctor.saved import save
from lcmtools.graph.model import Graph, NodeInfo
from lcmtools.labs.nodes.simple_controller import SimpleController
from lcmtools.wire.packet import Packet

# other tests have plain programs too
pytestmark = pytest.mark.usefixtures("on_bus", "quiet_network")


@pytest.fixture
def wtf(cli):
    """Exit code and output of a short wtf."""

    def run():
        # other tests' buses are on this computer too
        result = cli("wtf", "--wait", "0.2s", "--ignore", "other-buses")
        assert result.err == ""
        return result.code, result.out

    return run


def test_killed_node_is_stale_until_it_is_cleaned_up(node, wtf, cli):
    talker = node("talker")
    talker.send_signal(signal.SIGKILL)
    talker.wait()
    code, text = wtf()
    assert (code, f" * /talker (pid {talker.pid}): " in text) == (2, True)
    assert cli("node", "list").out == "/talker (stale: ended without saying goodbye)\n"
    assert "Stale: ended without saying goodbye\n" in cli("node", "info", "talker").out
    assert cli("node", "info", "-q", "talker").err == (
        "lcmtools node info: /talker is stale: ended without saying goodbye\n"
    )
    assert cli("list").out == ""

    assert cli("node", "cleanup").out == "/talker\n"
    assert cli("node", "list").out == ""
    result = cli("node", "cleanup")
    assert (result.code, result.out) == (0, "")
    assert result.err == "no node has ended without saying goodbye\n"


def test_killed_node_that_was_started_again_is_no_fault(node, wtf, cli):
    killed = node("talker")
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    again = node("talker")
    code, text = wtf()
    assert code == 0, text
    assert f"Pid: {again.pid}\n" in cli("node", "info", "talker").out
    assert cli("node", "ping", "-c", "1", "talker").code == 0


def test_stopped_node_is_stale_until_it_goes_on(node, wtf, cli):
    talker = node("talker")
    talker.send_signal(signal.SIGSTOP)
    assert wtf()[0] == 2
    assert cli("node", "list").out == "/talker (stale: runs but does not answer)\n"
    assert cli("node", "cleanup").out == ""
    ping = cli("node", "ping", "-c", "1", "--timeout", "300ms", "talker")
    assert ping.code == 4
    assert ping.err.startswith(
        f"lcmtools node ping: /talker did not answer within 0.3 s; its process is {talker.pid} on "
    )
    talker.send_signal(signal.SIGCONT)
    assert wtf()[0] == 0


CONTROLLER = (
    "Found 1 warning(s).\n"
    "Warnings are things that may be just fine, but are sometimes at fault\n"
    "\n"
    "WARNING The following node subscriptions are unconnected:\n"
    " * /simple_controller:\n"
    "   * /odometry\n"
    "   * /desired_velocity\n"
    "   -> start a publisher of /odometry and /desired_velocity; to see what is published:"
    " lcmtools list -v\n"
    "\n"
    "Found 1 note(s).\n"
    "Notes are seldom at fault\n"
    "\n"
    "NOTE The following node publications have no announced subscriber:\n"
    " * /simple_controller:\n"
    "   * /controlled_velocity\n"
)


def test_evidence_of_a_live_bus_is_judged_as_roswtf_lists_it_and_again_without_the_bus(
    start_node, cli, tmp_path
):
    start_node(SimpleController)
    options = ("--wait", "0.2s", "--ignore", "other-buses")
    result = cli("wtf", "--save", str(tmp_path / "seen"), *options)
    assert (result.code, result.out) == (1, CONTROLLER)
    assert result.err == f"the evidence is in {tmp_path / 'seen'}\n"
    no_bus = {"LCM_DEFAULT_URL": "udpm://no bus"}
    again = cli("wtf", "--from", str(tmp_path / "seen"), *options, env=no_bus)
    assert (again.code, again.out, again.err) == (1, CONTROLLER, "")


@pytest.fixture
def judge(cli, tmp_path):
    """``judge(evidence, "--json")``: what wtf makes of saved evidence, without a bus."""

    def run(evidence, *options, command="wtf"):
        save(evidence, tmp_path / "evidence.json")
        no_bus = {"LCM_DEFAULT_URL": "udpm://no bus"}
        return cli(command, "--from", str(tmp_path / "evidence.json"), *options, env=no_bus)

    return run


EMPTY = Evidence("udpm://239.255.76.67:7667?ttl=0", listened=0.2)
INFINITE = Oddity("not-finite", "/cmd", "driver.py (pid 7)", "linear.x is inf", 18)
NODES = Graph((NodeInfo("/n", "n", "h", 1),))


def test_an_empty_bus_is_a_warning_under_both_names(judge):
    result = judge(EMPTY)
    assert result.code == 1
    assert judge(EMPTY, command="doctor") == result


def test_json_has_each_finding_in_words_and_as_data(judge):
    stopped = Listener("sink (pid 7)", 7, 0, state="T")
    result = judge(replace(EMPTY, graph=NODES, listeners=(stopped,)), "--json")
    assert result.code == 1
    finding, unchecked = json.loads(result.out)
    assert (finding["rule"], finding["severity"]) == ("stuck-listeners", "warning")
    (action,) = finding["actions"]
    assert "sink (pid 7)" in finding["items"][0]
    assert finding["remedies"] == [action["text"]]
    assert unchecked.keys() == finding.keys()
    assert (unchecked["rule"], unchecked["severity"]) == ("small-buffer", "unchecked")
    assert unchecked["text"].startswith("this system does not report the size")


NEARLY_LCM = """
import socket, struct, sys, time
datagrams = [
    b"LC",
    struct.pack(">4sIIIHH", b"LC03", 1, 3000, 0, 9, 3) + bytes(100),
    struct.pack(">4sIIIHH", b"LC03", 1, 3000, 2950, 1, 3) + bytes(100),
    b"LC02" + bytes(4) + b"C" * 100 + bytes(20),
]
senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in datagrams]
while True:
    for sender, datagram in zip(senders, datagrams):
        sender.sendto(datagram, (sys.argv[1], int(sys.argv[2])))
    print("sends", flush=True)
    time.sleep(0.02)
"""


def test_datagrams_that_are_nearly_lcms_are_shown_with_their_process_and_the_reason(
    cli, bus_url, start_python
):
    url = parse_url(bus_url)
    program = start_python(NEARLY_LCM, url.host, str(url.port))
    program.wait_for("sends")
    result = cli("wtf", "--json", "--wait", "0.3s", "--rule", "malformed")
    (finding,) = json.loads(result.out)
    items = finding["items"]
    assert len({item.rpartition("): ")[2] for item in items}) == 4
    assert all(f"(pid {program.pid}): " in item for item in items)


def test_only_one_rule_or_not_another(judge):
    evidence = replace(EMPTY, graph=NODES, oddities=(INFINITE,))
    result = judge(evidence, "--rule", "not-finite", "--rule", "loss")
    assert (result.code, result.out.count("WARNING")) == (1, 1)
    assert judge(evidence, "--ignore", "not-finite").out == "No errors or warnings\n"


def test_evidence_that_is_none_costs_one_line(cli, tmp_path):
    file = tmp_path / "some.json"
    file.write_text("{}")
    result = cli("wtf", "--from", str(file))
    assert (result.code, result.out) == (64, "")
    assert result.err == (
        f"lcmtools wtf: {file} does not contain evidence that wtf can judge: it is other JSON\n"
    )
    result = cli("wtf", "--from", str(tmp_path / "none"))
    assert (result.code, result.out) == (64, "")
    assert (
        result.err == f"lcmtools wtf: cannot read {tmp_path / 'none'}: No such file or directory\n"
    )
    save(EMPTY, file)
    result = cli("wtf", "--from", str(file), "--save", str(tmp_path / "no/folder"))
    assert (result.code, result.out) == (64, "")
    assert result.err.startswith(f"lcmtools wtf: cannot write {tmp_path / 'no/folder'}: ")
    result = cli("wtf", "--watch", "--from", str(file))
    assert (result.code, result.out) == (64, "")


def test_rules_are_listed_and_explained(cli):
    listed = cli("wtf", "--list").out.splitlines()
    rules = json.loads(cli("wtf", "--list", "--json").out)
    assert [line.split()[0] for line in listed] == [rule["rule"] for rule in rules]
    for rule in ("loss", "kernel-drops"):
        result = cli("wtf", "--explain", rule)
        assert result.code == 0
        assert result.out.startswith(f"{rule} (warning)\n\n")
        assert "\n\n   -> " in result.out


def test_json_has_a_finding_where_the_environment_names_no_bus(cli, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", "udpm://239.255.76.67")
    result = cli("wtf", "--json")
    assert (result.code, result.err) == (2, "")
    (finding,) = json.loads(result.out)
    assert finding["rule"] == "bus"
    assert "the port is missing" in finding["text"]
    assert finding["remedies"] == ["export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'"]
    assert finding["actions"][0]["commands"] == finding["remedies"]
    assert cli("wtf", "--json", "--lcm-url", "udpm://x").out == ""


def test_options_of_a_url_that_lcm_reads_otherwise_are_named(cli, bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url.replace("ttl=0", "tll=1&ttl=256"))
    text = cli("wtf", "--wait", "0.1s", "--rule", "environment").out
    assert "tll=1 has no effect; did you mean ttl?\n" in text
    assert "ttl=256 is sent as 0; the maximum is 255\n" in text


def test_what_another_bus_has_is_said_here_where_nobody_else_is_asked(node, cli, free_port, start):
    """--ignore takes one rule's findings away, and none of another's."""
    node("listener")
    away = f"udpm://239.255.76.67:{free_port()}?ttl=0"
    talker = "import lcm, time\nbus = lcm.LCM()\nwhile True:\n"
    talker += " bus.publish('/chatter', bytes(12)); print('sent', flush=True); time.sleep(0.02)\n"
    start(sys.executable, "-c", talker, LCM_DEFAULT_URL=away).wait_for("sent")
    options = ("--json", "--wait", "0.3s", "--ignore", "other-buses")
    rules = [finding["rule"] for finding in json.loads(cli("wtf", *options).out)]
    assert rules == ["unconnected-subscriptions"]


def test_the_damaged_bytes_of_a_log_are_left_out(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    one, two, three, cut = (encode_event(n, Packet("A", bytes(40), n)) for n in range(4))
    Path("a ride.lcm").write_bytes(one + b"x" + two + three + cut[:-5])
    result = cli("wtf", "--bag", "a ride.lcm", "--rule", "damaged-log", "--json")
    assert result.code == 1
    (found,) = json.loads(result.out)
    damaged = 1 + len(cut) - 5
    assert found["text"] == f"{damaged} bytes of a ride.lcm do not belong to any message"
    (command,) = found["actions"][0]["commands"]
    assert cli(*shlex.split(command)[1:]).code == 1  # some bytes are left out
    assert cli("wtf", "--bag", "fixed.lcmlog", "--rule", "damaged-log").code == 0
