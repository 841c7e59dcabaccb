"""Commands that look at a bus, on a log with an index."""

import json
import shlex
from pathlib import Path

import pytest
from fixtures.says import assert_says
from fixtures.wire import encode_event

from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import message_class
from lcmtools.messages.type_versions import fingerprint_of
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.packages import provide_user_types
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.log_index import LostMessages, RecordedNode
from lcmtools.wire.packet import Packet, Sender

_SECOND = 1_000_000_000
_START = 1_795_384_180 * _SECOND


@pytest.fixture
def look(tmp_path, capsys):
    """Runs a command on a log of a node, /driver, and a program, which sends what is no number."""
    path = tmp_path / "ride.lcmlog"
    with LogWriter(path) as log:
        driver = log.sender_number(Sender("127.0.0.1", 4001), "/driver")
        program = log.sender_number(Sender("127.0.0.1", 4002), "probe.py (pid 7)")
        ends = (Endpoint("/speed", Role.PUBLISHER, ("std_msgs/Float64",)),)
        node = NodeInfo("/driver", "id", "ada", 1, command="driver --fast", endpoints=ends)
        log.add_node(RecordedNode(_START, driver, encode_announcement(Announcement(node))))
        message = Float64()
        for tenth in range(100):
            time = _START + tenth * _SECOND // 10
            message.data = float(tenth)
            log.add(Packet("/speed", encode(message), time), driver)
            message.data = float("nan")
            log.add(Packet("PROBE", encode(message), time), program)
        log.add_lost(LostMessages(_START, {driver: (5, 105)}))

    def run(*words):
        code = main([*words, "--bag", str(path)])
        return (code, *capsys.readouterr())

    return run


@pytest.mark.parametrize(
    ("words", "out"),
    [
        ("list", "/speed\nPROBE\n"),
        ("list --hz /speed", "/speed  10.00 Hz\n"),
        ("type /speed", "std_msgs/Float64\n"),
        ("find Float64", "/speed\nPROBE\n"),
        ("node list", "/driver\n"),
        ("echo /speed/data -n 2", "0.0\n---\n1.0\n---\n"),
        ("echo /speed --filter 'm.data == 7'", "data: 7.0\n---\n"),
    ],
)
def test_a_log_answers_as_a_bus_does(words, out, look):
    assert look(*shlex.split(words)) == (0, out, "")


def test_info_has_the_recorded_senders(look):
    _, out, _ = look("info", "/speed", "PROBE", "-v")
    assert " * /driver (ada, pid 1)\n" in out
    assert_says(out, " * probe.py (pid 7)", "recorded", "\n", "messages: 100")
    assert_says(out, "did not arrive", "5 of 105 (4.8 %)", "all its topics")


def test_spy_and_graph_have_the_recorded_senders(look):
    _, out, _ = look("spy", "--json")
    rows = {row["channel"]: row for row in json.loads(out)}
    assert (rows["/speed"]["senders"], rows["PROBE"]["senders"]) == (
        ["/driver"],
        ["probe.py (pid 7)"],
    )
    assert rows["/speed"]["senders_lost"] == 5
    _, out, _ = look("graph", "--leaf-topics")
    assert "/driver" in out
    assert "probe.py (pid 7)" in out


def test_node_info_asks_nobody(look):
    code, out, error = look("node", "info", "/driver")
    assert (code, error) == (0, "")
    assert "Command: driver --fast\n" in out
    assert "Parameters" not in out


@pytest.mark.parametrize("words", ["node ping /driver", "param list", "node kill /driver"])
def test_what_only_a_node_could_answer_is_refused(words, look):
    code, out, error = look(*words.split())
    assert (code, out) == (2, "")
    assert_says(error, "a log", "; leave out -b")


def test_wtf_judges_the_messages_of_a_log_alone(look):
    code, out, error = look("wtf", "--json")
    assert code == 1
    found = {one["rule"]: one for one in json.loads(out)}
    assert set(found) == {"loss", "not-finite"}
    assert "'PROBE' from probe.py (pid 7)" in json.dumps(found["not-finite"])
    assert "5 of 105" in json.dumps(found["loss"])
    assert_says(error, "log", "only messages")
    code, _, error = look("wtf", "--rule", "link")
    assert code == 64
    assert_says(error, "lcmtools wtf: ", "log", "link", "; leave out --bag\n")


def test_a_log_is_read_in_place_of_a_bus(look):
    code, _, error = look("list", "--domain", "3")
    assert code == 2
    assert_says(error, "lcmtools list: -b", "log", "; leave out --lcm-url and --domain\n")
    assert_says(look("spy")[2], "lcmtools spy: ", "live view", "; --once")


def test_a_thousand_channels_are_not_each_a_reason_to_look_at_all(tmp_path, monkeypatch):
    looks, graph = [], BusMonitor.graph
    monkeypatch.setattr(BusMonitor, "graph", lambda self: looks.append(1) or graph(self))
    path, message = tmp_path / "a.log", encode(Float64())
    packets = (Packet(f"/{number // 100}", message, number) for number in range(30_000))
    path.write_bytes(b"".join(encode_event(n, one) for n, one in enumerate(packets)))
    assert main(["echo", "-b", str(path), "**", "--raw"]) == 0
    assert len(looks) < 100


@pytest.mark.parametrize(
    "command",
    [
        "echo POSE",
        "echo POSE --json",
        "echo POSE/x",
        "info POSE",
        "type POSE",
        "hz POSE --filter m.x>0",
        "delay POSE",
        "plot POSE/x -o plot.svg",
        "wtf",
        "bag export {} out.jsonl",
        "bag export {} out.mcap",
    ],
)
def test_the_known_type_that_is_like_an_unknown_one_is_named(
    command, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "types" / "own_msgs"
    folder.mkdir(parents=True)
    struct = "package own_msgs; struct Pose2 { double x; double heading_q; int32_t mode; }"
    (folder / "Pose2.lcm").write_text(struct)
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(folder.parent))
    provide_user_types()
    number = fingerprint_of(fields(message_class("own_msgs/Pose2"))[:2])
    packet = Packet("POSE", number.to_bytes(8, "big") + bytes(16), _START)
    Path("old.lcmlog").write_bytes(encode_event(0, packet))
    words = command.format("old.lcmlog").split()
    main(words if words[0] == "bag" else [*words, "-b", "old.lcmlog"])
    assert "like own_msgs/Pose2, but without the field mode" in "".join(capsys.readouterr())
