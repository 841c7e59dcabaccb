"""spy --once: the table of a bus with nodes, with plain programs, with loss, of a log, of tcpq."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from fixtures.says import assert_says

# Prints a line when a message has been sent, so that tests wait for it and not for time.
PLAIN = """
import time
import lcm
from lcmtools.types.geometry_msgs import Point

bus = lcm.LCM()
point = Point().encode()
while True:
    bus.publish("POSE", point)
    bus.publish("NOISE", bytes(range(200)))
    print("sent", flush=True)
    time.sleep(0.05)
"""

# Every fourth message is numbered and never sent.
LOSSY = """
import socket
import time
import sys
from lcmtools.wire.datagram import short_message

port = int(sys.argv[1])
out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
number = 0
while True:
    number += 1
    if number % 4:
        out.sendto(short_message(number, "LOSSY", bytes(8)), ("239.255.76.67", port))
    print("sent", flush=True)
    time.sleep(0.01)
"""

# A node that publishes only what somebody listens to, or never.
SHY = """
import sys
import lcmtools
from lcmtools import Node
from lcmtools.types.std_msgs import String

lcmtools.init()
node = Node("shy")
publisher = node.create_publisher(String, "/shy", 10)

def tick():
    if sys.argv[1] == "heard" and publisher.subscriber_count():
        publisher.publish(String())

node.create_timer(0.02, tick)
print("ready", flush=True)
lcmtools.spin(node)
"""


@pytest.fixture
def rows(cli, bus_url):
    """``rows("/a", wait="2s")``: the records of spy --json, by channel."""

    def run(*arguments, url=bus_url):
        done = cli("spy", "--json", *arguments, env={"LCM_DEFAULT_URL": url})
        assert done.code == 0, done.err
        return {record["channel"]: record for record in json.loads(done.out)}

    return run


def test_nodes_are_named_with_their_types_and_listeners(
    start, start_python, lcmtools_path, bus_url, rows
):
    bus = {"LCM_DEFAULT_URL": bus_url}
    start(lcmtools_path, "run", "talker", **bus)
    start(lcmtools_path, "run", "listener", **bus).wait_for("heard")
    start_python(SHY, "never", **bus).wait_for("ready")
    found = rows("--wait", "2500ms")
    chatter = found["/chatter"]
    assert (chatter["types"], chatter["announced"]) == (["std_msgs/String"], True)
    assert (chatter["senders"], chatter["listeners"]) == (["/talker"], ["/listener"])
    assert chatter["messages"] >= 2
    assert (chatter["senders_lost"], chatter["senders_loss"]) == (0, 0.0)
    silent = found["/shy"]
    assert (silent["messages"], silent["rate"], silent["senders"]) == (0, None, ["/shy"])


def test_plain_programs_are_named_by_process_and_types_by_fingerprint(
    start, start_python, lcm_program, cli, bus_url, rows
):
    plain = start_python(PLAIN, LCM_DEFAULT_URL=bus_url)
    plain.wait_for("sent")
    found = rows("--wait", "2500ms")
    pose = found["POSE"]
    script = re.escape(Path(plain_script(plain.pid)).name)
    assert re.fullmatch(rf"{script} \(pid {plain.pid}\)", pose["senders"][0])
    assert 0 < pose["rate"] < 21
    assert pose["jitter"] >= 0
    assert pose["bandwidth"] == pytest.approx(pose["rate"] * 32)
    assert pose["announced"] is False
    assert "geometry_msgs/Point" in pose["types"]
    assert found["NOISE"]["types"] == []

    sink = start(lcm_program("lcm-sink"), LCM_DEFAULT_URL=bus_url)
    sink.wait_for("received")
    done = cli("spy", "--once", "POSE", "NOISE", env={"LCM_DEFAULT_URL": bus_url})
    heading, noise, pose_line = done.out.splitlines()
    assert heading.split()[:4] == ["CHANNEL", "TYPE", "MESSAGES", "HZ"]
    assert noise.split()[:2] == ["NOISE", "?"]
    assert "geometry_msgs/Vector3 +1" in pose_line
    assert_says(done.err, f"lcm-sink (pid {sink.pid}): ", "receives", "not a node")


def plain_script(pid):
    """The script that a Python process runs."""
    return Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")[1].decode()


def test_lost_messages_are_the_senders(start_python, cli, rows, bus_url, private_network):
    del private_network
    port = bus_url.rpartition(":")[2].partition("?")[0]
    start_python(LOSSY, port).wait_for("sent")
    lossy = rows()["LOSSY"]
    assert lossy["senders_loss"] == pytest.approx(0.25, abs=0.05)
    assert lossy["senders_lost"] > 0
    done = cli("spy", "--once", env={"LCM_DEFAULT_URL": bus_url})
    assert re.search(r"LOSSY .* 2\d% ", done.out)
    assert "LCM numbers messages per sender" in done.err


def test_tcpq_tells_neither_sender_nor_loss(tcpq_server, start_python, rows):
    start_python(PLAIN, LCM_DEFAULT_URL=tcpq_server.url).wait_for("sent")
    pose = rows(url=tcpq_server.url)["POSE"]
    assert pose["messages"] > 1
    assert pose["rate"] > 0
    assert (pose["senders"], pose["senders_lost"]) == (["unknown sender"], None)


def test_a_topic_that_is_published_only_when_heard_begins_to_come(start_python, rows, bus_url):
    start_python(SHY, "heard", LCM_DEFAULT_URL=bus_url).wait_for("ready")
    assert rows()["/shy"]["messages"] > 2


def test_the_table_needs_no_textual(bus_url):
    script = (
        "import sys\n"
        "sys.modules['textual'] = sys.modules['rich'] = None\n"
        "from lcmtools.cli.main import main\n"
        "sys.exit(main(['spy', '--once', '--wait', '1ms']))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], env={"LCM_DEFAULT_URL": bus_url}, check=False
    )
    assert done.returncode == 0
