"""Programs that have never heard of lcmtools, on another computer; and large messages."""

import json

import pytest
from fixtures.says import assert_says

_NODE = """
import sys, time, lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
publisher = lcmtools.Node("large").create_publisher(String, "/large")
message = String()
message.data = "x" * int(sys.argv[1])
while True:
    publisher.publish(message)
    time.sleep(0.2)
"""
_SUBSCRIBER = """
import lcm
bus = lcm.LCM()
bus.subscribe("LARGE", lambda _, data: print("got", len(data), flush=True))
print("listens", flush=True)
while True:
    bus.handle()
"""
# PORT...: sends plain messages from these ports
_FROM_PORTS = """
import socket, sys, time
from lcmtools.wire.datagram import short_message
senders = {port: socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for port in sys.argv[1:]}
for port, sender in senders.items():
    sender.bind(("", int(port)))
print("sends", flush=True)
while True:
    for port, sender in senders.items():
        sender.sendto(short_message(0, f"FROM_{port}", bytes(8)), ("239.255.76.67", 7667))
    time.sleep(0.05)
"""


def test_a_publisher_elsewhere_is_known_by_its_address(pair, plain):
    ada, bob = pair
    ada.python(plain, "PLAIN", "8", "0.02").wait_for("sends")
    assert bob.out("list", "--host") == "Host [10.76.0.1]:\n  PLAIN\n"
    assert " * a program on 10.76.0.1, port " in bob.out("info", "PLAIN")
    (program,) = json.loads(bob.out("node", "list", "-a", "--json"))
    assert program["address"] == "10.76.0.1"
    assert program["pid"] is program["command"] is program["host"] is None
    assert [seen["topic"] for seen in program["publications"]] == ["PLAIN"]
    where = f"10.76.0.1:{program['ports'][0]}"
    assert "Host: 10.76.0.1\n" in bob.out("node", "info", where)
    refused = bob.lcmtools("node", "kill", where)
    assert refused.returncode == 1
    assert_says(refused.stderr, where, "not a node", "shut down")
    (local,) = json.loads(ada.out("node", "list", "-a", "--json"))
    assert (local["host"], local["ports"]) == ("ada", program["ports"])
    assert local["pid"]


def test_a_publisher_elsewhere_that_is_slow_is_waited_for(pair, plain):
    ada, bob = pair
    ada.python(plain, "SLOW", "8", "0.8").wait_for("sends")
    for _ in range(2):
        assert bob.out("list") == "SLOW\n"
        assert "on 10.76.0.1, port " in bob.out("info", "SLOW")
        (program,) = json.loads(bob.out("node", "list", "-a", "--json"))
        assert program["address"] == "10.76.0.1"


def test_a_relay_hears_programs_elsewhere_that_have_its_ports(pair, lcmtools_path):
    ada, bob = pair
    far = "udpm://239.255.76.67:7668?ttl=0"
    ada.ports(45_000, 45_003)
    relay = ada.start(lcmtools_path, "relay", ada.environment["LCM_DEFAULT_URL"], far)
    relay.wait_for("carries")
    ada.ports(46_000, 60_000)
    bob.python(_FROM_PORTS, "45000", "45001", "45002", "45003").wait_for("sends")
    for port in range(45_000, 45_004):
        assert ada.out("echo", f"FROM_{port}", "-1", "--raw", LCM_DEFAULT_URL=far)


def test_clients_of_a_server_are_known_by_their_computers(pair, plain, lcmtools_path):
    ada, bob = pair
    ada.start(lcmtools_path, "relay", "--serve", "tcpq://0.0.0.0:7700").wait_for("serves")
    url = f"tcpq://{ada.address}:7700"
    for host, channel in ((ada, "OF_ADA"), (bob, "OF_BOB")):
        host.python(plain, channel, "8", "3", LCM_DEFAULT_URL=url).wait_for("sends")
    listed = bob.out("list", "--host", LCM_DEFAULT_URL=url)
    assert listed == "Host [10.76.0.2]:\n  OF_BOB\nHost [ada]:\n  OF_ADA\n"
    bob.start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=url).wait_for("hello")
    programs = json.loads(bob.out("node", "list", "-a", "--json", LCM_DEFAULT_URL=url))
    found = {p["host"]: p["publications"][0]["topic"] for p in programs if p["node"] is None}
    assert found == {"ada": "OF_ADA", "bob": "OF_BOB"}  # as the node there is named


