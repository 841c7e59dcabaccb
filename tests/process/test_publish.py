"""``lcmtools.publish.publish``, called from Python."""

from itertools import count

import pytest
from fixtures.says import assert_says

from lcmtools.arguments import NodeArguments
from lcmtools.errors import NothingReceived, UnknownType, ValueMismatch
from lcmtools.publish import publish
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import Int32

STRING = "std_msgs/String"
_topics = count()

pytestmark = pytest.mark.usefixtures("use_module_bus")


@pytest.fixture
def topic():
    """A topic of the test's own."""
    return f"/publish{next(_topics)}"


def _twist():
    twist = Twist()
    twist.linear.x = 0.5
    return twist


@pytest.mark.parametrize(
    "value", [_twist(), {"linear": [0.5, 0, 0]}, [[0.5, 0, 0], [0, 0, 0]], "linear: {x: 0.5}"]
)
def test_a_message_is_sent_so_many_times(value, topic, receiver):
    received = receiver.subscribe(topic, "geometry_msgs/Twist")
    assert publish(topic, Twist, value, count=2, rate=100) == 2
    assert [message["linear"]["x"] for message in received()] == [0.5, 0.5]


def test_messages_of_an_iterator_are_sent_as_they_come(topic, receiver):
    received = receiver.subscribe(topic)
    sent = []

    def texts():
        for text in "ab":
            yield text
            sent.append(text)

    told = []
    number = publish(
        topic,
        STRING,
        texts(),
        on_sent=lambda n, message, again: told.append((n, message.data, again)),
    )
    assert (number, sent) == (2, ["a", "b"])
    assert told == [(1, "a", False), (2, "b", False)]
    assert received() == [{"data": "a"}, {"data": "b"}]


def test_names_and_what_a_person_reads_are_given(topic, receiver):
    received = receiver.subscribe(f"/robot{topic}")
    notes = []
    arguments = NodeArguments(namespace="/robot")
    assert publish(topic[1:], STRING, "x", count=1, arguments=arguments) == 1
    assert received() == [{"data": "x"}]
    assert publish("nobody", STRING, "x", count=1, notify=notes.append) == 1
    (note,) = notes
    assert_says(note, "no node", "/nobody", "; publishing anyway")


def test_what_cannot_be_sent_raises(topic):
    with pytest.raises(NothingReceived, match=r"not within 0\.1 s: 1 subscriber"):
        publish(topic, STRING, "x", count=1, subscribers=1, timeout=0.1)
    with pytest.raises(ValueMismatch, match="data"):
        publish(topic, STRING, {"dta": "x"}, count=1)
    with pytest.raises(ValueMismatch, match="Int32"):
        publish(topic, STRING, Int32(), count=1)
    with pytest.raises(UnknownType):
        publish(topic, "std_msgs/Strung", "x", count=1)
