"""Subscriptions: the newest messages are kept, and nothing that comes can stop the node."""

import pytest
from fixtures.fake_bus import FakeBus
from fixtures.says import assert_says, raises_saying

import lcmtools
from lcmtools import Node
from lcmtools.errors import DecodeError, InvalidName
from lcmtools.messages.codec import encode
from lcmtools.node.subscription import Losses, Subscription
from lcmtools.types.geometry_msgs import Twist, TwistStamped
from lcmtools.types.sensor_msgs import Image
from lcmtools.types.std_msgs import Int32, String


def _number(value):
    message = Int32()
    message.data = value
    return encode(message)


def _text(value):
    message = String()
    message.data = value
    return encode(message)


def test_of_a_hundred_messages_the_ten_newest_are_kept_and_the_others_counted(begin, bus):
    begin()
    node, heard = Node("a"), []
    subscription = node.create_subscription(Int32, "n", lambda m: heard.append(m.data))
    for value in range(100):
        bus.publish("/n", _number(value))
    lcmtools.spin_once(node)
    assert heard == list(range(90, 100))
    assert subscription.drops == 90
    endpoint = subscription.endpoint()
    assert (endpoint.messages, endpoint.bytes, endpoint.drops) == (100, 1200, 90)
    assert endpoint.depth == 10
    assert endpoint.last_time > 0


def test_messages_that_come_during_a_slow_callback_are_kept_the_same_way(begin, bus):
    begin()
    node, heard = Node("a"), []

    def slow(message):
        heard.append(message.data)
        if message.data == 0:
            for value in range(1, 101):
                bus.publish("/n", _number(value))

    subscription = node.create_subscription(Int32, "n", slow)
    bus.publish("/n", _number(0))
    lcmtools.spin_once(node)
    lcmtools.spin_once(node)
    assert heard == [0, *range(91, 101)]
    assert subscription.drops == 90


def test_what_waits_when_ctrl_c_comes_in_a_callback_is_delivered_later(begin, bus):
    begin()
    node, heard = Node("a"), []

    def interrupted(message):
        heard.append(message.data)
        if message.data == 0:
            raise KeyboardInterrupt

    node.create_subscription(Int32, "n", interrupted)
    bus.publish("/n", _number(0))
    bus.publish("/n", _number(1))
    with pytest.raises(KeyboardInterrupt):
        lcmtools.spin_once(node)
    lcmtools.spin_once(node)
    assert heard == [0, 1]


def test_a_message_that_comes_while_its_subscription_is_made_is_not_left_behind(begin):
    """Another thread may make it, and the spinning one looks in vain between the two steps."""

    class EagerBus(FakeBus):
        def subscribe(self, channel, handler, *, is_large=False):
            super().subscribe(channel, handler, is_large=is_large)
            if channel == "/n":
                self.publish("/n", _number(1))
                lcmtools.spin_once(node)

    begin(bus=EagerBus())
    node, heard = Node("a"), []
    node.create_subscription(Int32, "n", lambda m: heard.append(m.data))
    lcmtools.spin_once(node)
    assert heard == [1]


def test_two_nodes_of_a_process_each_get_theirs_whoever_spins_first(begin, bus):
    begin()
    first, second = Node("a"), Node("b")
    heard = []
    first.create_subscription(Int32, "n", lambda _: heard.append("a"))
    second.create_subscription(Int32, "n", lambda _: heard.append("b"))
    bus.publish("/n", _number(0))
    lcmtools.spin_once(second)
    lcmtools.spin_once(first)
    assert heard == ["b", "a"]


@pytest.mark.parametrize(("depth", "kept"), [(1, 1), (3, 3), (0, 1), (-5, 1), (1000, 20)])
def test_the_depth_is_how_many_wait(begin, bus, depth, kept):
    begin()
    node, heard = Node("a"), []
    node.create_subscription(Int32, "n", lambda m: heard.append(m.data), depth)
    for value in range(20):
        bus.publish("/n", _number(value))
    lcmtools.spin_once(node)
    assert heard == list(range(20 - kept, 20))


def test_a_callback_that_raises_is_logged_with_topic_and_traceback_and_the_node_goes_on(
    begin, bus, capsys
):
    begin()
    node, heard = Node("a"), []

    def fail(message):
        heard.append(message.data)
        raise RuntimeError(f"no {message.data}")

    node.create_subscription(Int32, "n", fail)
    node.create_subscription(Int32, "n", lambda m: heard.append(10 * m.data))
    bus.publish("/n", _number(1))
    bus.publish("/n", _number(2))
    lcmtools.spin_once(node)
    assert heard == [1, 10, 2, 20]
    log = capsys.readouterr().err
    assert log.count("[ERROR]") == 1
    assert_says(log, "[/a]: ", "/n", "RuntimeError: no 1")
    assert "Traceback (most recent call last):" in log
    assert 'raise RuntimeError(f"no {message.data}")' in log


def test_a_broken_off_callback_ends_the_spin(begin, bus):
    begin()
    node = Node("a")

    def interrupted(_message):
        raise KeyboardInterrupt

    node.create_subscription(Int32, "n", interrupted)
    bus.publish("/n", _number(1))
    with pytest.raises(KeyboardInterrupt):
        lcmtools.spin_once(node)
    bus.publish("/n", _number(1))
    lcmtools.spin(node)


