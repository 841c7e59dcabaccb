"""A system that refuses what it is asked for: nodes and observers receive all the same."""

import os
import socket
import threading
import time
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from lcmtools.bus import datagram_batch, kernel, multicast, quick_probe, tap, udp_bus
from lcmtools.bus.kernel import IS_LINUX
from lcmtools.bus.multicast import sending_socket
from lcmtools.bus.network_watch import join
from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.tap import Tap
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError
from lcmtools.observe.reading import monitor
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.datagram import fragments, short_message

_URL = parse_url("udpm://239.255.76.67:7667?ttl=0")
_GROUP = _URL.host, _URL.port
_MEMORY = "/proc/sys/net/core/optmem_max"
_NAMES = {
    "short": lambda number: f"/husky/topic_{number:02}",
    "long": lambda number: f"/robot{number:04}/sensors/camera/front/color/image",
}

pytestmark = [
    pytest.mark.usefixtures("private_network"),
    pytest.mark.skipif(not IS_LINUX, reason="the requests are Linux's"),
]


@pytest.fixture
def filter_memory():
    """``filter_memory(4096)``: limits what filters of a socket may take, in this network only."""

    def limit(size):
        try:
            Path(_MEMORY).write_text(str(size))
        except OSError:
            pytest.skip("this kernel has one limit for all networks")

    return limit


@pytest.fixture
def send():
    """Sends a datagram to the bus."""
    with sending_socket(_URL) as sender:
        yield lambda datagram: sender.sendto(datagram, _GROUP)


@pytest.mark.parametrize(
    ("count", "names", "memory"),
    [
        *((8, "short", 64), (10, "long", 64), (120, "long", 64)),
        *((10, "short", 512), (45, "long", 512), (1000, "short", 512)),
        *((45, "short", 4_096), (120, "long", 4_096)),
        *((8, "long", 20_480), (120, "short", 20_480), (1000, "long", 20_480)),
        *((45, "long", 131_072), (1000, "short", 131_072)),
    ],
)
def test_every_subscription_is_heard_whatever_filters_the_kernel_has_memory_for(
    filter_memory, send, wait_until, count, names, memory
):
    filter_memory(memory)
    heard = []
    channels = [_NAMES[names](number) for number in range(count)]
    with closing(UdpBus(_URL)) as bus:
        for channel in channels:
            bus.subscribe(channel, lambda _payload, _time, channel=channel: heard.append(channel))
        for number, channel in enumerate(channels):
            send(short_message(number, channel, b"x"))
            if number % 50 == 49:
                wait_until(lambda number=number: len(heard) > number)
        wait_until(lambda: len(heard) == count)
    assert heard == channels


@pytest.mark.parametrize("memory", [64, 512, 1_024, 4_096, 20_480])
def test_images_come_once_where_filters_for_several_sockets_are_refused(
    filter_memory, send, wait_until, monkeypatch, memory
):
    monkeypatch.setattr(multicast, "receive_buffer_bytes", lambda: 212_992)
    filter_memory(memory)
    heard = []
    with closing(UdpBus(_URL)) as bus, Tap(_URL, whole=True, spread=True) as tap:
        for number in range(8):
            name = _NAMES["long"](number)
            bus.subscribe(name, lambda payload, _: heard.append(len(payload)), is_large=True)
        for part in fragments(1, _NAMES["long"](7), bytes(300_000)):
            send(part)
            time.sleep(0.002)  # one socket's stock buffer holds three
        send(short_message(2, _NAMES["long"](0), b"end"))
        wait_until(lambda: len(heard) >= 2)
        seen = []
        wait_until(lambda: seen.extend(len(p.payload) for p in tap.receive(0.1)) or 3 in seen)
    assert heard == [300_000, 3]
    assert [size for size in seen if size in heard] == heard


