"""Where multicast does not work: found out at once, with the line to type."""

import itertools
import socket
import time
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import pytest
from fixtures.says import assert_says

from lcmtools.bus import kernel
from lcmtools.bus.group_receiver import ChannelSocket
from lcmtools.bus.kernel import receive_buffer_bytes
from lcmtools.bus.lcm_bus import LcmBus
from lcmtools.bus.multicast import (
    check_loopback,
    check_multicast,
    receiving_socket,
    sending_socket,
)
from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.tap import Tap
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError

_URL = parse_url("udpm://239.255.76.67:7667?ttl=0")


@pytest.mark.timing
@pytest.mark.usefixtures("bare_network")
@pytest.mark.parametrize("open_bus", [UdpBus, Tap])
def test_no_route_is_an_error_at_once_whose_hint_mends_it(open_bus, ip, capfd, stopwatch):
    watch = stopwatch()
    with pytest.raises(BusError) as caught:
        open_bus(_URL)
    assert watch.seconds() < 0.5
    assert caught.value.what == "no multicast route to 239.255.76.67:7667"
    for line in caught.value.hint.removeprefix("type: ").split(" && "):
        ip(*line.removeprefix("sudo ip ").split())
    open_bus(_URL).close()
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("bare_network")
def test_no_route_for_mpudpm_is_the_same_error():
    with pytest.raises(BusError, match="no multicast route"):
        LcmBus(parse_url("mpudpm://239.255.76.67:7667"))


@pytest.mark.timing
@pytest.mark.usefixtures("private_network")
def test_a_check_that_succeeds_takes_under_50_ms(stopwatch):
    check_multicast(_URL)
    watch = stopwatch()
    check_multicast(_URL)
    assert watch.seconds() < 0.05


@pytest.mark.timing
@pytest.mark.usefixtures("private_network")
def test_a_group_that_is_shut_off_is_an_error_at_once(ip, stopwatch):
    ip("route", "add", "unreachable", "239.255.76.67")
    watch = stopwatch()
    with pytest.raises(BusError, match="no multicast route"):
        check_multicast(_URL)
    assert watch.seconds() < 0.5


@pytest.mark.usefixtures("private_network")
def test_a_forbidden_group_points_to_the_route(ip):
    ip("route", "add", "prohibit", "239.255.76.67")
    with pytest.raises(BusError, match="a prohibit route forbids") as caught:
        check_multicast(_URL)
    assert "ip route show table all type prohibit" in caught.value.hint


@pytest.mark.timing
@pytest.mark.usefixtures("private_network")
def test_a_datagram_that_does_not_come_back_is_an_error_within_half_a_second(stopwatch):
    with (
        sending_socket(_URL) as sender,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as deaf,
    ):
        deaf.bind(("127.0.0.1", 0))
        watch, before = stopwatch(), time.monotonic()
        with pytest.raises(BusError, match="not come back") as caught:
            check_loopback(_URL, sender, deaf)
        assert time.monotonic() - before > 0.3
        assert watch.seconds() < 0.6
        assert "firewall" in caught.value.hint


@pytest.mark.usefixtures("private_network")
def test_the_check_finds_its_own_datagram_among_others():
    with sending_socket(_URL) as sender, receiving_socket(_URL) as receiver:
        with sending_socket(_URL) as other:
            for number in range(500):
                other.sendto(b"LC02%d" % number, (_URL.host, _URL.port))
        check_loopback(_URL, sender, receiver)


@pytest.mark.usefixtures("private_network")
def test_a_port_that_a_program_keeps_for_itself_is_named():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as selfish:
        selfish.bind(("", _URL.port))
        with pytest.raises(BusError, match="not share it") as caught:
            check_multicast(_URL)
    assert "ss -ulnp 'sport = :7667'" in caught.value.hint


