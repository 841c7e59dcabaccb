"""Publishing and calling services for pages, with one node of the server."""

import threading
from contextlib import ExitStack
from typing import TypeVar, cast

from lcmtools.bounded import BoundedDict
from lcmtools.bus.url import BusUrl
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.names import check_channel
from lcmtools.node.node import Node
from lcmtools.node.publisher import PayloadPublisher
from lcmtools.node.service import Client, ServiceType
from lcmtools.publish.temporary_node import temporary_node

_MOST_ANSWERS, _MOST_ANSWER_BYTES = 300, 64_000_000
RequestT = TypeVar("RequestT", bound=Message)
ResponseT = TypeVar("ResponseT", bound=Message)


class Answers:
    """The latest answers of services, by their numbers; for any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = 0
        self._kept = BoundedDict[int, Message](_MOST_ANSWERS, _MOST_ANSWER_BYTES)

    def keep(self, answer: Message) -> int:
        """Keep an answer; return its number."""
        with self._lock:
            self._count += 1
            self._kept.put(self._count, answer, len(encode(answer)))
            return self._count

    def get(self, number: int) -> Message | None:
        """Return an answer; None if it is no longer kept."""
        return self._kept.get(number)


class Publishers:
    """The publishers of a server, created when first needed; for any thread."""

    def __init__(self, url: BusUrl) -> None:
        self._url = url
        self._lock = threading.RLock()
        self._stack = ExitStack()
        self._node: Node | None = None
        self._publishers: dict[tuple[str, tuple[str, int]], PayloadPublisher] = {}
        self._clients: dict[tuple[str, object], object] = {}
        self._is_ending = threading.Event()
        self.answers = Answers()

    @property
    def node(self) -> Node:
        """The node, hidden like that of ``lcmtools pub``; BusError if the bus cannot be reached."""
        with self._lock:
            if self._node is None:
                self._node = self._stack.enter_context(temporary_node("gui", self._url))
            return self._node

    def publish(self, topic: str, kind: type[Message], payload: bytes) -> None:
        """Publish a message of a type, encoded; see ``publish_payload``."""
        self.publish_payload(topic, (type_name(kind), fingerprint(kind)), payload)

    def publish_payload(self, topic: str, kind: tuple[str, int], payload: bytes) -> None:
        """Publish a payload on the channel of this name, with its type's name and fingerprint.

        Raises:
            BusError: The bus cannot be reached, or does not accept it.
            InvalidName: LCM cannot carry this name.
        """
        with self._lock:
            if (topic, kind) not in self._publishers:
                made = self.node.create_payload_publisher(check_channel(topic), *kind)
                self._publishers[topic, kind] = made
            self._publishers[topic, kind].publish_payload(payload)

    def client(
        self, kind: ServiceType[RequestT, ResponseT], name: str
    ) -> Client[RequestT, ResponseT]:
        """Return a client of a service by its full name; BusError if the bus cannot be reached."""
        with self._lock:
            if (name, kind) not in self._clients:
                client = self.node.create_client(kind, name)
                client.is_interrupted = self._is_ending.is_set
                self._clients[name, kind] = client
            return cast("Client[RequestT, ResponseT]", self._clients[name, kind])

    def end_calls(self) -> None:
        """Let calls that wait for an answer fail at once, because the server ends."""
        self._is_ending.set()

    def close(self) -> None:
        """Leave the bus."""
        with self._lock:
            self._publishers.clear()
            self._clients.clear()
            self._node = None
            self._stack.close()
