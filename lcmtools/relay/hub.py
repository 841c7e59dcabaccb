"""A server for LCM's provider tcpq, like lcm.jar's TCPService.

Each message goes to all clients with a pattern that matches its channel, including its sender. One
thread serves all clients and waits for none: data that a slow client does not accept wait for it,
up to a limit, and the newest reach it, those of channels with little data first (see
``fair_queue``). Messages that have waited for a second are dropped. A client that has received
nothing for that long is disconnected, discarding what the system would still send it: no command
arrives late.
"""

import contextlib
import errno
import re
import selectors
import socket
import struct
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import NoReturn

from lcmtools.bounded import MOST_ENTRIES, BoundedDict
from lcmtools.bus.kernel import is_unanswered, keep_little_waiting
from lcmtools.bus.line_buffer import LineBuffer
from lcmtools.bus.records import this_process
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, os_errors_as
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.full_line import LineRates
from lcmtools.graph.model import FullLine, Traffic
from lcmtools.graph.protocol import NODE_CHANNEL, PROTOCOL_CHANNELS, head_of
from lcmtools.observe.reading.presence import Presence
from lcmtools.relay.announcing import heard_of_programs
from lcmtools.relay.bulk_connection import BULK_BYTES
from lcmtools.relay.fair_queue import LATE, FairQueue
from lcmtools.text_table import plural
from lcmtools.wire import tcpq
from lcmtools.wire.channel_pattern import PatternError, compile_pattern
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.tcpq import Frame

_READ_BYTES = 1 << 18  # read from one client before it is the next one's turn
_MOST_WAITING = 32 << 20  # most bytes that wait for a client
_AT_ONCE = 4096  # bytes of frames that are passed to the system together
_MOST_CLIENTS = 500
_GREETING_TIME = 10.0  # [s] that a client has to send its greeting
_SAME = 20  # first characters of a reason that identify a fault
_CHECK_PERIOD = 0.25  # [s] between checks for clients that do not greet, or receive nothing
_AT_ONCE_GONE = struct.pack("ii", 1, 0)  # for SO_LINGER: discard unsent data
_TURN = 0.25  # [s]
_LOOK_PERIOD = 0.5  # [s] between two looks at which clients are nodes, and which are not
_NO_MORE = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


@dataclass(slots=True)
class HubCounts:
    """The counts of a hub since its start."""

    clients: int = 0  # connected now
    messages: int = 0  # received
    bytes: int = 0  # of their frames
    dropped: int = 0  # not delivered to slow clients


class _Client:  # one client: its connection, its patterns, and the frames that wait for it
    def __init__(self, connection: socket.socket, sender: Sender, now: float) -> None:
        self.connection = connection
        self.name = str(sender)
        self.sender = sender  # of its messages; for a second connection, that of the first one
        self.large: _Client | None = None  # its second connection, for large messages
        self.since = now
        self.reader = tcpq.FrameReader()
        self.patterns: dict[str, re.Pattern[str]] = {}
        self.times: Counter[str] = Counter()  # how often each pattern is subscribed to
        self.heard = now  # the last time that it may have received something
        self.counted = 0  # dropped messages that the hub has counted
        self.buffer = LineBuffer(connection)
        self._waiting: FairQueue[bytes] = FairQueue(_MOST_WAITING)
        self._rates = LineRates()
        self.is_blocked = False  # True if the connection must accept more before anything is sent
        self._begun = [memoryview(tcpq.SERVER_GREETING)]  # frames that must be sent to their ends

    @property
    def is_waiting(self) -> bool:
        """True if something waits to be sent."""
        return bool(self._begun or self._waiting)

    @property
    def dropped(self) -> int:
        """The number of messages dropped for it so far."""
        return self._waiting.dropped

    def full_line(self, now: float) -> FullLine | None:
        """Return its connection if that takes less than it gets; None if it takes all."""
        waiting = self._waiting
        rates = self._rates.update(waiting.passed_of, waiting.dropped_of, now)
        return FullLine(self.name, self.dropped, tuple(rates.items())) if rates else None

    def matches(self, channel: str) -> bool:
        """Return whether it subscribes to a channel."""
        return any(pattern.fullmatch(channel) for pattern in self.patterns.values())

    def subscribe(self, pattern: str) -> None:
        """Add a pattern; PatternError is raised if it cannot be parsed."""
        if pattern not in self.patterns:
            self.patterns[pattern] = compile_pattern(pattern)
        self.times[pattern] += 1

    def unsubscribe(self, pattern: str) -> None:
        """Undo ``subscribe`` once."""
        self.times[pattern] -= 1
        if self.times[pattern] <= 0:
            del self.times[pattern]
            self.patterns.pop(pattern, None)

    def add(self, frame: Frame, now: float) -> None:
        """Queue a message's frame."""
        self._waiting.add(frame.name, frame.data, len(frame.data), now + LATE, now)

    def drop_late(self, now: float) -> None:
        """Drop what has waited for too long."""
        self._waiting.drop_outdated(now)

    def send(self, now: float) -> None:
        """Send as much as the connection accepts.

        OSError is raised if the connection is broken.
        """
        self.buffer.adjust(self.connection, now)
        most = self.buffer.piece_bytes
        with contextlib.suppress(BlockingIOError):
            while most > 0 and (self._begun or self._begin(now)):
                whole = len(self._begun) > 1 and sum(map(len, self._begun)) <= most
                sent = self.connection.sendmsg(self._begun if whole else [self._begun[0][:most]])
                most -= sent
                self._forget(sent)
        self.is_blocked = self.is_waiting

    def _forget(self, sent: int) -> None:
        while self._begun and sent >= len(self._begun[0]):
            sent -= len(self._begun.pop(0))
        if sent:
            self._begun[0] = self._begun[0][sent:]

    def _begin(self, now: float) -> bool:
        """Take frames to send next; return whether there are any."""
        self._begun = [memoryview(frame) for frame in self._waiting.pop(now, _AT_ONCE)]
        return bool(self._begun)


