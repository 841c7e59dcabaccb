"""The real bus: what goes over it, and that its sharp edges are covered."""

import itertools
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from lcmtools.bus.liblcm import LcmBus
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError, InvalidName

WaitUntil = Callable[..., None]


@pytest.fixture
def bus(bus_url: str) -> Iterator[LcmBus]:
    bus = LcmBus(parse_url(bus_url))
    yield bus
    bus.close()


@pytest.fixture
def other(bus_url: str) -> Iterator[LcmBus]:
    """A second connection to the same bus."""
    bus = LcmBus(parse_url(bus_url))
    yield bus
    bus.close()


def test_a_message_arrives_with_the_time_it_came(
    bus: LcmBus, other: LcmBus, wait_until: WaitUntil
) -> None:
    heard: list[tuple[bytes, int]] = []
    other.subscribe("/chatter", lambda payload, arrival: heard.append((payload, arrival)))
    before = time.time_ns()
    bus.publish("/chatter", b"hello")
    wait_until(lambda: heard)
    payload, arrival = heard[0]
    assert payload == b"hello"
    assert before <= arrival <= time.time_ns()


def test_messages_arrive_in_order(bus: LcmBus, other: LcmBus, wait_until: WaitUntil) -> None:
    heard: list[int] = []
    other.subscribe("n", lambda payload, _: heard.append(int(payload)))
    for number in range(200):
        bus.publish("n", b"%d" % number)
    wait_until(lambda: len(heard) == 200)
    assert heard == list(range(200))


def test_a_bus_hears_itself(bus: LcmBus, wait_until: WaitUntil) -> None:
    heard: list[bytes] = []
    bus.subscribe("a", lambda payload, _: heard.append(payload))
    bus.publish("a", b"x")
    wait_until(lambda: heard == [b"x"])


@pytest.mark.parametrize(
    ("channel", "decoys"),
    [
        ("/a.b+", ["/aXb+", "/a.bb", "/a.b", "/a.b+c", "x/a.b+"]),
        ("A|B", ["A", "B", "AXX", "YB"]),
        (".*", ["a", ".", "..", "*"]),
        ("^a$", ["a"]),
        ("a\\b", ["a", "ab", "a\\\\b"]),
        ("(?i)a", ["A", "a"]),
        ("[ab]{2}", ["ab", "aa"]),
        ("a b\tc#d", ["abc", "ab c"]),
        ("été ☃", ["ete", "été"]),
        ("C" * 63, ["C" * 62]),
    ],
)
def test_every_character_of_a_channel_is_literal(
    bus: LcmBus, other: LcmBus, wait_until: WaitUntil, channel: str, decoys: list[str]
) -> None:
    heard: list[bytes] = []
    end = threading.Event()
    other.subscribe(channel, lambda payload, _: heard.append(payload))
    other.subscribe("END", lambda _payload, _time: end.set())
    for decoy in decoys:
        bus.publish(decoy, b"decoy")
    bus.publish(channel, b"meant")
    bus.publish("END", b"")
    wait_until(end.is_set)
    assert heard == [b"meant"]


def test_several_handlers_of_one_channel_hear_each_message_once(
    bus: LcmBus, other: LcmBus, wait_until: WaitUntil
) -> None:
    heard: list[str] = []

    def one(_payload: bytes, _time: int) -> None:
        heard.append("one")

    other.subscribe("a", one)
    other.subscribe("a", lambda _payload, _time: heard.append("two"))
    bus.publish("a", b"")
    wait_until(lambda: len(heard) == 2)
    other.unsubscribe("a", one)
    bus.publish("a", b"")
    wait_until(lambda: len(heard) == 3)
    assert heard == ["one", "two", "two"]


def test_an_unsubscribed_channel_is_heard_no_more_until_subscribed_again(
    bus: LcmBus, other: LcmBus, wait_until: WaitUntil
) -> None:
    heard: list[bytes] = []
    end: list[bytes] = []

    def handler(payload: bytes, _time: int) -> None:
        heard.append(payload)

    other.subscribe("END", lambda payload, _: end.append(payload))
    other.subscribe("a", handler)
    other.unsubscribe("a", handler)
    other.unsubscribe("a", handler)
    bus.publish("a", b"1")
    bus.publish("END", b"")
    wait_until(lambda: end)
    other.subscribe("a", handler)
    bus.publish("a", b"2")
    wait_until(lambda: heard)
    assert heard == [b"2"]


def test_handlers_may_subscribe_and_unsubscribe(
    bus: LcmBus, other: LcmBus, wait_until: WaitUntil
) -> None:
    heard: list[str] = []

    def late(_payload: bytes, _time: int) -> None:
        heard.append("late")

    def once(_payload: bytes, _time: int) -> None:
        heard.append("once")
        other.subscribe("b", late)
        other.unsubscribe("a", once)

    other.subscribe("a", once)
    bus.publish("a", b"")
    bus.publish("a", b"")
    wait_until(lambda: "once" in heard)
    bus.publish("b", b"")
    wait_until(lambda: "late" in heard)
    assert heard == ["once", "late"]


