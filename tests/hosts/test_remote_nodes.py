"""Commands on nodes of another computer, with ttl=1."""

import json
import signal

import pytest

_SERVER = """
import time
import lcmtools
from lcmtools.types.std_srvs import SetBool
from lcmtools.types.nav_msgs import Odometry

def switch(request, response):
    response.success, response.message = True, "switched"
    return response

lcmtools.init()
node = lcmtools.Node("server")
node.declare_parameter("gain", 1.5)
node.create_service(SetBool, "/switch", switch)
publisher = node.create_publisher(Odometry, "/odom")

def send():
    message = Odometry()
    message.header.stamp.sec, message.header.stamp.nsec = divmod(time.time_ns(), 1_000_000_000)
    message.pose.pose.orientation.w = 1.0
    publisher.publish(message)

node.create_timer(0.02, send)
print("ready", flush=True)
lcmtools.spin(node)
"""


@pytest.fixture(scope="module")
def hosts(module_pair, lcmtools_path):
    """A talker and a server on ada, a listener on bob."""
    ada, bob = module_pair
    server = ada.python(_SERVER)
    ada.start(lcmtools_path, "run", "talker")
    listener = bob.start(lcmtools_path, "run", "listener")
    server.wait_for("ready")
    listener.wait_for("hello")
    return module_pair


@pytest.fixture
def ada(hosts):
    return hosts[0]


@pytest.fixture
def bob(hosts):
    return hosts[1]


def test_topics_and_nodes_of_both_are_listed_on_both(ada, bob):
    for host in (ada, bob):
        assert host.out("list").split() == ["/chatter", "/odom", "/rosout"]
        assert host.out("node", "list").split() == ["/listener", "/server", "/talker"]
    assert bob.out("node", "machine").split() == ["ada", "bob"]
    assert ada.out("node", "machine", "10.76.0.1").split() == ["/server", "/talker"]


def test_info_tells_name_and_address_of_the_other_computer(bob):
    text = bob.out("info", "/chatter")
    assert " * /talker (ada at 10.76.0.1, pid " in text
    assert " * /listener (bob, pid " in text
    (record,) = json.loads(bob.out("info", "/chatter", "--json"))
    (talker,) = record["publishers"]
    assert (talker["host"], talker["address"]) == ("ada", "10.76.0.1")
    assert talker["lost"] == 0 < talker["lost_of"]
    assert talker["rate"] == pytest.approx(10.0, rel=0.3)


def test_node_info_tells_of_the_process_only_what_it_said_itself(ada, bob):
    remote, local = bob.out("node", "info", "talker"), ada.out("node", "info", "talker")
    assert "Host: ada at 10.76.0.1\n" in remote
    assert "    * to: /listener\n" in remote
    assert "Memory: " not in remote
    assert "Host: ada\n" in local
    assert "Memory: " in local


def test_node_list_shows_where_they_run(bob):
    rows = {row.split()[1]: row for row in bob.out("node", "list", "-a").splitlines() if row}
    assert rows["/talker"].startswith("ada:")
    assert rows["/listener"].startswith("bob:")
    assert "up " in rows["/talker"]
    addresses = bob.out("node", "list", "-u").split()
    assert sorted(one.rpartition(":")[0] for one in addresses) == [
        *["udp://10.76.0.1"] * 2,
        "udp://10.76.0.2",
    ]


def test_nodes_answer_a_ping_from_the_other_computer(ada, bob):
    assert "reply from /talker (ada)" in bob.out("node", "ping", "talker", "-c", "1")
    assert "3 of 3 nodes answered" in ada.out("node", "ping", "-a")


@pytest.mark.parametrize(
    ("command", "shows"),
    [
        (["echo", "/chatter", "-n", "1"], 'data: "hello world '),
        (["delay", "/odom", "-n", "1"], "average delay: "),
    ],
)
def test_messages_are_shown_and_measured(bob, command, shows):
    assert bob.out(*command).startswith(shows)


def test_services_are_called(bob):
    assert "switched" in bob.out("service", "call", "/switch", "data: true")


def test_wtf_finds_nothing_on_either(ada, bob):
    for host in (ada, bob):
        found = json.loads(host.lcmtools("wtf", "--json", "--wait", "0.5s").stdout)
        assert [one["rule"] for one in found if one["severity"] not in ("note", "unchecked")] == []


def test_a_node_is_killed_from_the_other_computer(ada, bob, lcmtools_path):
    node = ada.start(lcmtools_path, "run", "talker", "__name:=victim")
    node.wait_for("hello")
    assert bob.out("node", "kill", "victim") == "killing /victim\nkilled\n"
    assert node.wait() == 0
    assert "on bob)" in node.output


def test_who_was_killed_is_remembered_and_forgotten_where_it_ran(ada, bob, lcmtools_path):
    node = ada.start(lcmtools_path, "run", "talker", "__name:=victim")
    node.wait_for("hello")
    node.send_signal(signal.SIGKILL)
    node.wait()
    assert "/victim (stale: ended without saying goodbye)" in ada.out("node", "list")
    assert bob.out("node", "cleanup") == ""
    assert ada.out("node", "cleanup") == "/victim\n"