class Hub(AbstractContextManager["Hub"]):
    """A server; ``turn`` does its work.

    ``notify`` is called with a sentence when a client is disconnected or loses messages.

    Raises:
        BusError: The address cannot be used.
    """

    def __init__(self, url: BusUrl, notify: Callable[[str], None]) -> None:
        self._notify = notify
        self._listener = _listen(url)
        # The port of its address, even if 0 was requested.
        self.port = int(self._listener.getsockname()[1])
        self.counts = HubCounts()
        self._clients: dict[socket.socket, _Client] = {}
        self._receivers = BoundedDict[str, list[_Client]]()
        self._large = BoundedDict[str, bool]()  # channels that have had large messages
        self._changed: set[_Client] = set()
        self._said = BoundedDict[tuple[str, str], bool]()
        self._next_check = 0.0
        self._builder = GraphBuilder()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ)

    def __exit__(self, *_: object) -> None:
        """Close all connections."""
        for client in list(self._clients.values()):
            with contextlib.suppress(OSError):
                client.send(time.monotonic())
            client.connection.close()
        self._clients.clear()
        self._selector.close()
        self._listener.close()

    def turn(self, timeout: float) -> list[Frame]:
        """Do pending work, waiting up to ``timeout`` [s] for it; return the messages received.

        They are already on their way to the clients.
        """
        messages: list[Frame] = []
        for key, events in self._selector.select(timeout):
            client = self._clients.get(key.fileobj)  # type: ignore[call-overload] # a socket
            if key.fileobj is self._listener:
                self._accept()
            elif client is not None:
                if events & selectors.EVENT_WRITE:
                    client.is_blocked = False
                    self._changed.add(client)
                if events & selectors.EVENT_READ:
                    messages += self._serve(client)
        self._send()
        if time.monotonic() >= self._next_check:
            self._check(time.monotonic())
        return messages

    def observed(self) -> tuple[Traffic, ...]:
        """Return the messages of clients that are not nodes."""
        graph = self._builder.snapshot(time.time_ns())
        here = {one.sender for one in self._clients.values()}
        traffic = tuple(seen for seen in graph.traffic if seen.sender in here)
        return tuple(heard_of_programs(graph._replace(traffic=traffic)))

    def full_lines(self, now: float) -> tuple[FullLine, ...]:
        """Return the connections that take less than they get; ``now`` is monotonic [s]."""
        return tuple(line for one in self._clients.values() if (line := one.full_line(now)))

    def publish(self, channel: str, payload: bytes) -> None:
        """Send one of the hub's own messages to the clients."""
        self._pass(Frame(tcpq.PUBLISH, channel, tcpq.publish_frame(channel, payload)))
        self._send()

    def _accept(self) -> None:
        try:
            connection, (address, port, *_) = self._listener.accept()
        except OSError as error:
            if error.errno in _NO_MORE:
                self._say("", "full", f"no more clients are possible: {error.strerror}")
                time.sleep(0.01)  # the client still waits to be accepted
            return
        if len(self._clients) >= _MOST_CLIENTS:
            connection.close()
            self._say("", "full", f"{_MOST_CLIENTS} clients are connected; more are refused")
            return
        connection.setblocking(False)  # noqa: FBT003 - the socket module's own
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        keep_little_waiting(connection)
        client = _Client(connection, Sender(address, port), time.monotonic())
        self._clients[connection] = client
        self.counts.clients = len(self._clients)
        self._selector.register(connection, selectors.EVENT_READ)
        self._changed.add(client)

    def _serve(self, client: _Client) -> Iterator[Frame]:
        try:
            data = client.connection.recv(_READ_BYTES)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._close(client)
            return
        now = time.time_ns()
        try:
            for frame in client.reader.read(data):
                if frame.kind == tcpq.PUBLISH:
                    self._observe(frame, client.sender, now)
                    self.counts.messages += 1
                    self.counts.bytes += len(frame.data)
                    self._pass(frame)
                    yield frame
                else:
                    self._subscribe(client, frame)
        except tcpq.StreamError as error:
            self._close(client, error.what)

    def _observe(self, frame: Frame, sender: Sender, now: int) -> None:
        packet = Packet(frame.name, tcpq.payload_of(frame), now, sender)
        if frame.name == NODE_CHANNEL:
            self._builder.add_head(head_of(packet.payload), packet)
        else:
            self._builder.add(packet)

    def _subscribe(self, client: _Client, frame: Frame) -> None:
        self._receivers.clear()
        if frame.name.startswith(tcpq.LARGE):
            self._pair(client, frame.name.removeprefix(tcpq.LARGE))
            return
        if frame.kind != tcpq.SUBSCRIBE:
            client.unsubscribe(frame.name)
            return
        if len(client.patterns) >= MOST_ENTRIES:
            raise tcpq.StreamError(f"it has more than {MOST_ENTRIES} subscriptions")
        try:
            client.subscribe(frame.name)
        except PatternError as error:  # its other subscriptions may be valid
            text = f"a subscription of {client.name} receives nothing: {error.what}"
            self._say(client.name, frame.name, text)

    def _pair(self, client: _Client, first: str) -> None:
        """Let a client's second connection get its large messages."""
        if first.rpartition(":")[0] == client.name.rpartition(":")[0]:
            for other in self._clients.values():
                if other.name == first and other is not client:
                    other.large, client.sender = client, other.sender

    def _receivers_of(self, channel: str) -> list[_Client]:
        found = [one for one in self._clients.values() if one.matches(channel)]
        return [one.large or one for one in found] if channel in self._large else found

    def _pass(self, message: Frame) -> None:
        if len(message.data) > BULK_BYTES and message.name not in self._large:
            self._large[message.name] = True
            self._receivers.pop(message.name, None)
        receivers = self._receivers.use(message.name)
        if receivers is None:
            receivers = self._receivers[message.name] = self._receivers_of(message.name)
        now = time.monotonic()
        for client in receivers:
            client.add(message, now)
            self._count(client)
        self._changed.update(receivers)

    def _count(self, client: _Client) -> None:
        """Count what was dropped for a client since the last time."""
        if client.dropped > client.counted:
            self.counts.dropped += client.dropped - client.counted
            client.counted = client.dropped
            slow = f"{client.name} reads too slowly; its oldest messages are dropped"
            self._say(client.name, "slow", slow)

    def _send(self) -> None:
        changed, self._changed = self._changed, set()
        for client in changed:
            if client.is_blocked or client.connection not in self._clients:
                continue
            try:
                client.send(time.monotonic())
            except OSError:
                self._close(client)
                continue
            self._count(client)
            wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.is_waiting else 0)
            self._selector.modify(client.connection, wanted)

    def _check(self, now: float) -> None:
        self._next_check = now + _CHECK_PERIOD
        for client in list(self._clients.values()):
            client.drop_late(now)
            self._count(client)
            if not client.reader.is_greeted and now - client.since > _GREETING_TIME:
                self._close(client, f"it sent nothing for {_GREETING_TIME:g} s")
            elif not is_unanswered(client.connection):
                client.heard = now
            elif now - client.heard > LATE:
                linger = socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE_GONE
                client.connection.setsockopt(*linger)
                self._close(client, f"it has received nothing for {LATE:g} s")

    def _close(self, client: _Client, reason: str = "") -> None:
        self._selector.unregister(client.connection)
        client.connection.close()
        del self._clients[client.connection]
        for other in self._clients.values():
            if other.large is client:
                other.large = None
        self._receivers.clear()
        self.counts.clients = len(self._clients)
        if reason:
            key = (client.name.rpartition(":")[0], reason[:_SAME])
            self._say(*key, f"closed {client.name}: {reason}")
        if client.dropped:
            self._notify(
                f"{client.name} lost {plural(client.dropped, 'message')} by reading too slowly"
            )

    def _say(self, who: str, what: str, text: str) -> None:
        """Notify once about each client's fault: a broken client tries again and again."""
        if (who, what) not in self._said:
            self._said[who, what] = True
            self._notify(text)


