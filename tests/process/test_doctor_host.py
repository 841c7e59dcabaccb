"""Evidence of this computer: real sockets, routes and processes."""

import os
import socket
import subprocess
import sys

import pytest

from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.network_watch import route_interface
from lcmtools.bus.processes import Process
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import parse_url
from lcmtools.doctor import host as host_module
from lcmtools.doctor.firewall import Traffic
from lcmtools.doctor.host import firewall, host, large_problem, send_problem, silent_bridge
from lcmtools.doctor.lcm_processes import lcm_processes


def test_the_size_of_a_receive_buffer_is_known_by_inode():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        for wanted in (20_000, 150_000):
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, wanted)
            granted = one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
            assert SocketTable.read().buffers[os.fstat(one.fileno()).st_ino] == granted


def test_what_waits_in_a_socket_is_known():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
        one.sendto(bytes(1000), ("127.0.0.1", port))
        inode = os.fstat(one.fileno()).st_ino
        assert SocketTable.read().rows[inode].queued_bytes >= 1000
        one.recv(2000)
        assert SocketTable.read().rows[inode].queued_bytes == 0


def test_this_computer_is_described(bus_url):
    url = parse_url(bus_url)
    with receiving_socket(url):
        here = host(url, {})
    assert here.uid == os.getuid()
    assert here.most_receive_buffer > 0
    assert here.environment == ()


@pytest.mark.parametrize(
    ("variables", "complaint"),
    [
        ({"PYTHONPATH": "/no/such/folder"}, "PYTHONPATH has /no/such/folder, which does not exist"),
        (
            {"LCM_DEFAULT_URL": "udpm://239.255.76.67:7667?ttl=1", "LCMTOOLS_DOMAIN": "3"},
            "LCMTOOLS_DOMAIN=3 has no effect beside LCM_DEFAULT_URL=udpm://239.255.76.67:7667",
        ),
        ({"LCM_DEFAULT_URL": "udp://x"}, "LCM_DEFAULT_URL 'udp://x': no LCM provider 'udp'"),
    ],
)
def test_variables_that_are_wrong_are_told(variables, complaint):
    (line,) = host(parse_url("udpm://"), variables).environment
    assert line.startswith(complaint)


def test_two_variables_that_name_the_same_bus_are_fine():
    variables = {"LCM_DEFAULT_URL": "udpm://239.255.76.67:7670?ttl=1", "LCMTOOLS_DOMAIN": "3"}
    assert host(parse_url("udpm://"), variables).environment == ()


def test_a_package_of_types_in_two_places_is_told(tmp_path):
    for place in ("ros", "mine"):
        (tmp_path / place / "geometry_msgs").mkdir(parents=True)
    one, other = str(tmp_path / "ros"), str(tmp_path / "mine")
    assert host(parse_url("udpm://"), {"PYTHONPATH": f"{one}:{one}"}).environment == ()
    (line,) = host(parse_url("udpm://"), {"PYTHONPATH": f"{one}:{other}"}).environment
    assert line == (
        f"Python finds geometry_msgs in {one}/geometry_msgs and in {other}/geometry_msgs;"
        " the first counts"
    )


def test_a_package_lcm_that_is_not_lcms_is_told(tmp_path, monkeypatch):
    monkeypatch.delitem(sys.modules, "lcm")
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "lcm").mkdir()
    (tmp_path / "lcm" / "__init__.py").touch()
    (line,) = host(parse_url("udpm://"), {}).environment
    assert line == f"'import lcm' finds {tmp_path}/lcm/__init__.py, which may not be LCM's package"
    (tmp_path / "lcm" / "_lcm.so").touch()  # wherever it is installed
    assert host(parse_url("udpm://"), {}).environment == ()


_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("A", print)
print("ready", flush=True)
while True:
    bus.handle()
