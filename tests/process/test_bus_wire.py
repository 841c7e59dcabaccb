"""Nodes' bus and plain lcm receive the same from the same datagrams, to the byte."""

import random
import threading
from contextlib import closing
from itertools import chain, zip_longest

import lcm
import pytest

from lcmtools.bus import group_receiver, multicast
from lcmtools.bus.kernel import IS_LINUX
from lcmtools.bus.multicast import sending_socket
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.wire.datagram import datagrams, fragments, short_message

_URL = "udpm://239.255.76.67:7667?ttl=0"
_CHANNEL = "BIG"
_EDGES = (65_487, 65_495, 65_499, 2 * 65_487 - 4, 120_000)
_SIZES = (0, 1, 8, *(edge + more for edge in _EDGES for more in (-1, 0, 1)), 1_000_000, 4_000_000)

pytestmark = pytest.mark.usefixtures("private_network")


def _payload(size):
    return random.Random(size).randbytes(size)  # noqa: S311 - any bytes will do


class Plain:
    """A plain LCM program that receives on a thread of its own."""

    def __init__(self):
        self.heard = []
        self.instance = lcm.LCM(f"{_URL}&recv_buf_size=4000000")
        for channel in (_CHANNEL, "SMALL", "END"):
            one = self.instance.subscribe(channel, lambda *message: self.heard.append(message))
            one.set_queue_capacity(0)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self):
        """Stop receiving."""
        self._ended.set()
        self._thread.join()

    def _run(self):
        while not self._ended.is_set():
            self.instance.handle_timeout(20)


@pytest.fixture
def plain():
    """A plain LCM program."""
    with closing(Plain()) as program:
        yield program


@pytest.fixture
def bus():
    """A bus of nodes."""
    with closing(UdpBus(parse_url(_URL))) as bus:
        yield bus


@pytest.fixture
def heard(bus):
    """The messages that arrive at the bus."""
    found = []
    for channel in (_CHANNEL, "SMALL", "END"):

        def keep(payload, _time, channel=channel):
            found.append((channel, payload))

        bus.subscribe(channel, keep)
    return found


@pytest.mark.parametrize("size", _SIZES)
def test_messages_of_every_size_pass_both_ways(plain, bus, heard, wait_until, size):
    bus.publish(_CHANNEL, _payload(size))
    wait_until(lambda: heard and plain.heard)
    plain.instance.publish(_CHANNEL, _payload(size))
    wait_until(lambda: len(heard) == len(plain.heard) == 2)
    assert heard == plain.heard == [(_CHANNEL, _payload(size))] * 2


def test_a_message_of_eight_megabytes_is_paced(plain, bus, heard, wait_until):
    """In one burst, as liblcm sends it, it fills the largest buffer of this computer."""
    bus.publish(_CHANNEL, _payload(8_000_000))
    wait_until(lambda: heard and plain.heard)
    assert heard == plain.heard == [(_CHANNEL, _payload(8_000_000))]


def test_eight_megabytes_of_a_plain_program_have_room_after_a_smaller_message(
    plain, heard, wait_until
):
    """They come in one burst, which the room for three of the smaller one takes."""
    for number, size in enumerate((4_000_000, 8_000_000), 1):
        plain.instance.publish(_CHANNEL, _payload(size))
        wait_until(lambda number=number: len(heard) == number)
        assert heard[-1] == (_CHANNEL, _payload(size))


def _large(seqno, size=200_000):
    return list(fragments(seqno, _CHANNEL, _payload(size)))


def _short(seqno, payload=b"small"):
    return short_message(seqno, "SMALL", payload)


def _interleaved(*senders):
    turns = zip_longest(*senders)
    pairs = chain.from_iterable(enumerate(turn) for turn in turns)
    return [(sender, datagram) for sender, datagram in pairs if datagram is not None]


