"""Nodes of this computer that answer late, on a bus that is told what arrives when."""

import os
import socket
import time
from typing import ClassVar

import pytest

from lcmtools.bus.processes import Process
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import NodeInfo
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence

URL = parse_url("udpm://239.255.76.67:7667?ttl=0")
BETWEEN_COMPUTERS = parse_url("udpm://239.255.76.67:7667?ttl=1")
LATE = 0.6  # [s], as on a computer with many busy programs
SOON = 0.04  # [s]


class LateObserver:
    """A source in which one announcement comes, a long time after the request."""

    is_live, is_log, is_awaiting, has_strangers, port = True, False, False, False, 0
    numbered: ClassVar[dict[Sender, Sequence]] = {}

    def __init__(self, node, late=LATE):
        self._node, self._late, self._asked, self.requests = node, late, 0.0, 0

    def receive(self, timeout):
        """Return the announcement when it is due."""
        time.sleep(timeout)
        if not self._asked or time.monotonic() < self._asked + self._late:
            return []
        self._asked = 0.0
        return [Packet(NODE_CHANNEL, encode_announcement(Announcement(self._node)), time.time_ns())]

    def send(self, channel, payload):
        """Note the request."""
        del channel, payload
        self._asked = time.monotonic()
        self.requests += 1

    def close(self):
        """There is nothing to leave."""


class LossyObserver(LateObserver):
    """The same on a busy computer, where the first request is lost on its way to another."""

    def receive(self, timeout):
        """Return late if nothing has come."""
        return super().receive(timeout) or super().receive(0.1 if self.requests < 2 else 0.0)

    def send(self, channel, payload):
        """Note the request; the first one does not arrive."""
        super().send(channel, payload)
        if self.requests == 1:
            self._asked = 0.0


@pytest.fixture
def late_bus(tmp_path):
    """A bus with one node, whose process is this one."""
    environment = {"XDG_RUNTIME_DIR": str(tmp_path)}
    host, now = socket.gethostname(), time.time_ns()
    node = NodeInfo("/driver", "1", host=host, pid=os.getpid(), start_time=now)
    NodeRecords(URL, environment).write(node)
    return BusMonitor(URL, "test", environment, LateObserver(node))


def test_a_node_that_left_a_record_and_runs_is_given_time_to_answer(late_bus):
    assert [node.stale for node in late_bus.settle(foreign=False).nodes] == [""]


def test_a_stopped_node_is_not_waited_for(late_bus, monkeypatch):
    monkeypatch.setattr(Process, "state", property(lambda one: "T" * (one.pid == os.getpid())))
    (node,) = late_bus.settle(foreign=False).nodes
    assert node.stale == "runs but does not answer"


def test_nodes_that_were_asked_before_the_look_are_not_asked_twice(tmp_path):
    observer = LateObserver(NodeInfo("/driver", "1", host="h", pid=1))
    environment = {"XDG_RUNTIME_DIR": str(tmp_path)}
    monitor = BusMonitor(URL, "test", environment, observer, asked=time.monotonic())
    monitor.settle(foreign=False)
    assert observer.requests == 0
    monitor.settle(foreign=False)
    assert observer.requests == 1


def test_a_second_request_is_sent_however_busy_this_computer_is(tmp_path):
    observer = LossyObserver(NodeInfo("/driver", "1", host="other", pid=1), SOON)
    environment = {"XDG_RUNTIME_DIR": str(tmp_path)}
    monitor = BusMonitor(BETWEEN_COMPUTERS, "test", environment, observer)
    assert [node.name for node in monitor.settle(foreign=False).nodes] == ["/driver"]
    assert observer.requests == 2
