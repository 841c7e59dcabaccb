"""The way of messages to callbacks: at once where they are received, or through a queue."""

import threading
import time
import traceback

import pytest

import lcmtools
from lcmtools import Node
from lcmtools.arguments import NodeArguments
from lcmtools.bus.url import parse_url
from lcmtools.node.process import open_context
from lcmtools.types.std_msgs import UInt32

_LONG = 20.0  # [s]


@pytest.fixture
def node(bus_url):
    """A node of this process's context."""
    lcmtools.init([], url=bus_url, handle_signals=False)
    yield Node("node")
    lcmtools.shutdown()


@pytest.fixture
def publishers(bus_url):
    """``publishers("/a")``: a publisher of another program, as it were."""
    context = open_context(parse_url(bus_url), NodeArguments())
    other = Node("other", context=context)
    yield lambda topic: other.create_publisher(UInt32, topic)
    context.close()


def _spin_until(node, is_done):
    deadline = time.monotonic() + _LONG
    while not is_done() and time.monotonic() < deadline:
        lcmtools.spin_once(node, 0.05)
    assert is_done()


def test_a_message_that_is_awaited_goes_through_no_queue(node, publishers):
    publisher, frames = publishers("/a"), list[list[str]]()
    node.create_subscription(
        UInt32, "/a", lambda _: frames.append([one.name for one in traceback.extract_stack()])
    )

    def is_straight():  # unless the computer was busy just then
        publisher.publish(UInt32(1))
        return any("receive" in names and "run_ready" not in names for names in frames)

    _spin_until(node, is_straight)


def test_a_callback_that_spins_another_node_runs_none_of_its_own(node, publishers):
    own, others = publishers("/own"), publishers("/others")
    heard = []
    inner = Node("inner")
    inner.create_subscription(UInt32, "/others", lambda _: heard.append("others"))

    def nest(message):
        heard.append(f"own {message.data}")
        if message.data == 1:
            own.publish(UInt32(2))
            others.publish(UInt32(1))
            _spin_until(inner, lambda: "others" in heard)
            heard.append("end")

    node.create_subscription(UInt32, "/own", nest)
    own.publish(UInt32(1))
    _spin_until(node, lambda: "own 2" in heard)
    assert heard == ["own 1", "others", "end", "own 2"]


@pytest.mark.parametrize("seconds", [0.004, 0.04])
def test_of_messages_that_come_faster_than_their_callback_the_newest_are_kept_and_all_counted(
    node, publishers, seconds
):
    publisher, heard, count = publishers("/a"), list[int](), 500

    def take(message):
        heard.append(message.data)
        time.sleep(seconds)

    subscription = node.create_subscription(UInt32, "/a", take, 3)
    sent = iter(range(count))

    def send():
        for number in sent:
            publisher.publish(UInt32(number))
            time.sleep(0.001)

    thread = threading.Thread(target=send)
    thread.start()
    _spin_until(node, lambda: heard and heard[-1] == count - 1)
    thread.join()
    assert heard == sorted(heard)
    assert len(heard) + subscription.drops == count
    assert subscription.drops > 0


def test_a_small_message_does_not_overtake_a_large_one(node, publishers):
    sizes = []
    node.context.bus.subscribe("/a", lambda payload, _: sizes.append(len(payload)), is_large=True)
    publisher = publishers("/a")
    for _ in range(3):
        publisher.publish_payload(bytes(300_000))
        publisher.publish(UInt32(1))
    _spin_until(node, lambda: len(sizes) == 6)
    assert sizes == [300_000, 12] * 3
