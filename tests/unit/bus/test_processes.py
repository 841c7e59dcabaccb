"""Reading the process and socket tables."""

import os
import signal
import socket
import subprocess
import sys

import pytest

from lcmtools.bus import processes, sockets
from lcmtools.bus.processes import Process, command_text, process_of
from lcmtools.bus.sockets import SocketTable, UdpSocket
from lcmtools.wire.packet import Sender


def test_a_row_of_the_socket_table_is_read():
    row = (
        "  523: 434CFFEF:1DF3 00000000:0000 07 00000000:00030C00 00:00000000 00000000  1000"
        "        0 33445 2 00000000f00ba4 7499"
    )
    assert sockets._parse_row(row.split()) == UdpSocket(
        "239.255.76.67", 7667, 33445, 1000, drops=7499, queued_bytes=0x30C00
    )


def test_sockets_of_java_which_are_of_ipv6_are_found():
    with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as dual:
        dual.bind(("::", 0))
        port = dual.getsockname()[1]
        table = SocketTable.read()
        (row,) = [one for one in table.rows.values() if one.port == port]
        assert (row.address, row.inode) == ("0.0.0.0", os.fstat(dual.fileno()).st_ino)  # noqa: S104
        assert table.buffers[row.inode] > 0


def test_the_interfaces_on_which_a_socket_is_in_a_group_are_known():
    group = "239.255.77.77"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as member:
        inode = os.fstat(member.fileno()).st_ino
        table = SocketTable({inode: UdpSocket("0.0.0.0", 0, inode, 0, 0)})  # noqa: S104
        assert table.joined_interfaces(inode, group) == ()
        joined = socket.inet_aton(group) + socket.inet_aton("127.0.0.1")
        member.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, joined)
        assert table.joined_interfaces(inode, group) == ("lo",)
        assert table.joined_interfaces(inode, "239.255.77.78") == ()
        assert table.joined_interfaces(1, group) == ()


def test_this_process_is_found_by_its_pid():
    own = process_of(os.getpid())
    assert own is not None
    assert own.pid == os.getpid()
    assert "pytest" in own.command or "python" in own.command
    assert own.start_ticks > 0


@pytest.mark.parametrize("name", [b"a) b (c", "fünfzehn Zeichn€".encode()[:15], b"\xff"])
def test_a_process_with_a_strange_name_is_read(name):
    """The kernel cuts a name after 15 bytes, also within a character."""
    source = (
        f"import sys; open('/proc/self/comm', 'wb').write({name!r}); print(flush=True);"
        " sys.stdin.read()"
    )
    command = [sys.executable, "-c", source]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        child.stdout.readline()
        found = process_of(child.pid)
        assert found is not None
        own = process_of(os.getpid())
        assert own is not None
        assert found.start_ticks >= own.start_ticks
        assert found.innermost_pid[1] == child.pid
        assert found.usage() is not None


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["/usr/bin/python3", "driver.py", ""], "/usr/bin/python3 driver.py"),
        (["/home/my robot/.venv/bin/python3", "./my robot/driver.py"], "python3 driver.py"),
        (["lcmtools", "pub", "/a", "{data: /b c}"], "lcmtools pub /a {data: /b c}"),
    ],
)
def test_a_program_in_a_folder_with_blanks_has_its_name(words, text):
    assert command_text(words) == text


def test_nothing_runs_under_an_impossible_pid():
    assert process_of(0) is None
    assert process_of(1 << 40) is None
    assert process_of(-1) is None


@pytest.mark.parametrize(
    ("address", "local"),
    [("127.0.0.1", True), ("127.9.9.9", True), ("0.0.0.0", True), ("203.0.113.9", False)],  # noqa: S104
)
def test_an_address_of_this_computer_is_known(address, *, local):
    assert processes.is_local(address) is local


def test_a_port_that_nobody_has_leads_to_no_process():
    assert SocketTable({}).processes(Sender("127.0.0.1", 0)).only is None
    assert SocketTable({}).holders == {}


def test_a_socket_that_was_closed_while_its_process_was_looked_for_has_gone():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there:
        there.bind(("127.0.0.1", 0))
        inode = os.fstat(there.fileno()).st_ino
        rows = {n: UdpSocket("127.0.0.1", 1, n, 0, 0) for n in (inode, 1)}
        assert [SocketTable(rows, {}).has_gone(one) for one in rows] == [False, True]
        assert not SocketTable(rows, {1: Process(7)}).has_gone(1)


def test_a_process_is_stopped_until_it_is_continued():
    with subprocess.Popen(["sleep", "60"]) as child:  # noqa: S607
        os.kill(child.pid, signal.SIGSTOP)
        os.waitid(os.P_PID, child.pid, os.WSTOPPED)
        assert Process(child.pid).is_stopped
        os.kill(child.pid, signal.SIGCONT)
        os.waitid(os.P_PID, child.pid, os.WCONTINUED)
        assert not Process(child.pid).is_stopped
        child.kill()
    assert not Process(child.pid).is_stopped


@pytest.mark.parametrize("error", [PermissionError, ProcessLookupError])
def test_a_process_that_proc_hides_has_not_ended(error, monkeypatch, tmp_path):
    """As /proc mounted with hidepid=2 does with those of other users: EPERM is not ESRCH."""

    def kill(_pid, _signal):
        raise error

    (tmp_path / "self").symlink_to(str(os.getpid()))
    monkeypatch.setattr(processes, "PROC", tmp_path)
    monkeypatch.setattr(os, "kill", kill)
    found = process_of(4711)
    assert found == (Process(4711) if error is PermissionError else None)


def test_a_table_of_sockets_that_cannot_be_read_is_not_known(monkeypatch, tmp_path):
    monkeypatch.setattr(sockets, "_TABLES", (tmp_path / "udp", tmp_path / "udp6"))
    assert not sockets.sockets_are_known()
    assert SocketTable.read().rows == {}
