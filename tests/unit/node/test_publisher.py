"""Publishers: what they send, what they refuse, and who can hear them."""

import pytest
from fixtures.fake_bus import FakeBus
from fixtures.says import raises_saying

import lcmtools
from lcmtools import Node
from lcmtools.errors import BusError, InvalidName, ValueMismatch
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import fingerprint
from lcmtools.node.publisher import PayloadPublisher, publish_together
from lcmtools.types.geometry_msgs import Point, Vector3
from lcmtools.types.std_msgs import Int32, String


def test_a_message_goes_out_encoded_on_its_topic(begin, bus):
    begin("chatter:=/news")
    publisher = Node("a").create_publisher(String, "chatter")
    message = String()
    message.data = "hello"
    publisher.publish(message)
    sent = [payload for channel, payload in bus.published if channel == "/news"]
    assert [decode(String, payload).data for payload in sent] == ["hello"]
    endpoint = publisher.endpoint()
    assert (endpoint.topic, endpoint.role, endpoint.types) == (
        "/news",
        Role.PUBLISHER,
        ("std_msgs/String",),
    )
    assert (endpoint.messages, endpoint.bytes) == (1, len(sent[0]))
    assert endpoint.last_time > 0


def test_messages_are_counted_whether_the_bus_sends_them_together_or_not():
    class HalfBus(FakeBus):
        def publish_together(self, messages):
            for message in messages[::2]:
                self.deliver(*message)
            return range(1, len(messages), 2)

    bus = HalfBus()
    publishers = [PayloadPublisher(bus, ("", None), f"/{n}", 10, Graph) for n in range(10)]
    messages = [(one, b"x" * place) for place, one in enumerate(publishers)]
    publish_together(bus, messages)
    assert bus.published == [(f"/{n}", b"x" * n) for n in (0, 2, 4, 6, 8, 1, 3, 5, 7, 9)]
    ends = [publisher.endpoint() for publisher in publishers]
    assert [(end.messages, end.bytes) for end in ends] == [(1, n) for n in range(10)]
    assert all(end.last_time > 0 for end in ends)


@pytest.mark.parametrize(
    ("message", "name"),
    [(Int32(), "std_msgs/Int32"), ("hello", "'hello'"), (None, "None"), ({}, "a mapping")],
)
def test_a_message_of_another_type_is_refused(begin, message, name):
    begin()
    publisher = Node("a").create_publisher(String, "chatter")
    with raises_saying(ValueMismatch, "/chatter: expected std_msgs/String", name):
        publisher.publish(message)
    assert publisher.endpoint().messages == 0


def test_a_type_with_the_same_fields_is_another_type_all_the_same(begin):
    begin()
    publisher = Node("a").create_publisher(Point, "p")
    with raises_saying(ValueMismatch, "geometry_msgs/Point", "geometry_msgs/Vector3"):
        publisher.publish(Vector3())


def test_a_value_that_does_not_fit_names_its_field(begin):
    begin()
    publisher = Node("a").create_publisher(Int32, "n")
    message = Int32()
    message.data = 1 << 31
    with pytest.raises(ValueMismatch, match="data"):
        publisher.publish(message)


def test_a_literal_topic_is_the_channel_to_the_letter(begin, bus):
    begin("__ns:=/husky0", "EXAMPLE:=/other")
    node = Node("a")
    publisher = node.create_publisher(String, "EXAMPLE", plain_channel=True)
    publisher.publish(String())
    assert "EXAMPLE" in [channel for channel, _ in bus.published]
    assert node.create_publisher(String, "été #1", plain_channel=True).topic == "été #1"
    with pytest.raises(InvalidName):
        node.create_publisher(String, "a" * 64, plain_channel=True)


class _Refusing(FakeBus):
    """A bus that takes no messages on one channel."""

    def deliver(self, channel, payload):
        if channel in ("/chatter", "/rosout"):
            raise BusError(f"cannot publish on {channel}")
        super().deliver(channel, payload)


def test_a_message_that_cannot_leave_is_lost_and_the_log_says_so_once(begin, capsys):
    begin(bus=_Refusing())
    publisher = Node("a").create_publisher(String, "chatter")
    for _ in range(10):
        publisher.publish(String())
    log = capsys.readouterr().err
    assert log.count("\n") == 1
    assert "[/a]: cannot publish on /chatter" in log
    assert publisher.endpoint().messages == 0


def test_a_tools_message_that_cannot_leave_is_an_error(begin):
    begin(bus=_Refusing())
    with pytest.raises(BusError, match="cannot publish on /chatter"):
        Node("a", tool=True).create_publisher(String, "chatter").publish(String())


def test_publishing_when_the_bus_was_left_is_a_line_in_the_log(begin, capsys):
    context = begin()
    publisher = Node("a").create_publisher(String, "chatter")
    context.close()
    publisher.publish(String())
    assert "the bus is closed" in capsys.readouterr().err


def _hear_of(bus, identity, *endpoints, leaving=False):
    node = NodeInfo(f"/{identity}", identity, "h", 1, endpoints=endpoints)
    bus.publish(NODE_CHANNEL, encode_announcement(Announcement(node, leaving)))


def test_nodes_that_can_hear_a_publisher_are_counted(begin, bus):
    begin()
    node = Node("a")
    publisher = node.create_publisher(String, "chatter")
    assert publisher.subscriber_count() == 0
    fitting = Endpoint("/chatter", Role.SUBSCRIBER, ("std_msgs/String",), (fingerprint(String),))
    other = Endpoint("/chatter", Role.SUBSCRIBER, ("std_msgs/Int32",), (fingerprint(Int32),))
    both = Endpoint("/chatter", Role.SUBSCRIBER, (), (fingerprint(Int32), fingerprint(String)))
    _hear_of(bus, "fitting", fitting, fitting)
    _hear_of(bus, "other", other)
    _hear_of(bus, "both", both)
    _hear_of(bus, "any", Endpoint("/chatter", Role.SUBSCRIBER))
    _hear_of(bus, "elsewhere", Endpoint("/news", Role.SUBSCRIBER))
    _hear_of(bus, "publisher", Endpoint("/chatter", Role.PUBLISHER))
    assert publisher.subscriber_ids() == {"fitting", "both", "any"}
    assert publisher.subscriber_count() == 3
    _hear_of(bus, "fitting", leaving=True)
    assert publisher.subscriber_count() == 2


def test_a_process_counts_its_own_subscriptions(begin, wait_until):
    begin()
    publisher = Node("a").create_publisher(String, "chatter")
    Node("b").create_subscription(String, "chatter", print)
    wait_until(lambda: publisher.subscriber_count() == 1)


def test_a_change_of_the_graph_wakes_who_waits_for_it(begin, bus):
    begin()
    node = Node("a")
    publisher = node.create_publisher(String, "chatter")
    assert publisher.subscriber_count() == 0
    lcmtools.spin_once(node, 0.0)
    _hear_of(bus, "b", Endpoint("/chatter", Role.SUBSCRIBER))
    assert publisher.subscriber_count() == 1
