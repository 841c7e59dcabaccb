"""Fixtures of the tests with real buses: a server for tcpq."""

import itertools
import os
import pty
import subprocess
import sys
import time

import pytest
from fixtures import tcpq_server_program
from fixtures.window import LiveWindow

from lcmtools import Node
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import message_class
from lcmtools.types.std_msgs import UInt64


class TcpqServer:
    """A tcpq server in a process of its own: liblcm may wait for it with Python's lock in hand.

    Attributes:
        url: Its address.
    """

    def __init__(self):
        self._process = subprocess.Popen(
            [sys.executable, tcpq_server_program.__file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.url = self._answer()

    def close(self):
        """Drop all connections, as a server that crashes does."""
        assert self._order("close") == "None"

    def reopen(self):
        """Be there again, at the same address, and know nothing of before."""
        assert self._order("reopen") == "None"

    def end(self):
        """End the process."""
        self._process.communicate(timeout=40)

    @property
    def patterns(self):
        """The number of patterns that clients have subscribed to."""
        return int(self._order("patterns"))

    def _order(self, what):
        assert self._process.stdin
        self._process.stdin.write(f"{what}\n")
        self._process.stdin.flush()
        return self._answer()

    def _answer(self):
        assert self._process.stdout
        return self._process.stdout.readline().strip()


@pytest.fixture
def tcpq_server():
    """A tcpq server of this test's own."""
    server = TcpqServer()
    yield server
    server.end()


class Receiver:
    """A node of the test's process that keeps what it receives.

    Args:
        start_node: The fixture of this name.
        name: The node's name.
    """

    def __init__(self, start_node, name="receiver"):
        self._start_node = start_node
        self._names = (f"{name}{number}" for number in itertools.count(2))
        self.node = node = start_node(lambda: Node(name)).node
        self._marks = []
        self._mark = node.create_publisher(UInt64, "~mark")
        node.create_subscription(UInt64, "~mark", lambda m: self._marks.append(m.data))

    def subscribe(self, topic, kind="std_msgs/String"):
        """Subscribe to a topic; the result gives all messages of it since, as plain values."""
        self._pass_mark()  # messages sent before may still wait in this node's socket
        found = []
        take = self.node.create_subscription
        take(message_class(kind), topic, lambda message: found.append(to_plain(message)), 1000)

        def messages():
            for _ in range(2):  # the second mark is dealt with after all that came with the first
                self._pass_mark()
            return found

        return messages

    def forget(self, topic):
        """Subscribe to a topic no more."""
        for subscription in tuple(self.node.callbacks.subscriptions):
            if subscription.topic == topic:
                self.node.destroy_subscription(subscription)

    def another(self):
        """Return one more node, which leaves as this one does."""
        return Receiver(self._start_node, next(self._names))

    def _pass_mark(self):
        number = len(self._marks)
        self._mark.publish(UInt64())
        deadline = time.monotonic() + 40.0
        while len(self._marks) == number:
            assert time.monotonic() < deadline, "a message to itself does not come"
            time.sleep(0.002)


@pytest.fixture(scope="module")
def receiver(module_start_node):
    """A node on the module's bus that keeps what it receives."""
    return Receiver(module_start_node)


@pytest.fixture
def on_terminal(lcmtools_path):
    """``on_terminal("list", TERM="xterm")``: what a command writes where all is a terminal."""

    def run(*arguments, **environment):
        ours, theirs = pty.openpty()
        process = subprocess.Popen(
            [lcmtools_path, *arguments],
            env={**os.environ, "TERM": "xterm-256color", **environment},
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
        )
        os.close(theirs)
        text = b""
        try:
            while part := os.read(ours, 4096):
                text += part
        except OSError:  # Linux says so that the other side has closed
            pass
        os.close(ours)
        process.wait(40)
        return text.decode()

    return run


@pytest.fixture
def bus(bus_url):
    """A connection to the test's bus."""
    bus = UdpBus(parse_url(bus_url))
    yield bus
    bus.close()


@pytest.fixture
def other(bus_url):
    """A second connection to the same bus."""
    bus = UdpBus(parse_url(bus_url))
    yield bus
    bus.close()


@pytest.fixture
def on_bus(bus_url, monkeypatch):
    """A bus of the test's own, for everything that it starts."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


@pytest.fixture
def node(start, cli, lcmtools_path, wait_until):
    """``node("talker", "__ns:=/a")``: a node that runs and is listed."""

    def run(*words):
        program = start(lcmtools_path, "run", *words)
        wait_until(lambda: f'"pid": {program.pid},' in cli("node", "list", "--json").out)
        return program

    return run


@pytest.fixture
def open_window(bus_url):
    """A server of the window on the test's bus."""
    windows = []

    def run(host=None, **options):
        windows.append(LiveWindow(bus_url, host, **options))
        return windows[-1]

    yield run
    for window in windows:
        window.end()
