"""Faults of the bus and the computer: routes, other buses, foreign datagrams, other users."""

import pwd
import shutil
import time

import pytest

BUS = "udpm://239.255.76.67:7667?ttl="
GARBAGE = """
import socket, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
while True:
    sender.sendto(b"{\\"speed\\": 1.0}", ("239.255.76.67", 7667))
    print("sends", flush=True)
    time.sleep(0.05)
"""


PIECES = """
import socket, struct, time
raw = socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_RAW)
home, number = socket.inet_aton("127.0.0.1"), 0
while True:  # the first fragment of a datagram, and no other
    number += 1
    payload = struct.pack(">HHHH", 40000, 7667, 3008, 0) + b"LC02" + bytes(988)
    head = struct.pack(">BBHHHBBH", 0x45, 0, 1020, number, 0x2000, 1, 17, 0) + home + home
    raw.sendto(head + payload, ("127.0.0.1", 0))
    print("sends", flush=True)
    time.sleep(0.1)
"""
FORGED = """
import socket, struct, sys, time
raw = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
raw.bind((sys.argv[1], 0))
payload = struct.pack(">HHHH", 40000, 7667, 20, 0) + b"LC02" + bytes(8)
home, group = socket.inet_aton("10.99.0.1"), socket.inet_aton("239.255.76.67")
head = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 40, 1, 0, 1, 17, 0, home, group)
total = sum(struct.unpack(">10H", head))
total = (total >> 16) + (total & 0xFFFF)
head = head[:10] + struct.pack(">H", ~(total + (total >> 16)) & 0xFFFF) + head[12:]
ethernet = bytes.fromhex("01005e7f4c43") + bytes.fromhex("020000000001") + b"\\x08\\x00"
while True:  # from a computer to which no route leads
    raw.send(ethernet + head + payload)
    print("sends", flush=True)
    time.sleep(0.05)
"""
TRIES_A_BUS = """
import time, lcm
from lcmtools.types.std_msgs import String
print("runs", flush=True)
bus = None
while True:
    try:
        bus = bus or lcm.LCM()
        bus.publish("/chatter", String().encode())
    except (OSError, RuntimeError):
        pass
    time.sleep(0.1)
"""
_EARS = """
import lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("ears")
node.create_subscription(String, "/chatter", lambda _: None, 10)
print("listens", flush=True)
lcmtools.spin(node)
"""
MAKES_A_BUS = """
import socket, sys, threading, time
if "7700" in sys.argv[1]:
    server = socket.create_server(("127.0.0.1", 7700))
    def serve():
        client, _ = server.accept()
        client.recv(8), client.sendall(bytes.fromhex("287617fa00000100")), time.sleep(1000)
    threading.Thread(target=serve, daemon=True).start()
import lcm
print("runs", flush=True)
bus = lcm.LCM()
bus.subscribe("A", print)
time.sleep(1000)
"""


def test_a_bus_without_a_route(world, ip):
    world.node("talker")
    world.node("listener")
    ip("route", "del", "224.0.0.0/4")
    found = world.finds("bus")
    (command,) = [word for word in found.commands if "route add" in word]
    world.type(command)
    world.is_silent()


@pytest.mark.parametrize("kind", ["domain", "c"])
def test_a_program_on_another_bus(world, kind):
    world.node("listener", "__name:=ear")
    away = {
        "domain": {"LCMTOOLS_DOMAIN": "3"},
        "c": {"LCM_DEFAULT_URL": "udpm://239.255.76.68:7700?ttl=0"},
    }[kind]
    if kind == "c":  # a program that only sends
        talker = world.c("sends", "/chatter", "00", "50", "10", **away)
    else:
        talker = world.node("talker", **away)
    found = world.finds("other-buses", talker.pid, "on-bus")
    if kind == "c":
        return
    (command,) = found.commands
    name, _, value = command.removeprefix("export ").partition("=")
    world.again(world.of_node("/ear"), **{name: value.strip("'")})
    world.is_silent(**{name: value.strip("'")})


