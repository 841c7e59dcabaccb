"""Faults of the bus and the computer: routes, other buses, foreign datagrams, other users."""

import os
import pwd
import shutil
import time
from collections.abc import Callable
from typing import Any

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


def test_a_bus_without_a_route(world: Any, ip: Callable[..., None]) -> None:
    world.node("talker")
    world.node("listener")
    ip("route", "del", "224.0.0.0/4")
    found = world.finds("bus")
    (command,) = [word for word in found.commands if "route add" in word]
    world.type(command)
    world.is_silent()


@pytest.mark.parametrize("kind", ["domain", "c"])
def test_a_program_on_another_bus(world: Any, kind: str) -> None:
    world.node("listener", "__name:=ear")
    away = {
        "domain": {"LCMTOOLS_DOMAIN": "3"},
        "c": {"LCM_DEFAULT_URL": "udpm://239.255.76.68:7700?ttl=0"},
    }[kind]
    if kind == "c":  # a program that only sends
        talker = world.c("sends", "/chatter", "00", "50", "10", **away)
    else:
        talker = world.node("talker", **away)
    found = world.finds("other-buses", f"pid {talker.pid} on 239.255.76.6")
    if kind == "c":
        return
    (command,) = found.commands
    name, _, value = command.removeprefix("export ").partition("=")
    world.again(world.of_node("/ear"), **{name: value.strip("'")})
    world.is_silent(**{name: value.strip("'")})


def test_a_program_of_the_other_provider(world: Any) -> None:
    world.hears("A")
    world.sends("bus.publish('A', Twist().encode())")
    url = "mpudpm://239.255.76.67:7667?ttl=0"
    sender = world.sends("bus.publish('B', Twist().encode())", LCM_DEFAULT_URL=url)
    found = world.finds("mpudpm", sender.pid, wait="1.2s")
    world.again(sender, **found.variables)
    world.is_silent()


def test_messages_that_leave_the_network(world: Any) -> None:
    sender = world.sends("bus.publish('A', Twist().encode())", LCM_DEFAULT_URL=f"{BUS}5")
    found = world.finds("ttl", sender.pid, "ttl=5")
    assert "ttl=1" in found.remedies[0]
    world.again(sender, LCM_DEFAULT_URL=f"{BUS}1")
    world.is_silent()


def test_another_user_on_the_same_bus(world: Any) -> None:
    setpriv = shutil.which("setpriv")
    if os.getuid() != 0 or not setpriv:
        pytest.skip("other users need root and setpriv")
    other = pwd.getpwnam("nobody")
    command = (setpriv, "--reuid", str(other.pw_uid), "--clear-groups", world.program("lcm-sink"))
    world.node("talker")
    world.node("listener")
    world.start(*command)
    world.until(lambda: world.is_heard_by(other.pw_uid))
    found = world.finds("other-users", other.pw_name)
    variable = found.variables
    assert variable == {"LCMTOOLS_DOMAIN": "1"}
    world.node("talker", **variable)
    world.node("listener", **variable)
    world.is_silent(**variable)


def test_datagrams_that_are_none_of_lcms(world: Any) -> None:
    world.node("talker")
    world.node("listener")
    sender = world.script(GARBAGE, ready="sends")
    world.finds("malformed", f"(pid {sender.pid})", "ss -uanp")
    world.end(sender)
    world.is_silent()


@pytest.fixture
def second_interface(ip: Callable[..., None], world: Any) -> str:
    """An interface besides lo to which the route of the bus leads."""
    ip("link", "add", "lan0", "type", "veth", "peer", "name", "peer0")
    ip("link", "set", "peer0", "up")
    ip("addr", "add", "10.77.0.1/24", "dev", "lan0")
    ip("link", "set", "lan0", "up", "multicast", "on")
    assert world.pids() == set()
    return "lan0"


def test_listeners_that_joined_elsewhere(
    world: Any, second_interface: str, ip: Callable[..., None]
) -> None:
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    sink = world.lcm("lcm-sink")
    ip("route", "replace", "224.0.0.0/4", "dev", "lo")
    world.node("talker")
    world.node("listener")
    world.finds("interfaces", "leads to lo", f"on {second_interface}", "start the listeners again")
    world.again(sink)
    world.is_silent()


def test_a_strict_filter_of_routes(
    world: Any, second_interface: str, ip: Callable[..., None]
) -> None:
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


def test_a_route_that_does_not_leave_the_computer(
    world: Any, second_interface: str, ip: Callable[..., None]
) -> None:
    variable = {"LCM_DEFAULT_URL": f"{BUS}1"}
    world.node("talker", **variable)
    world.node("listener", **variable)
    world.finds("loopback-route", "ttl=1", **variable)
    ip("route", "replace", "224.0.0.0/4", "dev", second_interface)
    for name in ("/talker", "/listener"):
        world.again(world.of_node(name, **variable))
    world.is_silent(**variable)


def test_datagrams_whose_pieces_do_not_all_come(world: Any) -> None:
    if os.getuid() != 0:
        pytest.skip("raw sockets need root")
    world.node("talker")
    world.node("listener")
    world.type("sysctl -w net.ipv4.ipfrag_time=1")
    sender = world.script(PIECES, ready="sends")
    world.finds("reassembly", "smaller messages", wait="1.2s")
    world.end(sender)
    time.sleep(1.5)  # what has been sent counts when its time is over
    world.is_silent()


def test_an_interface_that_is_down(world: Any, ip: Any) -> None:
    world.node("talker")
    world.node("listener")
    ip("link", "set", "lo", "down")
    found = world.finds("bus", "the interface lo is down")
    (command,) = [word for word in found.commands if "route add" in word]
    world.type(command)
    world.is_silent()
