"""What wtf reads of this computer: real sockets, routes and processes."""

import os
import socket
from collections.abc import Callable
from typing import Any

import pytest

from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.processes import owners, udp_sockets
from lcmtools.bus.socket_memory import receive_buffers
from lcmtools.bus.url import parse_url
from lcmtools.doctor.surroundings import busy_time, host, lcm_processes, state_of


def test_the_size_of_a_receive_buffer_is_known_by_inode() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        for wanted in (20_000, 150_000):
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, wanted)
            granted = one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
            assert receive_buffers()[os.fstat(one.fileno()).st_ino] == granted


def test_what_waits_in_a_socket_is_known() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
        one.sendto(bytes(1000), ("127.0.0.1", port))
        (row,) = (row for row in udp_sockets() if row.port == port)
        assert row.queued_bytes >= 1000
        one.recv(2000)
        (row,) = (row for row in udp_sockets() if row.port == port)
        assert row.queued_bytes == 0


def test_this_computer_is_described(bus_url: str) -> None:
    url = parse_url(bus_url)
    with receiving_socket(url):
        here = host(url, {})
    assert here.uid == os.getuid()
    assert here.receive_buffer > 0
    assert here.most_receive_buffer >= here.receive_buffer / 2
    assert here.environment == ()


@pytest.mark.parametrize(
    ("variables", "complaint"),
    [
        ({"PYTHONPATH": "/no/such/folder"}, "PYTHONPATH has /no/such/folder, which does not exist"),
        ({"LCM_DEFAULT_URL": "udp://x"}, "LCM_DEFAULT_URL 'udp://x': no LCM provider 'udp'"),
    ],
)
def test_variables_that_are_wrong_are_told(variables: dict[str, str], complaint: str) -> None:
    (line,) = host(parse_url("udpm://"), variables).environment
    assert line.startswith(complaint)


_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("A", print)
print("ready", flush=True)
while True:
    bus.handle()
"""


def test_a_program_on_another_bus_is_known_with_its_variable(
    bus_url: str, free_port: Callable[[], int], start_python: Callable[..., Any]
) -> None:
    other = f"udpm://239.255.76.67:{free_port()}?ttl=0"
    listener = start_python(_LISTENER, LCM_DEFAULT_URL=other)
    listener.wait_for("ready")
    rows = udp_sockets()
    holders = owners(row.inode for row in rows)
    found = {process.pid: process for process in lcm_processes(parse_url(bus_url), rows, holders)}
    there = found[listener.pid]
    assert there.bus == other.removeprefix("udpm://").removesuffix("?ttl=0")
    assert there.variable == f"LCM_DEFAULT_URL={other}"
    assert 0 < there.open_files < there.most_files
    here = {process.pid: process for process in lcm_processes(parse_url(other), rows, holders)}
    assert here[listener.pid].bus == ""


def test_a_process_has_a_state_and_a_time_that_it_was_busy() -> None:
    assert state_of(os.getpid()) in ("R", "S")
    assert busy_time(os.getpid()) > 0
    assert state_of(2**22 + 1) == ""
    assert busy_time(2**22 + 1) == 0
