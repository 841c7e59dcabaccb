"""What the tests with real buses share: a server for tcpq."""

import re
import socket
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress

import pytest


class TcpqServer:
    """What liblcm's tcpq provider talks to, as the TCPService of lcm.jar does it.

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
