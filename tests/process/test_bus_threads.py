"""The real bus under traffic, used and closed from many threads at once."""

import itertools
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError


def test_other_threads_may_subscribe_and_unsubscribe_under_traffic(bus, other):
    stop = threading.Event()
    heard = itertools.count()

    def talk():
        while not stop.is_set():
            for channel in range(4):
                bus.publish(f"c{channel}", b"x" * 100)
            stop.wait(0.0005)

    def come_and_go(number):
        def handler(_payload, _time):
            next(heard)

        for _ in range(150):
            other.subscribe(f"c{number % 4}", handler)
            other.unsubscribe(f"c{number % 4}", handler)

    with ThreadPoolExecutor(7) as threads:
        threads.submit(talk)
        visits = [threads.submit(come_and_go, number) for number in range(6)]
        try:
            for visit in visits:
                visit.result(timeout=60)
        finally:
            stop.set()
    assert next(heard) > 0


_COME_AND_GO = """
import os
from lcmtools.bus.lcm_bus import LcmBus
from lcmtools.bus.liblcm import Connection
from lcmtools.bus.url import parse_url
url = parse_url("mpudpm://239.255.76.67:7667?ttl=0")
for _ in range(100):
    Connection(url, lambda _: None, print).close()
for _ in range(60):
    bus = LcmBus(url)
    bus.subscribe("A", print)
    sockets = os.listdir("/proc/self/fd")
    for _ in range(3):
        bus.unsubscribe("A", print)
        assert os.listdir("/proc/self/fd") == sockets
        bus.subscribe("A", print)
    bus.close()
"""


@pytest.mark.usefixtures("private_network")
def test_buses_of_many_ports_come_and_go():
    # a closed descriptor that liblcm's thread still reads from hung one of ten
    command = [sys.executable, "-c", _COME_AND_GO]
    subprocess.run(command, check=True, timeout=100)


@pytest.mark.usefixtures("private_network")
def test_a_flood_does_not_keep_anybody_from_subscribing(wait_until):
    url = parse_url("udpm://239.255.76.67:7667?ttl=0")
    sender, receiver = UdpBus(url), UdpBus(url)
    stop = threading.Event()
    slow = []

    def flood():
        while not stop.is_set():
            sender.publish("flood", b"x")

    def handle(_payload, _time):
        slow.append(sum(range(5000)))  # slower than the sender, so that messages always wait

    receiver.subscribe("flood", handle)
    flooder = threading.Thread(target=flood)
    flooder.start()
    try:
        wait_until(lambda: len(slow) > 1000)
        before = time.monotonic()
        for _ in range(5):
            receiver.subscribe("other", handle)
            receiver.unsubscribe("other", handle)
        assert time.monotonic() - before < 8.0
    finally:
        stop.set()
        flooder.join()
        receiver.close()
        sender.close()


@pytest.mark.parametrize("turn", range(0, 15, 3))
def test_a_bus_closes_while_others_use_it(bus_url, turn):
    """A caller that comes too late gets a BusError, at once, and nothing else happens."""
    bus = UdpBus(parse_url(bus_url))

    def handle(_payload, _time):
        """Hear, and do nothing."""

    def come_and_go():
        bus.subscribe("a", handle)
        bus.unsubscribe("a", handle)

    def use(act):
        with pytest.raises(BusError, match="the bus is closed"):
            _repeat(act)

    with ThreadPoolExecutor(3) as threads:
        users = [
            threads.submit(use, lambda: bus.publish("a", b"x")),
            threads.submit(use, lambda: bus.publish("a", bytes(130_000))),
            threads.submit(use, come_and_go),
        ]
        time.sleep(0.001 * turn)  # not for luck: closing is to happen at any moment
        before = time.monotonic()
        bus.close()
        bus.close()
        for user in users:
            user.result(timeout=60)
    assert time.monotonic() - before < 8.0


def _repeat(act):
    """Until it raises."""
    while True:
        act()