"""


def test_a_program_on_another_bus_is_known_with_its_variable(bus_url, free_port, start_python):
    other = f"udpm://239.255.76.67:{free_port()}?ttl=0"
    listener = start_python(_LISTENER, LCM_DEFAULT_URL=other)
    listener.wait_for("ready")
    table = SocketTable.read()
    found = {one.pid: one for one in lcm_processes(parse_url(bus_url), table, set())}
    there = found[listener.pid]
    assert there.bus == other.removeprefix("udpm://").removesuffix("?ttl=0")
    assert there.variable == f"LCM_DEFAULT_URL={other}"
    assert 0 < there.open_files < there.most_files
    here = {one.pid: one for one in lcm_processes(parse_url(other), table, set())}
    assert here[listener.pid].bus == ""


_SENDER = """
import lcm, sys, time
bus = lcm.LCM({url})
bus.publish("A", bytes(12))
print("ready", flush=True)
time.sleep(1000)
"""


@pytest.mark.parametrize("place", ["code", "argument"])
def test_a_program_that_only_sends_is_where_its_code_or_argument_says(
    place, bus_url, free_port, start, tmp_path
):
    other = f"udpm://239.255.76.67:{free_port()}?ttl=0"
    file = tmp_path / "sender.py"
    file.write_text(_SENDER.format(url=f"'{other}'" if place == "code" else "sys.argv[1]"))
    sender = start(sys.executable, str(file), *([other] if place == "argument" else []))
    sender.wait_for("ready")
    processes = lcm_processes(parse_url(bus_url), SocketTable.read(), set())
    (found,) = [process for process in processes if process.pid == sender.pid]
    assert found.bus == other.removeprefix("udpm://").removesuffix("?ttl=0")
    assert found.is_guess == (place == "code")


def test_a_process_has_a_state_and_a_time_that_it_was_busy():
    assert Process(os.getpid()).state in ("R", "S")
    assert Process(os.getpid()).processor_times[0] > 0
    assert Process(2**22 + 1).state == ""
    assert Process(2**22 + 1).processor_times == (0, 0)


def test_a_large_message_comes_back_and_reaches_nobody_else(bus_url):
    url = parse_url(bus_url)
    with receiving_socket(url) as somebody:
        somebody.settimeout(0)
        assert large_problem(url) == ""
        heard = somebody.recv(65_535)
        assert b"LCM_SELF_TEST\0" in heard  # liblcm's own, as each program sends it
        with pytest.raises(BlockingIOError):
            somebody.recv(65_535)


class _Lossy(socket.socket):
    """Sends no datagram that is large, as where a firewall drops them."""

    def sendto(self, data, address):
        return len(data) if len(data) > 60_000 else super().sendto(data, address)


def test_a_large_message_that_is_lost_is_told(bus_url, monkeypatch):
    monkeypatch.setattr(
        host_module, "sending_socket", lambda _: _Lossy(socket.AF_INET, socket.SOCK_DGRAM)
    )
    assert large_problem(parse_url(bus_url)) == "part 1 of 5, 65507 bytes, is lost"


def test_datagrams_that_the_system_refuses_to_send_are_told(bus_url, monkeypatch):
    monkeypatch.setattr(host_module, "fragments", lambda *_: iter([bytes(70_000)]))
    problem = large_problem(parse_url(bus_url))
    assert problem == "the system does not send datagrams as large as LCM's"


@pytest.mark.usefixtures("private_network")
def test_what_forbids_sending_is_told_with_what_helps(ip):
    url = parse_url("udpm://239.255.76.67:7667?ttl=1")
    assert send_problem(url) == ("", "")
    for kind, reason in (("prohibit", "Permission denied"), ("blackhole", "Invalid argument")):
        ip("route", "add", kind, "239.255.76.67/32")
        what, remedy = send_problem(url)
        assert what == f"a {kind} route forbids sending to 239.255.76.67:7667 ({reason})"
        show, delete = remedy.removeprefix("find it with: ").split("; then: ")
        line = subprocess.run(show.split(), capture_output=True, text=True, check=True).stdout
        assert line.split() == [kind, "239.255.76.67"]
        assert delete == "sudo ip route del LINE"
        ip("route", "del", *line.split())
        assert send_problem(url) == ("", "")
    ip("route", "del", "224.0.0.0/4")
    what, remedy = send_problem(url)
    assert what == "no multicast route to 239.255.76.67:7667"
    assert remedy.startswith("connect the network, or set a route to its interface: sudo ip route")
    assert large_problem(url) == ""  # not even a small one leaves: another rule says so


@pytest.mark.usefixtures("private_network")
def test_the_route_is_that_of_the_kernel_whichever_table_has_it(ip):
    """As with a VPN: the main table leads elsewhere, or nowhere."""
    group = "239.255.76.67"
    assert route_interface(group) == "lo"
    ip("link", "add", "vpn", "type", "veth", "peer", "name", "far")
    ip("link", "set", "far", "up")
    ip("link", "set", "vpn", "up")
    ip("addr", "add", "10.8.0.1/24", "dev", "vpn")
    ip("route", "add", "default", "dev", "vpn", "table", "200")
    ip("rule", "add", "priority", "100", "table", "200")
    assert route_interface(group) == "vpn"
    ip("route", "del", "224.0.0.0/4")
    assert route_interface(group) == "vpn"
    ip("rule", "del", "priority", "100")
    assert route_interface(group) == ""
    ip("route", "add", "prohibit", f"{group}/32")
    assert route_interface(group) == ""


@pytest.mark.parametrize("name", ["PYTHONPATH", "LCMTOOLS_TYPE_PATH"])
def test_a_folder_that_cannot_be_looked_into_is_named_with_its_variable(name, tmp_path, bus_url):
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    here = host(parse_url(bus_url), {name: f"{loop}/types:{tmp_path / 'gone'}"})
    assert f"{name} has {loop}/types, which cannot be read" in here.environment
    assert f"{name} has {tmp_path / 'gone'}, which does not exist" in here.environment


@pytest.fixture
def interfaces(tmp_path, monkeypatch):
    """Two bridges, br0 with the port eth0, and wlan0, in place of /sys/class/net."""
    monkeypatch.setattr("lcmtools.doctor.host._NET", tmp_path)
    for name, querier in (("br0", 0), ("br1", 1)):
        settings = tmp_path / name / "bridge"
        settings.mkdir(parents=True)
        (settings / "multicast_snooping").write_text("1\n")
        (settings / "multicast_querier").write_text(f"{querier}\n")
    for name in ("eth0", "wlan0"):
        (tmp_path / name).mkdir()
    (tmp_path / "eth0" / "master").symlink_to("../br0")
    return tmp_path


@pytest.mark.parametrize(
    ("interface", "bridge"),
    [("br0", "br0"), ("eth0", "br0"), ("br1", ""), ("wlan0", ""), ("gone", ""), ("", "")],
)
@pytest.mark.usefixtures("interfaces")
def test_a_bridge_that_does_not_ask_who_listens_is_found(interface, bridge):
    assert silent_bridge(interface) == bridge


def test_a_bridge_that_passes_everything_on_need_not_ask(interfaces):
    (interfaces / "br0/bridge/multicast_snooping").write_text("0\n")
    assert silent_bridge("eth0") == ""


@pytest.fixture
def rules(tmp_path, monkeypatch):
    """``rules("...")``: what nft prints; no other firewall is there, and the user is root."""
    monkeypatch.setattr("lcmtools.doctor.host._UFW", tmp_path / "ufw.conf")
    monkeypatch.setattr("lcmtools.doctor.host._FIREWALLD", tmp_path / "firewalld.pid")
    monkeypatch.setattr("os.getuid", lambda: 0)
    monkeypatch.setenv("PATH", str(tmp_path))

    def write(text):
        program = tmp_path / "nft"
        program.write_text(f"#!/bin/sh\n/bin/cat <<'END'\n{text}\nEND\n")
        program.chmod(0o755)

    return write


_TRAFFIC = Traffic("239.255.76.67", 7667, "eth0")
_DROPS = "table inet t {\n chain c {\n  type filter hook input priority 0; policy drop;\n }\n}"


def test_rules_that_drop_are_a_firewall_and_others_are_none(rules):
    rules(_DROPS)
    assert firewall(_TRAFFIC) == ("nftables", "inet t c", "")
    rules(_DROPS.replace("drop", "accept"))
    assert firewall(_TRAFFIC) == ("", "", "")


def test_who_is_not_root_is_told_that_rules_are_unknown(rules, monkeypatch):
    rules(_DROPS)
    monkeypatch.setattr("os.getuid", lambda: 1000)
    name, _, unknown = firewall(_TRAFFIC)
    assert name == ""
    assert unknown.startswith("only root can read its rules")


@pytest.mark.usefixtures("rules")
def test_where_no_program_shows_the_rules_they_are_unknown():
    name, _, unknown = firewall(_TRAFFIC)
    assert name == ""
    assert unknown.startswith("neither nft nor iptables-save is installed")


@pytest.mark.usefixtures("rules")
def test_a_firewall_that_says_so_itself_needs_no_root(tmp_path, monkeypatch):
    monkeypatch.setattr("os.getuid", lambda: 1000)
    (tmp_path / "firewalld.pid").touch()
    assert firewall(_TRAFFIC) == ("firewalld", "", "")
    (tmp_path / "ufw.conf").write_text("ENABLED=yes\n")
    assert firewall(_TRAFFIC) == ("ufw", "", "")
