"""The tcpq server: what LCM's own programs, nodes and commands get of it."""

import json
import signal
import socket
import struct
import threading
from contextlib import suppress

import lcm
import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError
from lcmtools.labs.nodes.talker import Talker
from lcmtools.relay.hub import Hub, serve
from lcmtools.wire.tcpq import (
    CLIENT_GREETING,
    LARGE,
    SERVER_GREETING,
    publish_frame,
    subscribe_frame,
)


class _EndError(Exception):
    """The test is over."""


class RunningHub:
    """A server on a thread of the test.

    Attributes:
        url: Its address.
        said: What it has said.
    """

    def __init__(self, port=0):
        self.said = []
        self._hub = Hub(parse_url("tcpq://")._replace(port=port), self.said.append)
        self.url = f"tcpq://127.0.0.1:{self._hub.port}"
        self.counts = self._hub.counts
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def connect(self):
        """A client of bytes, before its greeting."""
        return socket.create_connection(("127.0.0.1", self._hub.port), timeout=40)

    def end(self):
        """End it."""
        self._ends.set()
        self._thread.join()

    def _run(self):
        with self._hub, pytest.raises(_EndError):
            serve(self._hub, self._check, lambda: None)

    def _check(self, _counts):
        if self._ends.is_set():
            raise _EndError


@pytest.fixture
def hub(monkeypatch):
    """A server of this test's own, for which nothing is late, however busy the computer is."""
    monkeypatch.setattr("lcmtools.relay.hub.LATE", 3600.0)
    running = RunningHub()
    yield running
    running.end()


class Client:
    """A plain LCM program's connection, with the messages of a pattern."""

    def __init__(self, url, pattern):
        self.heard = []
        self.bus = lcm.LCM(url)
        self._subscription = self.bus.subscribe(pattern, self._hear)
        self._subscription.set_queue_capacity(0)
        self.ready()

    def ready(self):
        """Return when the server has its subscriptions."""
        mark = self.bus.subscribe("MARK", lambda *_: marks.append(1))
        marks = []
        self.bus.publish("MARK", b"")
        while not marks:
            self.bus.handle_timeout(40_000)
        self.bus.unsubscribe(mark)

    def _hear(self, channel, payload):
        if channel != "MARK" and not channel.startswith("/_lcmtools/"):
            self.heard.append((channel, payload))

    def stop(self):
        """Unsubscribe."""
        self.bus.unsubscribe(self._subscription)
        self.ready()

    def hear(self, count):
        """The messages, once there are so many."""
        while len(self.heard) < count:
            assert self.bus.handle_timeout(40_000), self.heard[-3:]
        return self.heard


def test_plain_programs_get_what_their_patterns_match(hub):
    every, some, sender = (Client(hub.url, pattern) for pattern in (".*", "/a/[^/]*", "none"))
    for channel in ("/a/b", "/a/b/c", "B", "/a/end"):
        sender.bus.publish(channel, channel.encode())
    assert [channel for channel, _ in some.hear(2)] == ["/a/b", "/a/end"]
    wanted = ["/a/b", "/a/b/c", "B", "/a/end"]
    assert every.hear(4) == [(channel, channel.encode()) for channel in wanted]


def test_a_program_hears_itself_and_no_more_after_it_unsubscribes(hub):
    client = Client(hub.url, "A")
    client.bus.publish("A", b"1")
    assert client.hear(1) == [("A", b"1")]
    client.stop()
    client.bus.publish("A", b"2")
    client.ready()
    assert client.heard == [("A", b"1")]


def test_large_messages_arrive_whole_and_in_order(hub):
    listener, sender = Client(hub.url, "A"), Client(hub.url, "none")
    sent = [bytes([number]) * size for number, size in enumerate((8_000_000, 1, 8_000_000, 0))]
    for payload in sent:
        sender.bus.publish("A", payload)
    assert [payload for _, payload in listener.hear(4)] == sent


def test_a_client_that_does_not_read_delays_nobody_and_gets_the_newest(hub, wait_until):
    with hub.connect() as slow:
        slow.sendall(CLIENT_GREETING + subscribe_frame("A"))
        quick, sender = Client(hub.url, "A"), Client(hub.url, "none")
        for number in range(60):
            sender.bus.publish("A", number.to_bytes(4, "big") + bytes(1_000_000))
            assert len(quick.hear(number + 1)) == number + 1
        assert hub.counts.dropped > 0
        received = _frames(slow, last=59)
    assert received == sorted(received)
    assert len(received) == 60 - hub.counts.dropped
    wait_until(lambda: len(hub.said) == 2)
    assert_says(hub.said[0], "too slowly", "dropped")
    assert_says(hub.said[1], f"lost {hub.counts.dropped} messages", "too slowly")


def test_large_messages_come_on_a_second_connection_of_the_client(hub, wait_until):
    first, second, sender = (hub.connect() for _ in range(3))
    with first, second, sender:
        first.sendall(CLIENT_GREETING + subscribe_frame(".*"))
        own = "{}:{}".format(*first.getsockname())
        second.sendall(CLIENT_GREETING + subscribe_frame(LARGE + own))
        for client in (first, second):
            assert client.recv(len(SERVER_GREETING), socket.MSG_WAITALL) == SERVER_GREETING
            client.settimeout(0.0)
        sender.sendall(CLIENT_GREETING)
        small, large = publish_frame("small", b"x"), publish_frame("large", bytes(5000))

        def comes(frame, client):
            sender.sendall(frame)
            with suppress(BlockingIOError):
                return client.recv(1 << 20).startswith(frame[:20])
            return False

        wait_until(lambda: comes(large, second))  # both subscriptions have arrived
        with suppress(BlockingIOError):
            first.recv(1 << 20)  # large ones from before
        wait_until(lambda: comes(small, first))
        second.close()
        wait_until(lambda: comes(large, first))


