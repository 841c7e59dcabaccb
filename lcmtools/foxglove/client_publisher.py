"""Publishing clients' messages on the bus, only on topics that the user allows."""

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from lcmtools.bag.choice import RecordedTopics
from lcmtools.errors import LcmtoolsError
from lcmtools.foxglove.schemas import ENCODINGS, Schemas
from lcmtools.messages.registry import Message, message_class, type_name
from lcmtools.node.node import Node
from lcmtools.node.publisher import Publisher

if TYPE_CHECKING:
    from foxglove.websocket import ClientChannel


class Publishing:
    """Publishes clients' messages on the bus. Its methods are called on the server's threads.

    ``refuse`` is called with the reason why something is not published.
    """

    encodings = ENCODINGS

    def __init__(
        self, node: Node, allowed: RecordedTopics, schemas: Schemas, refuse: Callable[[str], None]
    ) -> None:
        self._node, self._allowed, self._schemas, self._refuse = node, allowed, schemas, refuse
        self._lock = threading.Lock()
        # By client and its channel; each with the encoding of the messages.
        self._publishers: dict[tuple[int, int], tuple[Publisher[Message], str]] = {}

    def advertise(self, client: int, channel: "ClientChannel") -> None:
        """Allow publishing on a channel, if permitted and its type is known."""
        try:
            with self._lock:
                cls = self._class_of(channel)
                publisher = self._node.create_publisher(cls, channel.topic, plain_channel=True)
                self._publishers[client, channel.id] = publisher, channel.encoding
        except LcmtoolsError as error:
            self._refuse(f"cannot publish on {channel.topic}: {error}")

    def dismiss(self, client: int, channel: int) -> None:
        """Stop publishing on a channel."""
        with self._lock:
            publisher, _ = self._publishers.pop((client, channel), (None, ""))
            if publisher is not None:
                self._node.destroy_publisher(publisher)

    def publish(self, client: int, channel: int, data: bytes) -> None:
        """Publish a message; one on a channel that was refused is dropped."""
        with self._lock:
            publisher, encoding = self._publishers.get((client, channel), (None, ""))
            if publisher is None:
                return
            try:
                publisher.publish(self._schemas.read(publisher.message_type, encoding, data))
            except LcmtoolsError as error:
                self._refuse(f"a message for {publisher.topic} is not published: {error}")

    def _class_of(self, channel: "ClientChannel") -> type[Message]:
        topic = channel.topic
        if not self._allowed.includes(topic):
            raise LcmtoolsError("it is not allowed", f"--allow-publish {topic} allows it")
        cls = message_class(channel.schema_name)
        known = self._node.graph().topic(topic).types
        if known and type_name(cls) not in known:
            raise LcmtoolsError(f"it has the type {known[0]}, not {type_name(cls)}")
        return cls