def test_an_observer_whose_filter_is_refused_knows_it_and_counts_what_it_loses(send, filter_memory):
    filter_memory(200)
    with Tap(_URL) as tap:
        assert tap.drops() == 0
        for part in fragments(0, "BIG", bytes(300_000)):
            send(part)
        for number in range(1, 3000):
            send(short_message(number, "A", bytes(8000)))
        found = []
        while packets := tap.receive(0.1):
            found += [one for one in packets if one.channel != "LCM_SELF_TEST"]
        assert tap.drops() == tap.overflows() == 3000 - len(found) > 0
    big = found[0]
    assert (big.channel, big.whole_bytes, len(big.payload)) == ("BIG", 300_000, 1024)


@pytest.mark.parametrize(("memory", "is_refused"), [(64, True), (1_024, True), (131_072, False)])
def test_a_node_whose_filter_is_refused_is_marked(filter_memory, memory, *, is_refused):
    filter_memory(memory)
    with closing(UdpBus(_URL)) as bus:
        for number in range(45):
            bus.subscribe(_NAMES["long"](number), lambda *_: None)
        marks = [*SocketTable.read().marks.values()]
        found = marks.count(kernel.UNFILTERED), marks.count(kernel.SUBSCRIBED)
    assert found == (is_refused, not is_refused)


_OPTIONS = {
    "filter": (socket.SOL_SOCKET, 26),
    "removing a filter": (socket.SOL_SOCKET, 27),
    "shared port": (socket.SOL_SOCKET, socket.SO_REUSEADDR),
    "larger buffer": (socket.SOL_SOCKET, socket.SO_RCVBUF),
    "receive times": (socket.SOL_SOCKET, 35),
    "times to live": (socket.IPPROTO_IP, 12),
    "timeout": (socket.SOL_SOCKET, 20),
    "mark": (socket.IPPROTO_IP, socket.IP_TOS),
    "looping back": (socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP),
}


def _refuse(monkeypatch, *options):
    def setsockopt(self, level, option, *value):
        if (level, option) in options:
            raise PermissionError(1, os.strerror(1))
        accept(self, level, option, *value)

    accept = socket.socket.setsockopt
    monkeypatch.setattr(socket.socket, "setsockopt", setsockopt, raising=False)


def _refuse_all(monkeypatch, module, name):
    def refused(*_):
        raise OSError(38, os.strerror(38))

    monkeypatch.setattr(module, name, refused)


_CALLS = {
    "recvmmsg": (datagram_batch.DatagramBatch, "_receive"),
    "memory for recvmmsg": (datagram_batch.mmap, "mmap"),
    "eventfd": (os, "eventfd"),
}


@pytest.mark.parametrize("what", [*_OPTIONS, *_CALLS])
def test_what_is_refused_costs_no_message(monkeypatch, wait_until, what):
    if what in _OPTIONS:
        _refuse(monkeypatch, _OPTIONS[what])
    else:
        _refuse_all(monkeypatch, *_CALLS[what])
    image, heard, seen = bytes(1_000_000), list[int](), list[int]()
    never = WakeupEvent()
    with ExitStack() as stack:
        if what == "shared port":  # nobody else can be there
            bus = stack.enter_context(closing(UdpBus(_URL)))
        else:
            tap = stack.enter_context(Tap(_URL, whole=True, spread=True))
            bus = stack.enter_context(closing(UdpBus(_URL)))
        bus.subscribe("A", lambda payload, _: heard.append(len(payload)), is_large=True)
        for number in range(300):
            bus.publish("A", bytes(number))
            bus.wait(never, 0.001)
            seen += [] if what == "shared port" else _sizes(tap)
        bus.publish("A", image)
        wait_until(lambda: len(heard) == 301)
        if what != "shared port":
            wait_until(lambda: seen.extend(_sizes(tap)) or len(seen) == 301)
            assert seen == heard
    never.close()
    assert heard == [*range(300), len(image)]


def _sizes(tap):
    return [len(one.payload) for one in tap.receive(0.0) if one.channel == "A"]


