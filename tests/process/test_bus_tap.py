"""The tap: what it sees of every sender, and that nothing on the wire can harm it."""

import os
import random
import signal
import socket
import time

import lcm
import pytest
from fixtures.says import raises_saying

from lcmtools.bounded import MOST_ENTRIES
from lcmtools.bus.kernel import IS_LINUX
from lcmtools.bus.sockets import PossibleSenders, SocketTable
from lcmtools.bus.tap import Tap
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError, InvalidName
from lcmtools.wire.datagram import fragments, short_message
from lcmtools.wire.packet import Sender

_URL = parse_url("udpm://239.255.76.67:7667?ttl=0")
_GROUP = (_URL.host, _URL.port)


@pytest.fixture
def tap(bus_url):
    with Tap(parse_url(bus_url), whole=True) as tap:
        yield tap


def _senders_of_port(port):
    return SocketTable.read().processes(Sender("127.0.0.1", port))


def _receive(tap, count, timeout=40.0):
    """The next packets that are not LCM's self tests."""
    packets = []
    deadline = time.monotonic() + timeout
    while len(packets) < count:
        if time.monotonic() > deadline:
            pytest.fail(f"{len(packets)} of {count} packets within {timeout} s")
        packets += [p for p in tap.receive(0.1) if p.channel != "LCM_SELF_TEST"]
    return packets


def test_a_plain_lcm_program_is_seen_with_sender_number_and_time(tap, bus_url):
    plain = lcm.LCM(bus_url)
    before = time.time_ns()
    plain.publish("A.b*", b"one")
    plain.publish("B", b"")
    after = time.time_ns()
    first, second = _receive(tap, 2)
    assert (first.channel, first.payload) == ("A.b*", b"one")
    assert (second.channel, second.payload) == ("B", b"")
    assert first.sender == second.sender
    assert first.sender is not None
    assert first.seqno is not None
    assert second.seqno == first.seqno + 1
    assert before <= first.time <= second.time <= after + 1_000_000


def test_the_time_is_the_kernels_and_not_that_of_reading(tap, bus_url):
    lcm.LCM(bus_url).publish("A", b"")
    sent = time.time_ns()
    time.sleep(0.05)  # for nothing but to be late
    (packet,) = _receive(tap, 1)
    assert packet.time <= sent


def test_two_connections_of_one_process_are_two_senders(tap, bus_url):
    one, other = lcm.LCM(bus_url), lcm.LCM(bus_url)
    one.publish("A", b"")
    other.publish("A", b"")
    senders = {packet.sender for packet in _receive(tap, 2)}
    assert len(senders) == 2
    for sender in senders:
        assert sender is not None
        process = _senders_of_port(sender.port).only
        assert process is not None
        assert process.pid == os.getpid()


def test_the_port_of_another_program_leads_to_it(tap, bus_url, start, lcm_program):
    source = start(lcm_program("lcm-source"), "-m", "SRC", "-p", "10000", LCM_DEFAULT_URL=bus_url)
    packet = _receive(tap, 1)[0]
    assert packet.channel == "SRC"
    assert packet.sender is not None
    process = _senders_of_port(packet.sender.port).only
    assert process is not None
    assert process.pid == source.pid
    assert "lcm-source -m SRC" in process.command


def test_a_bus_sends_everything_from_the_port_that_it_announces(tap, bus_url):
    bus = UdpBus(parse_url(bus_url))
    bus.publish("SMALL", b"x")
    bus.publish("LARGE", bytes(200_000))
    packets = {packet.channel: packet.sender for packet in _receive(tap, 2)}
    assert [packets["LARGE"].port] == [packets["SMALL"].port] == bus.ports
    process = _senders_of_port(bus.ports[0]).only
    assert process is not None
    assert process.pid == os.getpid()
    bus.close()


@pytest.mark.parametrize("size", [65_495, 65_496, 65_500, 131_000, 190_000])
def test_fragments_of_liblcm_are_put_together(tap, bus_url, size):
    payload = random.Random(size).randbytes(size)  # noqa: S311
    lcm.LCM(bus_url).publish("BIG", payload)
    (packet,) = _receive(tap, 1)
    assert packet.payload == payload


