"""lcmtools graph on a bus with nodes and with plain LCM programs."""

import json
import re
import signal
import socket
import sys
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.wire.datagram import short_message

_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("POSE", lambda *_: None)
print("ready", flush=True)
while True:
    bus.handle()
"""
_SERVER = """
import lcmtools
from lcmtools.types.std_srvs import Trigger
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("server")
node.create_service(Trigger, "reset", lambda request, response: response)
node.create_subscription(String, "orders", lambda message: None, 10)
print("ready", flush=True)
lcmtools.spin(node)
"""


@pytest.fixture(scope="module")
def programs(module_start, lcmtools_path, tmp_path_factory):
    """A talker, a listener in a namespace, a server, lcm-source, and a script that only listens."""
    import sysconfig

    source = str(Path(sysconfig.get_path("purelib")) / "bin" / "lcm-source")
    server = tmp_path_factory.mktemp("server") / "server.py"
    server.write_text(_SERVER)
    started = {
        "plain": module_start(sys.executable, "-c", _LISTENER),
        "server": module_start(sys.executable, str(server)),
        "source": module_start(source, "-m", "EXAMPLE"),
        "listener": module_start(lcmtools_path, "run", "listener", "__ns:=/r", "chatter:=/chatter"),
        "talker": module_start(lcmtools_path, "run", "talker"),
    }
    started["plain"].wait_for("ready")
    started["server"].wait_for("ready")
    started["listener"].wait_for("I heard: [hello world")
    return started


@pytest.fixture
def on_bus(use_module_bus, programs):
    """The programs, with the commands looking at their bus."""
    del use_module_bus
    return programs


def names_of(document):
    """The vertex of each id in JSON."""
    vertices = [*document["nodes"], *document["topics"], *document["services"]]
    return {
        one["id"]: one.get("node") or one.get("topic") or one.get("service") or str(one["pid"])
        for one in vertices
    }


def edges_of(document):
    """The edges in JSON, by names."""
    names = names_of(document)
    return {(names[edge["from"]], edge["kind"], names[edge["to"]]) for edge in document["edges"]}


def test_text_shows_who_feeds_whom(cli, on_bus):
    result = cli("graph", env={"LC_ALL": "C.UTF-8"})
    source, plain = on_bus["source"].pid, on_bus["plain"].pid
    assert result.code == 0
    assert "/talker\n└─ /chatter [std_msgs/String]\n   └→ /r/listener\n" in result.out
    assert f"lcm-source -m EXAMPLE (no node, pid {source})\n└─ EXAMPLE [" in result.out
    assert re.search(
        rf"^python.* \(no node, pid {plain}, receives unknown channels\)$",
        result.out,
        re.MULTILINE,
    )
    parts = ("1 unused topic", "--leaf-topics", "/rosout", "--all")
    assert_line(result.err, "not drawn: ", *parts)


def test_in_the_c_locale_text_is_ascii(cli, on_bus):
    del on_bus
    text = cli("graph", "/talker", env={"LC_ALL": "C"}).out
    assert text == "/talker\n`- /chatter [std_msgs/String]\n   `> /r/listener\n"


def test_json_has_nodes_programs_and_edges(cli, on_bus):
    document = json.loads(cli("graph", "--json").out)
    source, plain = str(on_bus["source"].pid), str(on_bus["plain"].pid)
    assert edges_of(document) == {
        ("/talker", "publishes", "/chatter"),
        ("/chatter", "subscribes", "/r/listener"),
        (source, "publishes", "EXAMPLE"),
    }
    nodes = {node["pid"]: node for node in document["nodes"]}
    assert nodes[on_bus["talker"].pid]["host"] == socket.gethostname()
    assert (nodes[int(plain)]["observed"], nodes[int(plain)]["listens"]) == (True, True)


def test_leaf_topics_and_services_are_shown_where_asked_for(cli, on_bus):
    del on_bus
    document = json.loads(cli("graph", "--json", "--leaf-topics", "--services", "/server").out)
    assert edges_of(document) == {
        ("/orders", "subscribes", "/server"),
        ("/reset", "serves", "/server"),
    }


def test_all_leaves_nothing_out(cli, on_bus):
    del on_bus
    result = cli("graph", "-a")
    assert "/rosout" in result.out
    assert "/orders" in result.out
    assert result.err == ""


def test_a_looking_command_is_shown_by_tools(cli, on_bus, module_start, lcmtools_path):
    del on_bus
    echo = module_start(lcmtools_path, "echo", "/chatter")
    echo.wait_for("data:")
    try:
        assert "_lcmtools_echo" not in cli("graph").out
        assert_says(cli("graph").err, "1 command", "--tools")
        assert f"/_lcmtools_echo_{echo.pid} (observes)" in cli("graph", "--tools").out
    finally:
        echo.end()


def test_nodes_only_connects_nodes(cli, on_bus):
    del on_bus
    document = json.loads(cli("graph", "--nodes-only", "--json", "/r").out)
    assert edges_of(document) == {("/talker", "feeds", "/r/listener")}
    assert document["edges"][0]["topics"] == ["/chatter"]


def test_rates_are_measured(cli, on_bus):
    del on_bus
    document = json.loads(cli("graph", "--hz", "--json", "EXAMPLE").out)
    assert document["topics"][0]["rate"] > 0
    assert document["edges"][0]["rate"] == document["topics"][0]["rate"]


def test_a_file_has_the_format_that_its_name_tells(cli, on_bus, tmp_path):
    del on_bus
    file = tmp_path / "graph.gv"
    result = cli("graph", "--group", "-o", str(file))
    said = f"wrote {file}: 3 nodes, 2 other programs, 2 topics\n"
    assert (result.code, result.out) == (0, "")
    assert result.err.startswith(said)
    labels = re.findall(r'label="([^"\\]*)', file.read_text())
    assert {"/talker", "/chatter", "/r/listener", "EXAMPLE", "/r"} <= set(labels)
    again = cli("graph", "-o", str(file))
    assert again.code == 2
    assert "--force overwrites it" in again.err


def test_dot_and_mermaid_go_to_standard_output(cli, on_bus):
    del on_bus
    dot = cli("graph", "--format", "dot", "/talker")
    assert dot.out.startswith("digraph lcmtools {\n")
    assert re.search(r"n\d+ -> t\d+ \[", dot.out)
    mermaid = cli("graph", "--format", "mermaid", "/talker").out
    assert re.search(r"n\d+ --> t\d+\n", mermaid)


def test_what_is_nowhere_is_said(cli, on_bus, bus_url):
    del on_bus
    result = cli("graph", "/nowhere")
    assert (result.code, result.out) == (0, "")
    assert_says(result.err, "nothing of /nowhere", "udpm://")
    empty = cli("graph", "--format", "dot", env={"LCM_DEFAULT_URL": bus_url})
    assert empty.out.startswith("digraph lcmtools {")
    assert empty.err == f"nothing to draw on {bus_url}\n"


def test_two_of_the_same_name_and_a_stale_one(cli, start, lcmtools_path, bus_url):
    one, other = (start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url) for _ in range(2))
    for talker in (one, other):
        talker.wait_for("hello world")
    other.send_signal(signal.SIGKILL)
    other.wait()
    text = cli("graph", env={"LCM_DEFAULT_URL": bus_url, "LC_ALL": "C"}).out
    assert f"/talker (pid {one.pid})\n" in text
    assert f"/talker (pid {other.pid}) (stale: " in text


@pytest.mark.usefixtures("private_network")
def test_channels_of_any_bytes_are_drawn(cli, start, tmp_path):
    """In a network of its own: such channels may end what hears them."""
    names = ['a"b\\', "<&>#35;\n", "\udcff\x1b[2J", "日本|`x`"]
    url = "udpm://239.255.76.67:7667?ttl=0"
    datagrams = [short_message(number, name, b"x" * 8) for number, name in enumerate(names)]
    script = tmp_path / "shout.py"
    script.write_text(
        "import socket, time\n"
        "out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
        f"while True:\n    for datagram in {datagrams!r}:\n"
        "        out.sendto(datagram, ('239.255.76.67', 7667))\n"
        "    print('sent', flush=True)\n    time.sleep(0.05)\n"
    )
    start(sys.executable, str(script)).wait_for("sent")
    wait = ("--wait", "0.5s")  # ten times the period
    document = json.loads(cli("graph", "--json", *wait, env={"LCM_DEFAULT_URL": url}).out)
    assert sorted(topic["topic"] for topic in document["topics"]) == sorted(names)
    for form in ("text", "dot", "mermaid"):
        result = cli(
            "graph", "--format", form, *wait, env={"LCM_DEFAULT_URL": url, "LC_ALL": "C.UTF-8"}
        )
        assert result.code == 0
        assert "日本" in result.out
        assert not re.search(r"[\x00-\x09\x0b-\x1f]", result.out)


def test_a_log_is_drawn_too(cli, tmp_path):
    import struct

    def event(number, channel, data):
        head = struct.pack(">IQQII", 0xEDA1DA01, number, number * 100_000, len(channel), len(data))
        return head + channel + data

    log = tmp_path / "a.log"
    log.write_bytes(b"".join(event(number, b"POSE", bytes(8)) for number in range(3)))
    result = cli("graph", "--hz", f"--lcm-url=file://{log}", env={"LC_ALL": "C"})
    assert result.out == "a program (no node)\n`- POSE [unknown type] 10.0 Hz\n"


def test_where_the_bus_tells_no_senders_programs_are_one(cli, start, lcmtools_path, tcpq_server):
    url = tcpq_server.url
    start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=url).wait_for("hello world")
    plain = (
        "import lcm, time\nbus = lcm.LCM()\n"
        "while True:\n    bus.publish('POSE', bytes(8))\n    print('sent', flush=True)\n"
        "    time.sleep(0.05)\n"
    )
    start(sys.executable, "-c", plain, LCM_DEFAULT_URL=url).wait_for("sent")
    text = cli("graph", "--wait", "1", env={"LCM_DEFAULT_URL": url, "LC_ALL": "C"}).out
    assert "/talker\n`- /chatter [std_msgs/String]\n" in text
    assert "a program (no node)\n`- POSE [unknown type]\n" in text
