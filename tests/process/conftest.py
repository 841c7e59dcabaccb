"""Fixtures of the tests with real buses: a server for tcpq."""

import itertools
import os
import pty
import re
import socket
import struct
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import pytest

from lcmtools import Node
from lcmtools.bus.lcm_bus import LcmBus
from lcmtools.bus.url import parse_url
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import message_class
from lcmtools.types.std_msgs import UInt64


class TcpqServer:
    """The server of liblcm's tcpq provider, as the TCPService of lcm.jar does it.

    Both sides start with a greeting; then a client sends frames: publish (1), subscribe (2) and
    unsubscribe (3), each with a channel, or a pattern, and publish with a payload too.
    """

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcpq://127.0.0.1:{self._listener.getsockname()[1]}"
        self._clients: dict[socket.socket, list[str]] = {}
        self._lock = threading.Lock()
        self._spawn(self._accept)

    def close(self) -> None:
        """Drop all connections, as a server that crashes does."""
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        with self._lock:
            for client in self._clients:
                with suppress(OSError):  # gone already
                    client.shutdown(socket.SHUT_RDWR)

    def reopen(self) -> None:
        """Be there again, at the same address, and know nothing of before."""
        port = int(self.url.rpartition(":")[2])
        self._listener = socket.create_server(("127.0.0.1", port))
        self._spawn(self._accept)

    def _accept(self) -> None:
        listener = self._listener
        while True:
            try:
                client, _ = listener.accept()
            except OSError:
                return
            with self._lock:
                self._clients[client] = []
            self._spawn(self._serve, client)

    def _serve(self, client: socket.socket) -> None:
        with client, client.makefile("rb") as stream:
            try:
                stream.read(8)
                client.sendall(struct.pack(">II", 0x287617FA, 0x0100))
                while head := stream.read(8):
                    kind, size = struct.unpack(">II", head)
                    self._take(client, kind, stream.read(size), stream)
            except (OSError, struct.error):
                pass
            with self._lock:
                del self._clients[client]

    def _take(self, client: socket.socket, kind: int, channel: bytes, stream: object) -> None:
        patterns = self._clients[client]
        assert kind in (1, 2, 3), "the frames of two threads are mixed"
        if kind == 2:
            patterns.append(channel.decode())
        elif kind == 3:
            patterns.remove(channel.decode())
        else:
            (size,) = struct.unpack(">I", stream.read(4))
            payload = stream.read(size)
            head = struct.pack(">II", 1, len(channel)) + channel + struct.pack(">I", size)
            with self._lock:
                for other, wanted in self._clients.items():
                    if any(re.fullmatch(pattern, channel.decode()) for pattern in wanted):
                        other.sendall(head + payload)

    @staticmethod
    def _spawn(target: Callable[..., None], *arguments: object) -> None:
        threading.Thread(target=target, args=arguments, daemon=True).start()


@pytest.fixture
def tcpq_server() -> Iterator[TcpqServer]:
    """A tcpq server of this test's own."""
    server = TcpqServer()
    yield server
    try:
        server.close()
    except OSError:
        return  # the test has done it


class Receiver:
    """A node of the test's process that keeps what it receives.

    Args:
        start_node: The fixture of this name.
        name: The node's name.
    """

    def __init__(self, start_node: Callable[..., Any], name: str = "receiver") -> None:
        self._start_node = start_node
        self._names = (f"{name}{number}" for number in itertools.count(2))
        self.node = node = start_node(lambda: Node(name)).node
        self._marks: list[int] = []
        self._mark = node.create_publisher(UInt64, "~mark")
        node.create_subscription(UInt64, "~mark", lambda m: self._marks.append(m.data))

    def subscribe(self, topic: str, kind: str = "std_msgs/String") -> Callable[[], list[Any]]:
        """Subscribe to a topic; the result gives all messages of it since, as plain values."""
        self._pass_mark()  # messages sent before may still wait in this node's socket
        found: list[Any] = []
        take = self.node.create_subscription
        take(message_class(kind), topic, lambda message: found.append(to_plain(message)), 1000)

        def messages() -> list[Any]:
            for _ in range(2):  # the second mark is dealt with after all that came with the first
                self._pass_mark()
            return found

        return messages

    def forget(self, topic: str) -> None:
        """Subscribe to a topic no more."""
        for subscription in tuple(self.node.callbacks.subscriptions):
            if subscription.topic == topic:
                self.node.destroy_subscription(subscription)

    def another(self) -> "Receiver":
        """Return one more node, which leaves as this one does."""
        return Receiver(self._start_node, next(self._names))

    def _pass_mark(self) -> None:
        number = len(self._marks)
        self._mark.publish(UInt64())
        deadline = time.monotonic() + 40.0
        while len(self._marks) == number:
            assert time.monotonic() < deadline, "a message to itself does not come"
            time.sleep(0.002)


@pytest.fixture(scope="module")
def receiver(module_start_node: Callable[..., Any]) -> Receiver:
    """A node on the module's bus that keeps what it receives."""
    return Receiver(module_start_node)


@pytest.fixture
def on_terminal(lcmtools_path: str) -> Callable[..., str]:
    """``on_terminal("list", TERM="xterm")``: what a command writes where all is a terminal."""

    def run(*arguments: str, **environment: str) -> str:
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
def bus(bus_url: str) -> Iterator[LcmBus]:
    """A connection to the test's bus."""
    bus = LcmBus(parse_url(bus_url))
    yield bus
    bus.close()


@pytest.fixture
def other(bus_url: str) -> Iterator[LcmBus]:
    """A second connection to the same bus."""
    bus = LcmBus(parse_url(bus_url))
    yield bus
    bus.close()
