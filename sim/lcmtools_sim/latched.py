"""Topics whose last message each new subscriber gets, like latched topics in ROS."""

from collections.abc import Callable
from typing import Generic, TypeVar

from lcmtools import Node
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message

_PERIOD = 0.1  # [s]; the longest delay for a new subscriber
_REPEAT = 10  # periods

MessageT = TypeVar("MessageT", bound=Message)


class LatchedPublisher(Generic[MessageT]):
    """Publishes a message to each new subscriber, and again from time to time.

    ``make`` creates the message when it is needed. ``is_repeated`` is called once a second and
    returns whether to publish it again.
    """

    def __init__(
        self,
        node: Node,
        message_type: type[MessageT],
        topic: str,
        make: Callable[[], MessageT],
        is_repeated: Callable[[], bool],
    ) -> None:
        self._publisher = node.create_publisher(message_type, topic)
        self._publisher.is_latched = True
        self._make, self._is_repeated = make, is_repeated
        self._payload = b""
        self._subscribers: frozenset[str] = frozenset()
        self._count = 0
        node.create_timer(_PERIOD, self._publish_if_due)

    @property
    def has_subscribers(self) -> bool:
        """True while a node subscribes."""
        return bool(self._subscribers)

    def renew(self) -> None:
        """Publish the message anew to all subscribers, because it has changed."""
        self._payload, self._subscribers = b"", frozenset()

    def _publish_if_due(self) -> None:
        self._count += 1
        subscribers = self._publisher.subscriber_ids()
        is_time = self._count % _REPEAT == 0 and self._is_repeated()
        if is_time or subscribers - self._subscribers:
            self._payload = self._payload or encode(self._make())
            self._publisher.publish_payload(self._payload)
        self._subscribers = subscribers