@pytest.mark.parametrize("size", [0, 65_495, 65_496, 200_000])
def test_what_a_tap_sends_is_received_by_plain_lcm(bus_url, tap, size, wait_until):
    heard = []
    plain = lcm.LCM(f"{bus_url}&recv_buf_size=4000000")
    plain.subscribe("BIG", lambda _channel, payload: heard.append(payload))
    payload = random.Random(size).randbytes(size)  # noqa: S311
    assert tap.port == 0
    tap.send("BIG", payload)
    assert tap.port > 0
    wait_until(lambda: plain.handle_timeout(0) and heard)
    assert heard == [payload]
    (packet,) = _receive(tap, 1)
    assert packet.sender is not None
    assert packet.sender.port == tap.port


@pytest.mark.skipif(not IS_LINUX, reason="filters are Linux's")
@pytest.mark.parametrize("size", [8, 100_000])
def test_a_tap_that_need_not_hear_itself_reads_nothing_of_that(bus_url, size):
    url = parse_url(bus_url)
    with Tap(url, whole=True, spread=True, hears_itself=False) as tap, Tap(url) as other:
        tap.send("/own", bytes(size))
        other.send("/other", bytes(size))
        packets = _receive(tap, 1)
    assert [packet.channel for packet in packets] == ["/other"]


def test_a_tap_sends_on_channels_that_lcm_can_carry_only(tap):
    for channel in ("", "a" * 64, "a\0"):
        with pytest.raises(InvalidName):
            tap.send(channel, b"")


def test_nothing_to_receive_is_an_empty_list_in_time(tap, stopwatch):
    while tap.receive(0.0):
        pass
    before, watch = time.monotonic(), stopwatch()
    assert tap.receive(0.05) == []
    assert time.monotonic() - before > 0.04
    assert watch.seconds() < 1.0
    assert tap.receive(-1.0) == []


def _malformed():
    header = b"LC03\0\0\0\1"
    hostile = [b"", b"L", b"LC", b"LC02", b"LC02\0\0\0", b"LC02\0\0\0\0", b"LC02\0\0\0\0abc"]
    hostile += [b"LC02\0\0\0\0" + b"a" * 70 + b"\0x", b"LC03", b"LC03" + bytes(15)]
    hostile += [header + bytes(12), header + b"\0\0\0\5\0\0\0\0\0\2\0\1abc"]
    hostile += [header + b"\0\0\0\2\0\0\0\0\0\1\0\2abc", header + b"\xff" * 12 + b"abc"]
    hostile += [header + b"\x0f\xff\xff\xff\0\0\0\0\0\0\xff\xffA\0", b"\xff" * 60_000]
    lonely = [part for n in range(50) for part in list(fragments(n, "GONE", bytes(70_000)))[1:]]
    return hostile + lonely


@pytest.mark.usefixtures("private_network")
def test_no_datagram_harms_the_tap_or_hides_the_others():
    random_bytes = random.Random(1)  # noqa: S311
    with (
        Tap(_URL, whole=True) as tap,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as plain,
    ):
        received = []
        good = 0
        for datagram in _malformed() + [random_bytes.randbytes(n) for n in range(200)]:
            plain.sendto(datagram, _GROUP)
            plain.sendto(short_message(good, "GOOD", b"%d" % good), _GROUP)
            good += 1
            received += [p for p in tap.receive(0.0) if p.channel == "GOOD"]
        plain.sendto(short_message(0, "", b"empty channel"), _GROUP)
        plain.sendto(b"LC02\0\0\0\1\xff\xfe\0x", _GROUP)
        for part in fragments(9, "TWICE", bytes(70_000)):
            plain.sendto(part, _GROUP)
            plain.sendto(part, _GROUP)
        rest = _receive(tap, 3 + good - len(received))
        received += [p for p in rest if p.channel == "GOOD"]
        assert [int(packet.payload) for packet in received] == list(range(good))
        others = {p.channel: p.payload for p in rest if p.channel != "GOOD"}
        assert others == {"": b"empty channel", "\udcff\udcfe": b"x", "TWICE": bytes(70_000)}
        assert list(tap.malformed) == [Sender("0.0.0.0", plain.getsockname()[1])]  # noqa: S104


@pytest.mark.usefixtures("private_network")
def test_malformed_datagrams_from_ever_new_senders_are_bounded():
    with Tap(_URL) as tap:
        for _ in range(6000):  # from about 5,400 ports
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as plain:
                plain.sendto(b"nonsense", _GROUP)
            tap.receive(0.0)
        assert len(tap.malformed) == MOST_ENTRIES