def test_messages_that_waited_for_a_client_for_a_second_are_dropped(hub, wait_until, monkeypatch):
    monkeypatch.setattr("lcmtools.relay.hub.LATE", 1.0)
    with hub.connect() as slow:
        slow.sendall(CLIENT_GREETING + subscribe_frame("A"))
        sender = Client(hub.url, "none")
        for _ in range(20):  # more than the system takes for it, less than may wait
            sender.bus.publish("A", bytes(1_000_000))
        wait_until(lambda: sender.bus.publish("A", b"") or hub.counts.dropped)


def _frames(connection, last):
    """The numbers at the beginning of the messages that come, up to one."""
    found = []
    with connection.makefile("rb") as stream:
        assert stream.read(8) == SERVER_GREETING
        while last not in found:
            _, size = struct.unpack(">II", stream.read(8))
            stream.read(size)
            payload = stream.read(struct.unpack(">I", stream.read(4))[0])
            found.append(int.from_bytes(payload[:4], "big"))
    return found


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"GET / HTTP/1.0\r\n\r\n", "it does not speak tcpq, it begins with b'GET / HT'"),
        (CLIENT_GREETING + b"\0\0\0\x09\0\0\0\x01", "it sent a frame of the unknown kind 9"),
        (CLIENT_GREETING + struct.pack(">II", 1, 1 << 30), "it sent a name of 1073741824 bytes"),
    ],
)
def test_a_hostile_client_is_closed_with_one_line(hub, data, reason):
    good = Client(hub.url, "A")
    for _ in range(3):
        with hub.connect() as hostile:
            hostile.sendall(data)
            with hostile.makefile("rb") as stream:
                assert stream.read() == SERVER_GREETING
    assert len(hub.said) == 1
    assert hub.said[0].startswith("closed 127.0.0.1:")
    assert hub.said[0].endswith(f": {reason}")
    good.bus.publish("A", b"1")
    assert good.hear(1) == [("A", b"1")]


def test_a_pattern_that_cannot_be_read_leaves_the_others(hub):
    with hub.connect() as client:
        client.sendall(CLIENT_GREETING + subscribe_frame("(a*)*b") + subscribe_frame("A"))
        client.sendall(publish_frame("A", bytes(4)))
        assert _frames(client, last=0) == [0]
    assert_says(hub.said[0], "receives nothing", "'(a*)*b'", "too long to match")


def test_half_a_frame_and_a_sudden_end_harm_nobody(hub):
    good = Client(hub.url, "A")
    for data in (b"", CLIENT_GREETING[:3], CLIENT_GREETING + publish_frame("A", bytes(99))[:50]):
        broken = hub.connect()
        broken.sendall(data)
        broken.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        broken.close()  # with a reset
    good.bus.publish("A", b"1")
    assert good.hear(1) == [("A", b"1")]


def test_a_taken_port_is_one_line(hub):
    with raises_saying(BusError, "tcpq://127.0.0.1:", "Address already in use"):
        Hub(parse_url(hub.url), print)


def test_nodes_and_commands_work_on_it(hub, cli, start_node):
    start_node(Talker, url=hub.url)
    env = {"LCM_DEFAULT_URL": hub.url}
    assert "/chatter" in cli("list", env=env).out
    rows = cli("node", "list", env=env).out.splitlines()
    assert [row for row in rows if "tcpq_server" in row] == [f"/tcpq_server_{hub.url[17:]}"]
    assert cli("echo", "/chatter", "-n", "1", env=env).out.startswith("data:")
    called = cli("node", "info", "talker", "--json", env=env)
    assert [one["node"] for one in json.loads(called.out)] == ["/talker"]


def test_programs_connect_again_to_a_server_that_is_back(start, lcmtools_path):
    first = RunningHub()
    port = int(first.url.rpartition(":")[2])
    listener = start(lcmtools_path, "run", "listener", LCM_DEFAULT_URL=first.url)
    talker = start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=first.url)
    listener.wait_for("heard")
    first.end()
    for node in (listener, talker):
        node.wait_for("is lost; it is tried again until it is back")
    second = RunningHub(port)
    try:
        for node in (listener, talker):
            node.wait_for("is back")
        listener.wait_for("heard")
    finally:
        second.end()
    for node in (listener, talker):
        for words in ("LCM tcpq: connecting", "_recv_fully"):  # liblcm's own
            assert words not in node.output


def test_the_command_says_what_it_opens_and_ends_by_ctrl_c(start, lcmtools_path):
    with socket.create_server(("127.0.0.1", 0)) as reserved:
        port = reserved.getsockname()[1]
    program = start(lcmtools_path, "relay", "--serve", f"tcpq://:{port}")
    program.wait_for(f"serves tcpq://127.0.0.1:{port} to programs on this computer")
    program.wait_for(f"to join another bus to it: lcmtools relay tcpq://127.0.0.1:{port}")
    client = Client(f"tcpq://127.0.0.1:{port}", "A")
    client.bus.publish("A", b"1")
    client.hear(1)
    program.send_signal(signal.SIGINT)
    assert program.wait() == 130
    assert "messages (" in program.lines[-1]
    assert "none dropped" in program.lines[-1]