def test_more_sockets_that_are_refused_leave_one(monkeypatch, wait_until):
    made = 0

    def few(*arguments):
        nonlocal made
        made += 1
        if made > 2:
            raise BusError("cannot use it: Too many open files")
        return receiving(*arguments)

    from lcmtools.bus import group_receiver

    receiving = multicast.receiving_socket
    monkeypatch.setattr(multicast, "receive_buffer_bytes", lambda: 212_992)
    monkeypatch.setattr(group_receiver, "receiving_socket", few)
    heard = []
    with closing(UdpBus(_URL)) as bus:
        bus.subscribe("A", lambda payload, _: heard.append(payload), is_large=True)
        bus.publish("A", bytes(100_000))
        wait_until(lambda: heard)


@pytest.mark.parametrize(
    ("opening", "module", "part"),
    [
        (Tap, tap, "GroupReceiver"),
        (UdpBus, udp_bus, "UdpSender"),
        (QuickProbe, quick_probe, "sending_socket"),
        (lambda url: BusMonitor(url, "echo", {}), monitor, "NodeRecords"),
    ],
)
def test_opening_that_fails_or_is_interrupted_leaves_no_socket(monkeypatch, opening, module, part):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    opening(_URL).close()  # the watch of the network stays
    before = [*Path("/proc/self/fd").iterdir()]
    monkeypatch.setattr(module, part, interrupt)
    with pytest.raises(KeyboardInterrupt):
        opening(_URL)
    assert [*Path("/proc/self/fd").iterdir()] == before


def test_without_a_time_to_live_nothing_is_sent(monkeypatch):
    """It would be sent to other computers."""
    _refuse(monkeypatch, (socket.IPPROTO_IP, socket.IP_MULTICAST_TTL))
    with pytest.raises(BusError, match="does not limit datagrams to 0 hops"):
        UdpBus(_URL)


@pytest.mark.parametrize("memberships", [0, 1, 2])
def test_few_memberships_are_enough_or_are_named(memberships, wait_until):
    Path("/proc/sys/net/ipv4/igmp_max_memberships").write_text(str(memberships))
    if memberships == 0:
        with pytest.raises(BusError, match=r"permits no membership of .*igmp_max_memberships"):
            UdpBus(_URL)
        return
    heard = []
    with closing(UdpBus(_URL)) as bus:
        bus.subscribe("A", lambda payload, _: heard.append(payload))
        bus.publish("A", b"x")
        wait_until(lambda: heard)


def test_a_socket_whose_memberships_are_used_up_follows_the_route(ip):
    Path("/proc/sys/net/ipv4/igmp_max_memberships").write_text("1")
    ip("link", "add", "other", "type", "veth", "peer", "name", "end")
    ip("addr", "add", "10.9.9.1/24", "dev", "other")
    ip("link", "set", "other", "up", "multicast", "on")
    with multicast.receiving_socket(_URL, is_brief=True) as receiver:
        assert not join(receiver, _URL.host)
        ip("route", "replace", "224.0.0.0/4", "dev", "other")
        assert join(receiver, _URL.host)
        rows = Path("/proc/net/igmp").read_text().split("\n")
        group = f"{int.from_bytes(socket.inet_aton(_URL.host)[::-1], 'big'):08X}"
        devices = [row.split()[1] for row in rows if row[:1].isdigit()]
        of_group = [n for n, row in enumerate(rows) if group in row]
    assert devices
    assert len(of_group) == 1


def test_threads_that_are_refused_are_named(monkeypatch):
    def refuse(_self):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    with pytest.raises(BusError, match="no more threads; end others; see ulimit -u and -v"):
        UdpBus(_URL)


def test_a_default_timeout_of_the_program_changes_nothing(wait_until):
    socket.setdefaulttimeout(0.001)
    try:
        heard = []
        with closing(UdpBus(_URL)) as bus, Tap(_URL) as tap:
            assert {one.gettimeout() for one in (*bus._sockets.all, *tap._sockets.all)} == {None}
            bus.subscribe("A", lambda payload, _: heard.append(payload))
            bus.publish("A", bytes(1_000_000))
            wait_until(lambda: heard)
            reader, writer = socket.socketpair()
            reader.settimeout(None)
            with reader, writer, kernel.duplicate(reader.fileno()):
                assert os.get_blocking(reader.fileno())
    finally:
        socket.setdefaulttimeout(None)
