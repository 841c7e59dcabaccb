"""Names of senders, and how seldom the socket table is read for them."""

import os
import socket

import pytest

from lcmtools.bus.kernel import own_pid_namespace
from lcmtools.bus.processes import Process
from lcmtools.bus.sockets import SocketTable, UdpSocket
from lcmtools.graph.model import NodeInfo
from lcmtools.observe.reading.senders import SenderNames, is_gone, is_here
from lcmtools.observe.reports.describe import host_text
from lcmtools.wire.packet import Sender

LOCAL, OTHER = Sender("127.0.0.1", 1), Sender("127.0.0.1", 2)


def test_a_process_is_looked_up_once_and_one_not_found_again_after_a_while():
    asked = []
    time = [0.0]

    def read():
        asked.append(time[0])
        return SocketTable({5: UdpSocket("127.0.0.1", 1, 5, 0, 0)}, {5: Process(7, "drive")})

    names = SenderNames(read, lambda: time[0])
    for moment in (0.0, 1.0, 6.0):
        time[0] = moment
        names.update([LOCAL, OTHER, None])
    assert asked == [0.0, 6.0]
    assert (names.name(LOCAL), names.name(OTHER)) == ("drive (pid 7)", "127.0.0.1:2")


def test_other_computers_are_not_looked_up():
    names = SenderNames(lambda: pytest.fail("looked up"))
    names.update([Sender("10.255.3.4", 5)])
    assert names.name(Sender("10.255.3.4", 5)) == "10.255.3.4:5"


def test_a_node_is_named_before_its_process():
    names = SenderNames(lambda: pytest.fail("looked up"))
    names.update([LOCAL], [NodeInfo("/drive", "1", "here", 7, sender=LOCAL)])
    assert (names.name(LOCAL), names.name(None)) == ("/drive", "unknown sender")


def test_a_port_that_processes_share_names_none_of_them():
    rows = {inode: UdpSocket("127.0.0.1", 1, inode, 0, 0) for inode in (5, 6)}
    table = SocketTable(rows, {5: Process(7, "one"), 6: Process(8, "other")})
    assert table.processes(LOCAL).only is None
    assert [process.pid for process in table.processes(LOCAL).candidates] == [7, 8]
    assert table.processes(Sender("10.255.3.4", 1)).candidates == ()


def test_a_node_of_another_pid_namespace_is_not_here():
    node = NodeInfo("/drive", "1", socket.gethostname(), os.getpid(), sender=LOCAL)
    here = own_pid_namespace()
    assert [is_here(node._replace(pid_namespace=n)) for n in (0, here, here + 1)] == [1, 1, 0]
    assert not is_gone(node._replace(pid=1 << 22, pid_namespace=here + 1))
    assert host_text(node._replace(pid_namespace=here + 1)).endswith(", in another container")