def test_a_program_on_another_bus_that_publishes_seldom(world):
    world.node("listener")
    string = "m = String(); m.data = 'x'; bus.publish('/chatter', m.encode())"
    away = world.sends(string, 1.0, LCM_DEFAULT_URL="udpm://239.255.76.67:7700?ttl=0")
    found = world.finds("other-buses", "/chatter", away.pid, "239.255.76.67:7700")
    assert found.severity == "warning"
    world.again(away, **found.variables)
    world.is_silent()


def test_a_python_node_on_another_domain_by_mistake(world):
    """Nodes do not load liblcm, and nothing in such a command line names it."""
    world.node("talker")
    away = world.script(_EARS, ready="listens", LCMTOOLS_DOMAIN="3")
    where = "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3"
    found = world.finds("other-buses", "/chatter", away.pid, *where)
    assert found.severity == "warning"
    world.again(away, LCMTOOLS_DOMAIN="", **found.variables)
    world.is_silent()


def test_a_program_whose_url_lacks_the_port_is_on_no_bus_although_it_listens(world):
    world.node("talker")
    world.node("listener")
    url = "udpm://239.255.76.67"
    program = world.hears("X", LCM_DEFAULT_URL=url)
    world.finds("other-buses", program.pid, "on-no-bus", url)


def test_two_systems_of_one_kind_on_two_buses(world):
    for variables in ({}, {"LCMTOOLS_DOMAIN": "3"}):
        world.node("talker", **variables)
        world.node("listener", **variables)
    assert [found.severity for found in world.look()] == ["note"]


def test_a_program_of_the_other_provider(world):
    world.hears("A")
    world.sends("bus.publish('A', Twist().encode())")
    url = "mpudpm://239.255.76.67:7667?ttl=0"
    sender = world.sends("bus.publish('B', Twist().encode())", LCM_DEFAULT_URL=url)
    found = world.finds("mpudpm", sender.pid, wait="1.2s")
    world.again(sender, **found.variables)
    world.is_silent()


def test_messages_that_leave_the_network(world):
    sender = world.sends("bus.publish('A', Twist().encode())", LCM_DEFAULT_URL=f"{BUS}5")
    assert world.finds("ttl", sender.pid).facts[0]["ttl"] == 5
    world.again(sender, LCM_DEFAULT_URL=f"{BUS}1")
    world.is_silent()


def test_a_camera_that_stays_on_this_computer_on_purpose(world):
    world.hears("IMAGE", LCM_DEFAULT_URL=f"{BUS}1")
    here = {"LCM_DEFAULT_URL": f"{BUS}0"}
    world.sends("bus.publish('IMAGE', String().encode() + bytes(50_000))", 0.1, **here)
    assert world.look("--rule", "ttl", LCM_DEFAULT_URL=f"{BUS}1") == []


@pytest.mark.root
def test_another_user_on_the_same_bus(world):
    setpriv = shutil.which("setpriv") or pytest.skip("another user needs setpriv")
    other = pwd.getpwnam("nobody")
    command = (setpriv, "--reuid", str(other.pw_uid), "--clear-groups", world.program("lcm-sink"))
    nodes = [world.node(name) for name in ("talker", "listener")]
    world.start(*command)
    world.until(lambda: world.is_heard_by(other.pw_uid))
    found = world.finds("other-users", other.pw_name)
    variable = found.variables
    assert variable == {"LCMTOOLS_DOMAIN": "1"}
    for node in nodes:
        world.end(node)
    world.node("talker", **variable)
    world.node("listener", **variable)
    world.is_silent(**variable)


def test_datagrams_that_are_none_of_lcms(world):
    world.node("talker")
    world.node("listener")
    sender = world.script(GARBAGE, ready="sends")
    world.finds("malformed", sender.pid)
    world.end(sender)
    world.is_silent()


@pytest.fixture
def second_interface(ip, world):
    """An interface besides lo to which the route of the bus leads."""
    ip("link", "add", "lan0", "type", "veth", "peer", "name", "peer0")
    ip("link", "set", "peer0", "up")
    ip("addr", "add", "10.77.0.1/24", "dev", "lan0")
    ip("link", "set", "lan0", "up", "multicast", "on")
    assert world.pids() == set()
    return "lan0"