SCRIPTS = {
    "two senders at once": _interleaved(_large(1), _large(1, 300_000)),
    "large and small of one sender": _interleaved(
        [d for pair in zip(_large(1), map(_short, range(2, 6)), strict=True) for d in pair]
    ),
    "two large ones of one port": _interleaved(
        [d for pair in zip(_large(1), _large(2, 200_001), strict=True) for d in pair]
    ),
    "two programs with one port and one number": [
        *((0, d) for d in _large(7)),
        *((0, d) for d in _large(7, 200_001)),
    ],
    "small ones twice": [(0, _short(1)), (0, _short(1)), (0, _short(2))],
    "all of it twice": [(0, d) for d in [*_large(1), *_large(1)]],
    "fragments backwards": [(0, d) for d in reversed(_large(1))],
    "fragments in disorder": [(0, _large(1)[n]) for n in (2, 0, 3, 1)],
    "without the first": [(0, d) for d in _large(1)[1:]],
    "without one": [(0, d) for d in _large(1) if d is not _large(1)[2]][:2],
    "the numbers wrap around": [(0, _short(2**32 - 1)), *((0, d) for d in _large(2**32))],
    "an empty message": [(0, short_message(1, "SMALL", b""))],
    "unknown kinds": [(0, b"LC04" + bytes(40)), (0, b""), (0, b"LC0"), (0, _short(1))],
    "unwanted ones": [(0, d) for d in datagrams(1, "OTHER", _payload(200_000))],
}


@pytest.mark.parametrize("name", SCRIPTS)
@pytest.mark.parametrize("filtered", [True, False], ids=["filter", "no filter"])
def test_any_datagrams_are_received_as_by_plain_lcm(
    plain, request, monkeypatch, wait_until, name, *, filtered
):
    if not filtered:
        for module in (multicast, group_receiver):
            monkeypatch.setattr(module, "attach", lambda *_: False)
        monkeypatch.setattr(group_receiver, "IS_LINUX", False)
    heard = request.getfixturevalue("heard")
    url = parse_url(_URL)
    senders = [sending_socket(url) for _ in range(2)]
    for sender, datagram in [*SCRIPTS[name], (1, short_message(99, "END", b""))]:
        senders[sender].sendto(datagram, (url.host, url.port))
    wait_until(lambda: ("END", b"") in heard and ("END", b"") in plain.heard)
    assert heard == plain.heard
    for one in senders:
        one.close()


def test_fragments_that_come_twice_make_one_message(heard, wait_until):
    """Liblcm counts each twice, and delivers a message before its last parts have come."""
    url = parse_url(_URL)
    with sending_socket(url) as sender:
        for datagram in [*(d for d in _large(1) for _ in range(2)), _short(2)]:
            sender.sendto(datagram, (url.host, url.port))
        wait_until(lambda: ("SMALL", b"small") in heard)
    assert heard == [(_CHANNEL, _payload(200_000)), ("SMALL", b"small")]


@pytest.mark.skipif(not IS_LINUX, reason="sockets are divided by filters")
def test_a_large_message_comes_through_while_the_sockets_are_divided(monkeypatch, wait_until):
    monkeypatch.setattr(multicast, "receive_buffer_bytes", lambda: 4_000_000)
    monkeypatch.setattr(group_receiver, "_NODES_LARGEST", 1000)
    found = []
    with closing(UdpBus(parse_url(_URL))) as bus, closing(UdpBus(parse_url(_URL))) as other:
        bus.subscribe(_CHANNEL, lambda payload, _: found.append(payload))
        for number in range(20):
            other.publish(_CHANNEL, bytes([number]) * 600_000)
        wait_until(lambda: len(found) == 20)
        assert len(bus._sockets.all) == 9
        assert bus.lost(_CHANNEL) == 0
    assert found == [bytes([number]) * 600_000 for number in range(20)]


def test_what_is_lost_of_large_messages_is_counted(bus, heard, wait_until):
    url = parse_url(_URL)
    with sending_socket(url) as sender:
        for datagram in [*_large(1)[:-1], *_large(2)[1:]]:  # of one the first part came
            sender.sendto(datagram, (url.host, url.port))

        def is_counted():
            for datagram in _large(3):
                sender.sendto(datagram, (url.host, url.port))
            return bus.lost(_CHANNEL) > 0

        wait_until(is_counted)
    assert (bus.lost(_CHANNEL), bus.lost("SMALL")) == (1, 0)
    assert {channel for channel, _ in heard} == {_CHANNEL}


@pytest.mark.skipif(not IS_LINUX, reason="the kernel's filters are Linux's")
def test_images_for_others_are_dropped_in_the_kernel_until_one_is_wanted(bus, heard, wait_until):
    image = _payload(3_000_000)
    with closing(UdpBus(parse_url(_URL))) as camera:

        def is_denied():
            camera.publish("IMAGE", image)
            return bus._sockets.unwanted.denied == [(camera.ports[0], len(image))]

        wait_until(is_denied)

        def has_come():
            camera.publish(_CHANNEL, image)  # the first one is lost
            return (_CHANNEL, image) in heard

        wait_until(has_come)
        assert bus._sockets.unwanted.denied == []
    wait_until(lambda: bus.lost(_CHANNEL) <= 1)