def _listen(url: BusUrl) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    with contextlib.ExitStack() as stack:
        stack.enter_context(listener)  # closed on an error
        with os_errors_as(f"cannot serve {url}", kind=BusError):
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind((url.host, url.port))
            listener.listen(128)
            listener.setblocking(False)  # noqa: FBT003 - the socket module's own
        stack.pop_all()
    return listener


def serve(
    hub: Hub, on_turn: Callable[[HubCounts], None], on_shutdown: Callable[[], None]
) -> NoReturn:
    """Serve until an exception ends it; meanwhile, the hub announces itself to its clients.

    ``on_turn`` is called several times a second; ``on_shutdown`` when another program requests this
    one to end.
    """
    presence = Presence(
        this_process(f"/tcpq_server_{hub.port}", tool=False), hub.publish, on_shutdown
    )
    next_look = 0.0
    try:
        while True:
            presence.attend()
            if (now := time.monotonic()) >= next_look:
                next_look = now + _LOOK_PERIOD
                presence.tell(hub.observed(), hub.full_lines(now))
            for frame in hub.turn(_TURN):
                if frame.name in PROTOCOL_CHANNELS:
                    presence.answer(frame.name, tcpq.payload_of(frame))
            on_turn(hub.counts)
    finally:
        presence.announce(leaving=True)
