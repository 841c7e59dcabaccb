"""Large messages: that they arrive, and that they are to the byte what liblcm would have sent."""

import hashlib
import random
import signal
import socket
import time
from contextlib import closing, contextmanager

import lcm
import pytest
from fixtures.says import raises_saying

from lcmtools.bus.kernel import IS_LINUX
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.udp_sender import PACED_ABOVE_BYTES, UdpSender
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError
from lcmtools.wire.datagram import FRAGMENT_MAX, MESSAGE_MAX, ShortMessage, fragments, parse
from lcmtools.wire.packet import Sender
from lcmtools.wire.reader import Reader

_SO_RCVBUFFORCE = 33  # Linux's number; the socket module has no name for it
_PATIENCE = 40.0  # [s]
_LARGE = "/large", bytes(65_499)
_URL = "udpm://239.255.76.67:7667?ttl=0"
_SIZES = (
    PACED_ABOVE_BYTES,
    PACED_ABOVE_BYTES + 1,
    2 * FRAGMENT_MAX - 4,  # fills two fragments to the last byte
    2 * FRAGMENT_MAX - 3,
    400_000,
    1_000_000,
)

_RECEIVER = """
import hashlib, select, sys, lcm
bus = lcm.LCM(sys.argv[1])
def show(channel, payload):
    print(channel, len(payload), hashlib.sha256(payload).hexdigest(), flush=True)
bus.subscribe("BIG", show).set_queue_capacity(0)
print("ready", flush=True)
try:
    while select.select([bus.fileno()], [], []):
        bus.handle()
except (KeyboardInterrupt, OSError):
    pass
"""


def _payload(size):
    return random.Random(size).randbytes(size)  # noqa: S311 - a picture, no secret


@pytest.mark.usefixtures("private_network")
def test_images_at_30_hz_reach_receivers_with_default_buffers(
    start, start_python, lcm_program, wait_until
):
    """Images of 1 MB, until both receivers have had 30: without the pauses none arrives whole.

    How many arrive of those that are sent is measured by bench/large.py.
    """
    payload = b"\0" + _payload(1_000_000)[1:]  # lcm-sink prints what stands before a NUL
    expected = f"BIG 1000000 {hashlib.sha256(payload).hexdigest()}"
    sink = start(lcm_program("lcm-sink"), LCM_DEFAULT_URL=_URL)
    plain = start_python(_RECEIVER, _URL)
    plain.wait_for("ready")
    wait_until(lambda: sum(r.port == 7667 for r in SocketTable.read().rows.values()) == 2)
    with closing(UdpBus(parse_url(_URL))) as bus:
        next_time = time.monotonic()

        def both_have_30():
            nonlocal next_time
            bus.publish("BIG", payload)
            now = time.monotonic()
            next_time = max(next_time + 1 / 30, now)
            time.sleep(next_time - now)
            return min(plain.lines.count(expected), sink.output.count("received [BIG]")) >= 30

        wait_until(both_have_30)


def test_a_paced_message_is_to_the_byte_what_liblcm_sends(bus_url):
    url = parse_url(bus_url)
    with receiving_socket(url) as receiver:
        receiver.settimeout(5.0)
        for size in _SIZES:
            payload = _payload(size)
            plain = lcm.LCM(bus_url)
            plain.publish("BIG", payload)
            expected = _datagrams(receiver, len(list(fragments(0, "BIG", payload))))
            sender = UdpSender(url)
            sender.send("BIG", payload)
            sent = _datagrams(receiver, len(expected))
            sender.close()
            assert sent == expected


def test_a_plain_lcm_program_and_lcm_logger_get_every_byte(
    start, start_python, lcm_program, tmp_path, wait_until, bus_url
):
    log, url = tmp_path / "big.log", f"{bus_url}&recv_buf_size=4000000"
    logger = start(lcm_program("lcm-logger"), "-c", "BIG", "-f", str(log), f"--lcm-url={url}")
    plain = start_python(_RECEIVER, url)
    plain.wait_for("ready")
    bus = UdpBus(parse_url(bus_url))
    for size in _SIZES:
        payload = _payload(size)
        line, start_bytes = f"BIG {size} {hashlib.sha256(payload).hexdigest()}", _size_of(log)

        def arrived(payload=payload, line=line, before=start_bytes):
            bus.publish("BIG", payload)  # until both have it: either may be too busy once
            time.sleep(0.02)
            return line in plain.lines and _size_of(log) >= before + len(payload)

        wait_until(arrived)
    bus.close()
    logger.send_signal(signal.SIGINT)
    logger.wait()
    with closing(lcm.EventLog(str(log), "r")) as events:
        logged = {event.data for event in events}
    assert logged == {_payload(size) for size in _SIZES}
    shown = {line for line in plain.lines if line.startswith("BIG")}
    assert len(shown) == len(_SIZES)