@pytest.mark.usefixtures("private_network")
def test_a_network_that_goes_away_is_an_error_when_sending(ip):
    with Tap(_URL) as tap:
        tap.send("A", b"")
        ip("link", "set", "lo", "down")  # without a route, messages go over it
        with raises_saying(BusError, "cannot send", "239.255.76.67: Network is unreachable"):
            tap.send("A", b"")
        assert [p.channel for p in tap.receive(1.0)][-1] == "A"


_LISTENER = """
import lcm, sys
bus = lcm.LCM(sys.argv[1])
bus.subscribe("A", print)
print("ready", flush=True)
while True:
    bus.handle()
"""


def test_a_program_that_may_publish_is_known_before_it_does(bus_url, start_python):
    url = parse_url(bus_url)
    listener = start_python(_LISTENER, bus_url)
    listener.wait_for("ready")
    pid = listener.pid

    def pids(heard, known):
        ports = SocketTable.read().silent_senders(url, heard, known)
        return {process.pid for port in ports if (process := _senders_of_port(port).only)}

    with Tap(url) as tap:
        tap.send("A", b"")  # now this process has a sending socket too
        assert pid in pids(set(), set())
        assert os.getpid() not in pids(set(), set())
        assert pid not in pids(set(), {pid})
        ports = {one.port for one in SocketTable.read().rows.values() if _owner(one.port) == pid}
        assert pid not in pids(ports, set())
        listener.send_signal(signal.SIGKILL)
        listener.wait()
        assert pid not in pids(set(), set())


def test_a_program_that_listens_on_another_bus_is_not_waited_for(bus_url, start_python, free_port):
    """Many students share one computer, each on a domain of his own."""
    url = parse_url(bus_url)
    listener = start_python(_LISTENER, bus_url)
    listener.wait_for("ready")
    table, other = SocketTable.read(), url._replace(port=free_port())
    here = table.silent_senders(url, set(), set())
    elsewhere = table.silent_senders(other, set(), set())
    assert listener.pid in {_owner(port) for port in here}
    assert listener.pid not in {_owner(port) for port in elsewhere}


def _owner(port):
    process = _senders_of_port(port).only
    return process.pid if process else None


# As Java's library has it: bound to any address, and sending from the bus's own port.
_LIKE_JAVA = """
import socket, sys, time
both = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
both.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
both.bind(("", int(sys.argv[1])))
for number in range(1_000_000):
    data = b"LC02" + number.to_bytes(4, "big") + b"JAVA\\0"
    both.sendto(data, ("239.255.76.67", int(sys.argv[1])))
    if number == 1:
        print("ready", flush=True)
    time.sleep(0.02)
"""


def test_on_the_port_that_all_listen_to_only_who_can_send_from_it_is_meant(bus_url, start_python):
    port = parse_url(bus_url).port
    start_python(_LISTENER, bus_url).wait_for("ready")
    assert _senders_of_port(port) == PossibleSenders(())
    java = start_python(_LIKE_JAVA, str(port))
    java.wait_for("ready")
    with Tap(parse_url(bus_url)):
        process = _senders_of_port(port).only
    assert process is not None
    assert process.pid == java.pid


def test_of_several_that_send_from_one_port_none_is_guessed(bus_url, start_python):
    port = parse_url(bus_url).port
    started = [start_python(_LIKE_JAVA, str(port)) for _ in range(2)]
    for java in started:
        java.wait_for("ready")
    senders = _senders_of_port(port)
    assert senders.only is None
    assert [p.pid for p in senders.candidates] == sorted(java.pid for java in started)


def test_numbers_from_a_port_that_programs_share_tell_of_no_loss(bus_url, start_python, wait_until):
    url = parse_url(bus_url)
    with Tap(url) as tap:
        start_python(_LIKE_JAVA, str(url.port)).wait_for("ready")
        start_python(_LISTENER, bus_url).wait_for("ready")  # its self test counts

        def ports():
            tap.receive(0.1)
            return {sender.port for sender in tap.sequences}

        wait_until(lambda: len(ports()) > 1)
        assert url.port in {sender.port for sender in tap.sequences}
        assert url.port not in {sender.port for sender in tap.numbered}
        assert tap.numbered