@pytest.mark.parametrize(
    ("payload", "what"),
    [
        (_text("x"), "expected std_msgs/Int32, got std_msgs/String"),
        (_number(7)[:-1], "broken std_msgs/Int32"),
        (b"", "expected std_msgs/Int32, got 0 bytes, which are not an LCM message"),
        (b"1234567", "expected std_msgs/Int32, got 7 bytes, which are not an LCM message"),
        (b"payload\0", "expected std_msgs/Int32, got an unknown type (fingerprint 0x7061796c6f616"),
    ],
)
def test_what_is_no_such_message_is_one_warning_and_ignored(begin, bus, capsys, payload, what):
    begin()
    node, heard = Node("a"), []
    node.create_subscription(Int32, "n", lambda m: heard.append(m.data))
    for _ in range(50):
        bus.publish("/n", payload)
        bus.publish("/n", _number(5))
        lcmtools.spin_once(node)
    assert heard == [5] * 50
    log = capsys.readouterr().err
    assert log.count("\n") == 1
    assert "[WARN]" in log
    assert f"/n: message ignored: {what}" in log


def test_each_topic_with_such_messages_gets_its_warning(begin, bus, capsys):
    begin()
    node = Node("a")
    for topic in ("n", "m"):
        node.create_subscription(Int32, topic, print)
        bus.publish(f"/{topic}", _text("x"))
        bus.publish(f"/{topic}", _text("x"))
    lcmtools.spin_once(node)
    log = capsys.readouterr().err
    assert log.count("\n") == 2
    assert "/n: message ignored" in log
    assert "/m: message ignored" in log


def test_bytes_after_a_message_do_not_matter(begin, bus):
    begin()
    node, heard = Node("a"), []
    node.create_subscription(Int32, "n", lambda m: heard.append(m.data))
    bus.publish("/n", _number(5) + b"more")
    lcmtools.spin_once(node)
    assert heard == [5]


def test_several_types_on_one_topic_are_told_apart_by_their_fingerprints(begin, bus):
    begin()
    node, heard = Node("a"), []
    subscription = node.create_subscription((Twist, TwistStamped), "cmd", heard.append)
    for message in (TwistStamped(), Twist(), TwistStamped()):
        bus.publish("/cmd", encode(message))
    lcmtools.spin_once(node)
    assert [type(message) for message in heard] == [TwistStamped, Twist, TwistStamped]
    assert subscription.endpoint().types == ("geometry_msgs/Twist", "geometry_msgs/TwistStamped")
    assert subscription.endpoint().type == "geometry_msgs/Twist"


def test_a_message_of_none_of_several_types_names_them_all():
    subscription = Subscription((Twist, TwistStamped), "/cmd", print, 1)
    types = ("geometry_msgs/Twist", "geometry_msgs/TwistStamped", "std_msgs/String")
    with raises_saying(DecodeError, "expected", *types):
        subscription.decode(_text("x"))


def test_the_group_is_announced(begin):
    begin()
    node = Node("a")
    node.create_subscription(Int32, "n", print, group="speed")
    assert [e.group for e in node.describe().endpoints if e.topic == "/n"] == ["speed"]


def test_an_illegal_topic_is_refused_and_leaves_nothing(begin):
    begin()
    node = Node("a")
    before = node.describe()
    for topic in ("a b", "a" * 80):
        with pytest.raises(InvalidName):
            node.create_subscription(Int32, topic, print)
        with pytest.raises(InvalidName):
            node.create_publisher(Int32, topic)
    assert node.describe() == before


def test_a_destroyed_node_calls_nobody_any_more(begin, bus):
    begin()
    node, heard = Node("a"), []

    def last(message):
        heard.append(message.data)
        node.destroy_node()

    node.create_subscription(Int32, "n", last)
    node.create_subscription(Int32, "n", lambda m: heard.append(10 * m.data))
    node.create_timer(1e-9, lambda: heard.append(-1))
    for value in (1, 2, 3):
        bus.publish("/n", _number(value))
    lcmtools.spin_once(node)
    bus.publish("/n", _number(4))
    lcmtools.spin_once(node)
    assert heard == [1]


def test_a_destroyed_subscription_calls_nobody_though_messages_wait(begin, bus):
    begin()
    node, heard = Node("a"), []

    def last(message):
        heard.append(message.data)
        for one in (first, second):
            node.destroy_subscription(one)
            node.destroy_subscription(one)

    first = node.create_subscription(Int32, "n", last)
    second = node.create_subscription(Int32, "n", lambda m: heard.append(10 * m.data))
    for value in (1, 2, 3):
        bus.publish("/n", _number(value))
    lcmtools.spin_once(node)
    second.receive(_number(4), 0)
    lcmtools.spin_once(node)
    assert heard == [1]
    assert second.pop() is None


class _LossyBus(FakeBus):
    """A bus that has lost something before, and loses more."""

    is_later = False
    large: tuple[str, ...] = ()

    @property
    def overflows(self):
        return 7

    def lost(self, channel):
        return 5 if channel == "/n" and self.is_later else 2

    def subscribe(self, channel, handler, *, is_large=False):
        super().subscribe(channel, handler)
        self.large += (channel,) * is_large


def test_a_subscription_tells_what_it_has_lost(begin):
    bus = _LossyBus()
    begin(bus=bus)
    node = Node("a")
    numbers = node.create_subscription(Int32, "n", lambda _: None, depth=1)
    node.create_subscription(Image, "image", lambda _: None)
    bus.is_later = True
    for value in range(3):
        bus.publish("/n", _number(value))
    assert numbers.losses() == Losses(displaced=2, incomplete=3, overflows=7)
    assert (numbers.endpoint().incomplete, node.describe().overflows) == (3, 7)
    assert bus.large == ("/image",)