def _size_of(file):
    return file.stat().st_size if file.exists() else 0


@contextmanager
def _everything_heard(url):
    """A receiver that loses nothing, however late it reads; its messages in their order."""
    with receiving_socket(url) as receiver:
        try:
            receiver.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, 64 << 20)
        except PermissionError:
            pytest.skip("a receive buffer that holds everything is root's to make")
        receiver.settimeout(30.0)
        reader = Reader(whole=True)

        def next_messages(count):
            found = []
            while len(found) < count:
                data, (host, port) = receiver.recvfrom(65_536)
                packet = reader.read(data, Sender(host, port), 0)
                if packet is not None and packet.channel == "BIG":
                    found.append(packet.payload)
            return found

        yield next_messages


def test_messages_of_mixed_sizes_all_leave_in_their_order(bus_url):
    sent = [_payload(size) for size in (0, 10, 65_000, 119_000, 121_000, 500_000, 7)]
    url = parse_url(bus_url)
    with _everything_heard(url) as next_messages, closing(UdpBus(url)) as bus:
        for payload in sent:
            bus.publish("BIG", payload)
        assert next_messages(len(sent)) == sent  # a small one overtakes no large one before it


def test_closing_sends_what_is_queued(bus_url):
    sent = [bytes(300_000)] * 10
    url = parse_url(bus_url)
    with _everything_heard(url) as next_messages:
        bus = UdpBus(url)
        for payload in sent:
            bus.publish("BIG", payload)
        bus.close()
        assert next_messages(len(sent)) == sent


def test_a_message_that_lcm_does_not_carry_is_refused(bus_url):
    class Huge(bytes):
        def __len__(self):
            return MESSAGE_MAX + 1

    bus = UdpBus(parse_url(bus_url))
    with raises_saying(BusError, "BIG: 268435457 bytes", "more than LCM"):
        bus.publish("BIG", Huge())
    bus.close()


def test_a_publisher_that_is_faster_than_the_pace_waits(bus_url, monkeypatch):
    monkeypatch.setattr("lcmtools.bus.udp_sender.MAX_WAITING_BYTES", 1_000_000)
    sender = UdpSender(parse_url(bus_url))
    most = 0
    for _ in range(30):
        sender.send("BIG", bytes(300_000))
        most = max(most, sender._waiting_bytes)
    assert 300_000 <= most <= 1_300_000
    sender.close()


def test_a_closed_sender_takes_nothing(bus_url):
    sender = UdpSender(parse_url(bus_url))
    sender.close()
    with pytest.raises(BusError, match="closed"):
        sender.send("BIG", bytes(300_000))
    assert sender.send_together([("/a", b"1"), ("/a", b"2")]) == [0, 1]


@pytest.mark.skipif(not IS_LINUX, reason="UDP_SEGMENT is Linux's")
def test_messages_of_one_size_leave_together_and_the_others_are_left(bus_url):
    url = parse_url(bus_url)
    small = [
        (f"/r{n}", bytes([n]) * 100) for n in range(3, 60)
    ]  # two sizes, with one and two calls
    messages = [*small, ("/alone", bytes(50)), ("/é", b"12345"), ("/ee", b"12345"), *2 * [_LARGE]]
    with receiving_socket(url) as receiver, closing(UdpSender(url)) as sender:
        receiver.settimeout(_PATIENCE)
        assert sender.send_together(messages) == [57, 60, 61]
        sent = [parse(receiver.recv(65_536)) for _ in range(59)]
    in_calls = [*small, *messages[58:60]]
    assert sent == [ShortMessage(n, *message) for n, message in enumerate(in_calls)]


@pytest.mark.usefixtures("private_network")
def test_what_the_network_does_not_take_together_is_left(ip):
    ip("link", "set", "lo", "mtu", "1500")
    with closing(UdpSender(parse_url(_URL))) as sender:
        assert sender.send_together(2 * [("/a", bytes(2000))]) == [0, 1]


def test_nothing_is_sent_together_while_a_large_message_leaves(bus_url, monkeypatch):
    monkeypatch.setattr(UdpSender, "_run", lambda _: None)  # it leaves for ever
    with closing(UdpSender(parse_url(bus_url))) as sender:
        sender.send("BIG", bytes(300_000))
        assert sender.send_together([("/a", b"1"), ("/a", b"2")]) == [0, 1]


def _datagrams(receiver, count):
    """The next datagrams, without the sequence number, which is the sender's own."""
    found = []
    while len(found) < count:
        data = receiver.recv(65_536)
        if data.startswith(b"LC03"):
            found.append(data[:4] + data[8:])
    return found