def test_the_same_pid_and_port_on_both_are_not_taken_for_one(pair, plain):
    ada, bob = pair
    for host, channel in ((ada, "OF_ADA"), (bob, "OF_BOB")):
        host.ports(45_000, 45_000)
        host.next_pid(700)
        host.python(plain, channel, "8", "0.02").wait_for("sends")
        host.ports(32_768, 60_999)
    for host, own, other in ((ada, "OF_ADA", "OF_BOB"), (bob, "OF_BOB", "OF_ADA")):
        programs = json.loads(host.out("node", "list", "-a", "--json"))
        found = {p["publications"][0]["topic"]: (p["pid"], p["ports"]) for p in programs}
        assert found == {own: (700, [45_000]), other: (None, [45_000])}
        assert "(pid " not in host.out("info", other)


def test_a_node_elsewhere_hides_no_program_with_its_pid(pair, plain, lcmtools_path):
    ada, bob = pair
    ada.next_pid(700)
    ada.start(lcmtools_path, "run", "talker").wait_for("hello")
    bob.next_pid(700)
    # as slow as one that ``list`` waits for, because it is there
    bob.python(plain, "SLOW", "8", "1").wait_for("sends")
    assert bob.out("list").split() == ["/chatter", "/rosout", "SLOW"]
    told = json.loads(bob.out("node", "info", "talker", "--json"))[0]
    assert (told["pid"], told["host"], told["memory_bytes"]) == (700, "ada", None)
    programs = json.loads(bob.out("node", "list", "-a", "--json"))
    assert [one["pid"] for one in programs] == [700, 700]
    assert [one["node"] for one in programs] == ["/talker", None]


@pytest.mark.parametrize("size", [200_000, 1_000_000])
def test_large_messages_of_nodes_cross_in_both_directions(pair, size):
    for sender, receiver in (pair, reversed(pair)):
        node = sender.python(_NODE, str(size))
        shown = receiver.out("echo", "/large", "-n", "2", "--raw", "--json")
        sizes = [json.loads(line)["bytes"] for line in shown.splitlines()]
        assert sizes == [size + 13] * 2  # fingerprint, length and the final zero
        node.end()


@pytest.mark.parametrize(
    ("size", "url"),
    [(150_000, "?ttl=1"), (1_000_000, "?ttl=1&recv_buf_size=4000000")],
)
def test_large_messages_of_plain_programs_cross(pair, plain, size, url, wait_until):
    ada, bob = pair
    listener = bob.python(_SUBSCRIBER, LCM_DEFAULT_URL=f"udpm://239.255.76.67:7667{url}")
    listener.wait_for("listens")
    ada.python(plain, "LARGE", str(size), "0.1")
    wait_until(lambda: listener.output.count(f"got {size + 8}") >= 3)
    (record,) = json.loads(bob.out("info", "LARGE", "--json"))
    (seen,) = record["other_publishers"]
    assert seen["bytes"] == seen["messages"] * (size + 8)


def test_a_log_of_the_other_computer_is_complete(pair, plain, lcm_program, tmp_path, wait_until):
    ada, bob = pair
    log = tmp_path / "log"
    logger = bob.start(lcm_program("lcm-logger"), "--flush-interval=10", str(log))
    ada.python(plain, "LARGE", "100000", "0.02")
    wait_until(lambda: log.exists() and log.stat().st_size > 500_000)
    logger.end()
    assert bob.out("list", "--lcm-url", f"file://{log}") == "LARGE\n"