def test_listeners_that_joined_elsewhere(world, second_interface, ip):
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    sink = world.lcm("lcm-sink")
    ip("route", "replace", "224.0.0.0/4", "dev", "lo")
    world.node("talker")
    world.node("listener")
    found = world.finds("interfaces", sink.pid, "restart-listeners")
    assert found.facts[0]["interfaces"] == [second_interface]
    world.again(sink)
    world.is_silent()


def test_an_interface_without_a_link(world, second_interface, ip):
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    variable = {"LCM_DEFAULT_URL": f"{BUS}1"}
    world.node("talker", **variable)
    world.node("listener", **variable)
    world.is_silent(**variable)
    ip("link", "set", "peer0", "down")
    world.finds("link", second_interface, **variable)


@pytest.mark.root  # for raw sockets
def test_datagrams_that_the_strict_filter_drops(world, second_interface, ip):
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    variable = {"LCM_DEFAULT_URL": f"{BUS}1"}
    world.node("talker", **variable)
    world.node("listener", **variable)
    for name in ("all", second_interface):
        world.type(f"sysctl -w net.ipv4.conf.{name}.rp_filter=1")
    world.script(FORGED, "peer0", ready="sends")
    found = world.finds("rp-filter", **variable)
    assert found.severity == "warning"


@pytest.mark.parametrize(
    "url", ["tcpq://127.0.0.1:7700", "udpm://239.255.76.67:7670", "memq://", "udpm://239.255.76.67"]
)
def test_a_program_on_another_bus_beside_a_busy_one(world, url):
    world.node("talker")
    world.node("listener")
    program = world.script(MAKES_A_BUS, url, ready="runs", LCM_DEFAULT_URL=url)
    found = world.finds("other-buses", program.pid, f"LCM_DEFAULT_URL={url}")
    assert (found.severity, found.variables) == ("note", {"LCM_DEFAULT_URL": f"{BUS}0"})
    world.end(program)
    world.is_silent()


def test_a_strict_filter_of_routes(world, second_interface, ip):
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    ip("link", "add", "lan1", "type", "veth", "peer", "name", "peer1")
    ip("link", "set", "peer1", "up")
    ip("link", "set", "lan1", "up")
    ip("addr", "add", "10.78.0.1/24", "dev", "lan1")
    variable = {"LCM_DEFAULT_URL": f"{BUS}1"}
    world.node("talker", **variable)
    world.node("listener", **variable)
    world.type("sysctl -w net.ipv4.conf.all.rp_filter=1")
    found = world.finds("rp-filter", **variable)
    world.obey(found)
    world.is_silent(**variable)


def test_a_route_that_does_not_leave_the_computer(world, second_interface, ip):
    variable = {"LCM_DEFAULT_URL": f"{BUS}1"}
    world.node("talker", **variable)
    world.node("listener", **variable)
    world.finds("loopback-route", **variable)
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    for name in ("/talker", "/listener"):
        world.again(world.of_node(name, **variable))
    world.is_silent(**variable)


@pytest.mark.root  # for raw sockets
def test_datagrams_whose_pieces_do_not_all_come(world):
    world.node("talker")
    world.node("listener")
    world.type("sysctl -w net.ipv4.ipfrag_time=1")
    sender = world.script(PIECES, ready="sends")
    world.finds("reassembly", wait="1.2s")
    world.end(sender)
    time.sleep(1.5)  # what has been sent counts when its time is over
    world.is_silent()


def test_an_interface_that_is_down(world, ip):
    world.node("talker")
    world.node("listener")
    ip("link", "set", "lo", "down")
    found = world.finds("bus", "interface-down")
    (command,) = [word for word in found.commands if "route add" in word]
    world.type(command)
    world.is_silent()


@pytest.mark.parametrize("url", ["udpm://239.255.76.67", "udp://239.255.76.67:7667"])
def test_a_wrong_url_of_a_program_whose_topic_is_waited_for(world, url):
    world.node("listener")
    program = world.script(TRIES_A_BUS, ready="runs", LCM_DEFAULT_URL=url)
    found, _ = world.look("--rule", "other-buses", "--rule", "unconnected-subscriptions")
    assert (found.rule, found.severity) == ("other-buses", "warning")
    assert found.facts[0]["kind"] == "on-no-bus"
    world.again(program, **found.variables)
    world.is_silent()
