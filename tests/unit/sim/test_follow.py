"""The leader of a fleet: which of its followers it waits for."""

import os
import socket
from types import SimpleNamespace

import pytest

from lcmtools.graph.model import Graph, NodeInfo
from lcmtools.types.std_msgs import Header
from lcmtools_sim import follow

NOBODY = 1 << 22
"""No process has this number."""


def runs_as(pid):
    return NodeInfo("/other", id=str(pid), host=socket.gethostname(), pid=pid)


class Leading:
    """A leader one step ahead of a follower, which has been silent for long."""

    def __init__(self, nodes, monkeypatch):
        heard = []
        node = SimpleNamespace(
            create_subscription=lambda _kind, _topic, callback: heard.append(callback),
            graph=lambda: Graph(nodes),
        )
        self.warnings = []
        bridge = SimpleNamespace(
            publish_clock=lambda: None, publish=lambda _: None, warn=self.warnings.append
        )
        simulation = SimpleNamespace(time=1, tick=lambda: None)
        self.now = 0.0
        monkeypatch.setattr(follow, "time", SimpleNamespace(monotonic=lambda: self.now))
        monkeypatch.setattr(follow, "spin_once", self.spin)
        self.followers = follow.Followers(node, simulation, bridge)
        message = Header()
        message.frame_id = "/other"
        heard[0](message)

    def spin(self, _node, timeout):
        """Let time pass."""
        self.now += timeout

    def wait(self):
        """Wait for the follower, for five seconds at most."""
        self.followers.wait(lambda: self.now < 5.0)


@pytest.mark.parametrize("nodes", [(), (runs_as(NOBODY),)])
def test_a_follower_without_a_process_is_waited_for_no_longer(nodes, monkeypatch):
    leading = Leading(nodes, monkeypatch)
    leading.wait()
    assert leading.warnings == ["/other has ended: the simulation goes on without it"]
    assert leading.now < 2.0


def test_one_that_runs_is_waited_for_also_if_one_of_its_name_has_ended(monkeypatch):
    leading = Leading((runs_as(NOBODY), runs_as(os.getpid())), monkeypatch)
    leading.wait()
    assert leading.now >= 5.0
    assert leading.warnings == ["waiting for /other, which does nothing: is it paused or stopped?"]