@pytest.mark.parametrize("channel", ["", "a" * 64, "é" * 32, "a\0b"])
def test_a_channel_that_lcm_cannot_carry_is_refused(bus: LcmBus, channel: str) -> None:
    with pytest.raises(InvalidName):
        bus.subscribe(channel, lambda _payload, _time: None)
    for payload in (b"", bytes(200_000)):
        with pytest.raises(InvalidName):
            bus.publish(channel, payload)


def test_a_channel_that_is_not_utf8_is_refused_and_the_bus_goes_on(
    bus: LcmBus, wait_until: WaitUntil
) -> None:
    with pytest.raises(BusError, match="UTF-8"):
        bus.subscribe("\udcff", lambda _payload, _time: None)
    with pytest.raises(BusError, match="UTF-8"):
        bus.publish("\udcff", b"")
    heard: list[bytes] = []
    bus.subscribe("a", lambda payload, _: heard.append(payload))
    bus.publish("a", b"x")
    wait_until(lambda: heard)


def test_other_threads_may_subscribe_and_unsubscribe_under_traffic(
    bus: LcmBus, other: LcmBus
) -> None:
    stop = threading.Event()
    heard = itertools.count()

    def talk() -> None:
        while not stop.is_set():
            for channel in range(4):
                bus.publish(f"c{channel}", b"x" * 100)
            stop.wait(0.0005)

    def come_and_go(number: int) -> None:
        def handler(_payload: bytes, _time: int) -> None:
            next(heard)

        for _ in range(150):
            other.subscribe(f"c{number}", handler)
            other.unsubscribe(f"c{number}", handler)

    talker = threading.Thread(target=talk)
    talker.start()
    visitors = [threading.Thread(target=come_and_go, args=[n % 4]) for n in range(6)]
    for visitor in visitors:
        visitor.start()
    for visitor in visitors:
        visitor.join(20)
    stop.set()
    talker.join()
    assert not any(visitor.is_alive() for visitor in visitors)
    assert next(heard) > 0


@pytest.mark.usefixtures("private_network")
def test_a_flood_does_not_keep_anybody_from_subscribing(wait_until: WaitUntil) -> None:
    url = parse_url("udpm://239.255.76.67:7667?ttl=0")
    sender, receiver = LcmBus(url), LcmBus(url)
    stop = threading.Event()
    slow: list[int] = []

    def flood() -> None:
        while not stop.is_set():
            sender.publish("flood", b"x")

    def handle(_payload: bytes, _time: int) -> None:
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
        assert time.monotonic() - before < 2.0
    finally:
        stop.set()
        flooder.join()
        receiver.close()
        sender.close()


def test_a_bus_closes_while_others_use_it(bus_url: str) -> None:
    """Whoever comes too late gets a BusError, at once, and nothing else happens."""
    for _ in range(15):
        bus = LcmBus(parse_url(bus_url))
        surprises: list[BaseException] = []
        started = threading.Barrier(4)

        def use(act: Callable[[], object]) -> None:
            started.wait()  # noqa: B023 - joined within the loop's turn
            try:
                for _ in range(100_000):
                    act()
            except BusError:
                pass
            except BaseException as error:  # noqa: BLE001
                surprises.append(error)  # noqa: B023

        def come_and_go(bus: LcmBus = bus) -> None:
            handler = lambda _payload, _time: None  # noqa: E731
            bus.subscribe("a", handler)
            bus.unsubscribe("a", handler)

        users = [
            threading.Thread(target=use, args=[act])
            for act in (
                lambda bus=bus: bus.publish("a", b"x"),
                lambda bus=bus: bus.publish("a", bytes(130_000)),
                come_and_go,
            )
        ]
        for user in users:
            user.start()
        started.wait()
        time.sleep(0.01)  # not for luck: closing is to happen at no particular moment
        before = time.monotonic()
        bus.close()
        bus.close()
        for user in users:
            user.join(10)
        assert time.monotonic() - before < 2.0
        assert surprises == []


def test_a_closed_bus_refuses_messages_and_subscriptions(bus_url: str) -> None:
    bus = LcmBus(parse_url(bus_url))
    bus.close()
    with pytest.raises(BusError, match="closed"):
        bus.publish("a", b"")
    with pytest.raises(BusError, match="closed"):
        bus.subscribe("a", lambda _payload, _time: None)
    bus.unsubscribe("a", lambda _payload, _time: None)


def test_closing_ends_the_threads_and_frees_the_descriptors(bus_url: str) -> None:
    def descriptors() -> int:
        import os

        return len(os.listdir("/proc/self/fd"))

    LcmBus(parse_url(bus_url)).close()
    threads, files = threading.active_count(), descriptors()
    for _ in range(10):
        bus = LcmBus(parse_url(bus_url))
        bus.subscribe("a", lambda _payload, _time: None)
        bus.publish("a", bytes(130_000))
        bus.close()
    assert threading.active_count() == threads
    assert descriptors() == files


def test_a_bus_within_the_process_works_without_a_network(wait_until: WaitUntil) -> None:
    bus = LcmBus(parse_url("memq://"))
    heard: list[bytes] = []
    bus.subscribe("a.b", lambda payload, _: heard.append(payload))
    bus.publish("aXb", b"decoy")
    bus.publish("a.b", b"x")
    bus.publish("a.b", bytes(1_000_000))
    wait_until(lambda: len(heard) == 2)
    assert heard == [b"x", bytes(1_000_000)]
    assert bus.ports == []
    bus.close()
