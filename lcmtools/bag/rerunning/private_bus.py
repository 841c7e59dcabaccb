"""A bus that only the programs under test are connected to: a tcpq server without rules of its own.

A process that was not started with its URL is refused.
It passes nothing on: its user sends each message to the clients that it chooses, and gets what they
publish, each client's in order, without loss. Must not know logs or processes.
"""

import contextlib
import re
import selectors
import socket
from collections.abc import Iterator
from contextlib import AbstractContextManager
from os import getpid
from typing import NamedTuple

from lcmtools.bus.sockets import tcp_holders
from lcmtools.wire import tcpq
from lcmtools.wire.channel_pattern import PatternError, compile_pattern

_READ_BYTES = 1 << 18
_QUICKACK = getattr(socket, "TCP_QUICKACK", None)


class Client:
    """A connection of a program; ``name`` is that of its first node, once that is announced."""

    def __init__(self, connection: socket.socket, number: int) -> None:
        self.connection, self.number = connection, number
        self.name = ""
        self.patterns: dict[str, re.Pattern[str]] = {}
        self.reader = tcpq.FrameReader()
        self._known: dict[str, bool] = {}
        self._unsent = bytearray(tcpq.SERVER_GREETING)

    @property
    def order(self) -> tuple[str, int]:
        """The order of clients, which is the same in each run if their nodes have names."""
        return self.name, self.number

    def wants(self, channel: str) -> bool:
        """Return whether it subscribes to a channel."""
        known = self._known.get(channel)
        if known is None:
            found = any(pattern.fullmatch(channel) for pattern in self.patterns.values())
            known = self._known[channel] = found
        return known

    def change(self, frame: tcpq.Frame) -> None:
        """Subscribe, or unsubscribe."""
        self._known.clear()
        if frame.kind == tcpq.UNSUBSCRIBE:
            self.patterns.pop(frame.name, None)
        else:
            with contextlib.suppress(PatternError):  # it receives nothing by that
                self.patterns[frame.name] = compile_pattern(frame.name)

    def send(self, data: bytes = b"") -> bool:
        """Send as much as the connection accepts; return True if nothing waits.

        OSError is raised if the connection is broken.
        """
        self._unsent += data
        with contextlib.suppress(BlockingIOError):
            while self._unsent:
                del self._unsent[: self.connection.send(self._unsent)]
        return not self._unsent


class Published(NamedTuple):
    """A message of a client."""

    client: Client
    channel: str
    payload: bytes


class PrivateBus(AbstractContextManager["PrivateBus"]):
    """The server, on a free port of the loopback."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.setblocking(False)  # noqa: FBT003 - the socket module's own
        self.url = f"tcpq://127.0.0.1:{self._listener.getsockname()[1]}"
        self.clients: list[Client] = []
        self.count = 0  # clients that have ever connected
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ)

    def __exit__(self, *_: object) -> None:
        """Close all connections."""
        for client in self.clients:
            client.connection.close()
        self._selector.close()
        self._listener.close()

    def send(self, client: Client, data: bytes) -> None:
        """Send frames to a client, later if it does not read now; nothing if it has gone."""
        if client not in self.clients:
            return
        try:
            is_sent = client.send(data)
        except OSError:
            self._close(client)
            return
        events = selectors.EVENT_READ | (0 if is_sent else selectors.EVENT_WRITE)
        if self._selector.get_key(client.connection).events != events:
            self._selector.modify(client.connection, events, client)

    def turn(self, timeout: float | None) -> list[Published]:
        """Wait for messages, for ``timeout`` [s] at most, and return them; do what is due."""
        found: list[Published] = []
        for key, events in self._selector.select(timeout):
            client = key.data
            if client is None:
                self._accept()
                continue
            if events & selectors.EVENT_WRITE:
                self.send(client, b"")
            if events & selectors.EVENT_READ and client in self.clients:
                found += self._read(client)
        return found

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            connection, (_, port) = self._listener.accept()
            if self._is_stranger(port):
                connection.close()
                return
            connection.setblocking(False)  # noqa: FBT003 - the socket module's own
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            client = Client(connection, self.count)
            self.count += 1
            self.clients.append(client)
            self._selector.register(connection, selectors.EVENT_READ, client)
            self.send(client, b"")

    def _is_stranger(self, port: int) -> bool:
        """Return whether a port is of a process that was not given the URL.

        One that the system does not show, as in a container, is taken for a program's.
        """
        holders = tcp_holders(port, self._listener.getsockname()[1])
        told = (one.pid == getpid() or one.was_told(self.url) for one in holders)
        return bool(holders) and not any(told)

    def _read(self, client: Client) -> Iterator[Published]:
        try:
            data = client.connection.recv(_READ_BYTES)
            if _QUICKACK is not None:  # liblcm sends a frame in pieces, each after the last's ACK
                client.connection.setsockopt(socket.IPPROTO_TCP, _QUICKACK, 1)
            frames = list(client.reader.read(data))
        except BlockingIOError:
            return
        except (OSError, tcpq.StreamError):
            data, frames = b"", []
        if not data:
            self._close(client)
        for frame in frames:
            if frame.kind == tcpq.PUBLISH:
                yield Published(client, frame.name, tcpq.payload_of(frame))
            else:
                client.change(frame)

    def _close(self, client: Client) -> None:
        self._selector.unregister(client.connection)
        client.connection.close()
        self.clients.remove(client)