def test_a_datagram_that_is_there_counts_although_the_computer_stood_still(bus_url, monkeypatch):
    stalling = SimpleNamespace(monotonic=itertools.count(0.0, 10.0).__next__)
    monkeypatch.setattr("lcmtools.bus.multicast.time", stalling)
    check_multicast(parse_url(bus_url))


def test_the_check_leaves_no_open_file(bus_url):
    url = parse_url(bus_url)
    before = sorted(Path("/proc/self/fd").iterdir())
    for _ in range(5):
        check_multicast(url)
    assert sorted(Path("/proc/self/fd").iterdir()) == before


def test_the_receive_buffer_is_what_the_system_grants():
    limit = int(Path("/proc/sys/net/core/rmem_max").read_text())
    assert receive_buffer_bytes() == min(8 << 20, limit)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer_bytes())
        granted = probe.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    assert granted >= receive_buffer_bytes()


@pytest.mark.parametrize("ttl", [0, 1, 7, 255])
def test_datagrams_travel_as_far_as_the_url_says(ttl):
    with sending_socket(parse_url(f"udpm://?ttl={ttl}")) as sender:
        assert sender.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) == ttl


def test_groups_on_one_port_do_not_hear_each_other(free_port):
    port = free_port()
    one, other = (parse_url(f"udpm://239.255.76.{last}:{port}") for last in (67, 68))
    with receiving_socket(one) as a, receiving_socket(other) as b, sending_socket(one) as sender:
        sender.sendto(b"x", (one.host, port))
        a.settimeout(5.0)
        assert a.recv(10) == b"x"
        b.setblocking(False)
        with pytest.raises(BlockingIOError):
            b.recv(10)


class _Noting(socket.socket):
    """A socket that notes the options it is given, in order."""

    noted: ClassVar[list[tuple[socket.socket, tuple[int, int]]]] = []

    def setsockopt(self, level, option, *value):
        """Set an option, as a socket does."""
        super().setsockopt(level, option, *value)
        self.noted.append((self, (level, option)))


@pytest.mark.parametrize(
    "opened",
    [
        Tap,
        lambda url: Tap(url, whole=True, spread=True),
        lambda url: ChannelSocket(url, "/a"),
        QuickProbe,
    ],
    ids=["tap", "recorder", "channel", "probe"],
)
def test_the_kernel_stamps_datagrams_before_the_first_can_come(opened, bus_url, monkeypatch):
    monkeypatch.setattr(_Noting, "noted", [])
    monkeypatch.setattr(socket, "socket", _Noting)
    opened(parse_url(bus_url)).close()
    stamp, join = (
        (socket.SOL_SOCKET, kernel._STAMP_OPTION),
        (socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP),
    )
    joins = [one for one, option in _Noting.noted if option == join]
    assert joins
    for receiver in joins:
        options = [option for one, option in _Noting.noted if one is receiver]
        assert options.index(stamp) < options.index(join)


_MANY_FILES = """
import os, resource, select, sys
from lcmtools.bus.open import open_bus
from lcmtools.bus.url import parse_url
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError
resource.setrlimit(resource.RLIMIT_NOFILE, (4096, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
files = [os.open("/dev/null", os.O_RDONLY) for _ in range(1100)]
try:
    bus = open_bus(parse_url(sys.argv[1]))
    heard, event = [], WakeupEvent()
    bus.subscribe("a", lambda payload, time: heard.append(payload))
    for payload in (b"x", bytes(300_000)):
        bus.publish("a", payload)
        while payload not in heard:
            bus.wait(event, 0.1)
    bus.close()
    print("works")
except BusError as error:
    print(error)
"""


@pytest.mark.parametrize("url", ["", "memq://"])
def test_a_process_may_have_over_a_thousand_files_but_for_liblcm(start_python, bus_url, url):
    program = start_python(_MANY_FILES, url or bus_url)
    assert program.wait() == 0
    if url:
        assert_says(program.output, "open files", "liblcm")
    else:
        assert program.output == "works"
