"""Publishers."""

import time
from collections.abc import Callable, Collection, Sequence
from typing import Generic, TypeVar

from lcmtools.bus.base import Bus
from lcmtools.errors import BusError, BusOfParent, UsageError, ValueMismatch, explained
from lcmtools.graph.model import Endpoint, Graph, Role
from lcmtools.messages.codec import PayloadEncoder
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.node.checks import misfit

MessageT = TypeVar("MessageT", bound=Message)
_FEW = 8  # messages: for up to this many, comparing sizes costs more than it saves


class PayloadPublisher:
    """Sends payloads, messages that are already encoded, on one topic.

    Made by ``Node.create_payload_publisher``; the class of the messages need not be known.

    Attributes:
        topic: The resolved topic, which is the LCM channel.
        depth: The requested queue depth, only announced: LCM sends at once.
        is_latched: Announced; True if the last message is sent again to each new subscriber.
    """

    def __init__(
        self,
        bus: Bus,
        kind: tuple[str, int | None],
        topic: str,
        depth: int,
        graph: Callable[[], Graph],
    ) -> None:
        self.topic = topic
        self.depth = depth
        self.is_destroyed = self.is_latched = False
        self._bus = bus
        self.on_failure: Callable[[BusError], None] | None = None
        """Called when a message cannot be sent; None to have ``publish`` raise instead."""
        self._send = bus.shortcut(topic)
        self._graph = graph
        self._type_name, self._fingerprint = kind
        self._messages = 0
        self._bytes = 0
        self._last_time = 0

    def publish_payload(self, payload: bytes) -> None:
        """Send a message that is already encoded.

        Raises:
            BusOfParent: This is a forked process, and the publisher is its parent's.
        """
        try:
            self._bus.publish(self.topic, payload, self._type_name, latched=self.is_latched)
        except BusError as error:
            if self.on_failure is None or isinstance(error, BusOfParent):
                raise
            self.on_failure(error)
            return
        self.count(payload, time.time_ns())

    def count(self, payload: bytes, now: int) -> None:
        """Count a message that was sent at this time, for the announced description."""
        self._messages += 1
        self._bytes += len(payload)
        self._last_time = now

    def subscriber_count(self) -> int:
        """Return the number of nodes with an announced subscription that matches this publisher.

        Plain LCM programs never announce theirs and are not counted.
        """
        return len(self.subscriber_ids())

    def subscriber_ids(self) -> frozenset[str]:
        """Return the ids of the nodes with announced subscriptions that match this publisher."""
        ends = self._graph().topic(self.topic).subscribers
        alive = ((node.id, end.fingerprints) for node, end in ends if not node.stale)
        return frozenset(id_ for id_, known in alive if not known or self._fingerprint in known)

    def endpoint(self) -> Endpoint:
        """Return the announced description."""
        return Endpoint(
            topic=self.topic,
            role=Role.PUBLISHER,
            types=(self._type_name,) if self._type_name else (),
            fingerprints=() if self._fingerprint is None else (self._fingerprint,),
            depth=self.depth,
            latched=self.is_latched,
            messages=self._messages,
            bytes=self._bytes,
            last_time=self._last_time,
        )


def publish_together(bus: Bus, messages: Sequence[tuple[PayloadPublisher, bytes]]) -> None:
    """Send messages of one bus's publishers; their order may change.

    If the bus supports it, messages of the same size cost far less together than one by one.
    """
    left: Collection[int] = range(len(messages))
    if len(messages) > _FEW:
        left = set(bus.publish_together([(one.topic, payload) for one, payload in messages]))
    now = time.time_ns()
    for place, (publisher, payload) in enumerate(messages):
        if place in left:
            publisher.publish_payload(payload)
        else:
            publisher.count(payload, now)


class Publisher(PayloadPublisher, Generic[MessageT]):
    """Sends messages of one type on one topic. Made by ``Node.create_publisher``.

    Attributes:
        message_type: The class of its messages.
    """

    def __init__(
        self,
        bus: Bus,
        message_type: type[MessageT],
        topic: str,
        depth: int,
        graph: Callable[[], Graph],
    ) -> None:
        kind = type_name(message_type), fingerprint(message_type)
        super().__init__(bus, kind, topic, depth, graph)
        self.message_type = message_type
        self._encode = PayloadEncoder(message_type).encode

    @explained
    def publish(self, message: MessageT) -> None:
        """Encode and send one message. Its length fields are set first.

        A message that the network does not accept is lost, as any LCM message may be; the log
        reports it.

        Raises:
            ValueMismatch: The message is of another type, or a field's value does not fit.
            UsageError: The publisher was destroyed.
            BusOfParent: This is a forked process, and the publisher is its parent's.
        """
        if not isinstance(message, self.message_type):
            raise misfit(self.topic, self._type_name, self.message_type, message)
        if self.is_destroyed:
            raise UsageError(f"the publisher of {self.topic} was destroyed and sends nothing")
        try:
            payload = self._encode(message)
        except ValueMismatch as error:
            what = error.what.removeprefix(f"{self._type_name}: ")
            raise ValueMismatch(f"{self.topic}: {self._type_name}: {what}", error.hint) from None
        try:
            is_sent = self._send(payload)
        except OSError:
            is_sent = False
        if is_sent:  # as ``publish_payload``, without another call
            self._messages += 1
            self._bytes += len(payload)
            self._last_time = time.time_ns()
        else:
            self.publish_payload(payload)
