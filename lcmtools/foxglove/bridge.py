"""The flow from a bus to Foxglove: a channel for each topic, and the messages that it requests.

Only topics that a client subscribes to are decoded and translated; of latched topics the last
message is kept undecoded, for clients that subscribe later.
"""

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

from lcmtools.bag.choice import RecordedTopics
from lcmtools.errors import BusError, DecodeError, LcmtoolsError
from lcmtools.foxglove.client_publisher import Publishing
from lcmtools.foxglove.schemas import Schemas
from lcmtools.foxglove.websocket import FoxgloveServer
from lcmtools.graph.model import Ends, Graph, Topic
from lcmtools.messages.registry import Message, message_class, type_name
from lcmtools.node.node import Node
from lcmtools.observe.reading.decoding import Decoder, possible_types, remedy_of_unknown
from lcmtools.observe.reading.following import Following
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    from foxglove import Channel
    from foxglove.websocket import ChannelView, Client, ClientChannel

_TURN = 0.05  # [s] at most until a client's request is handled
_LOOK_PERIOD = 0.4  # [s] between updates from the graph
_AGAIN = 0.5  # [s] before a failed network is tried again
_MOST_TOLD = 1000  # different sentences
_AT_ONCE = 32  # topics offered together: clients with too many waiting messages are disconnected


@dataclass(slots=True)
class _Offer:
    """A topic that clients see."""

    cls: type[Message]
    channel: "Channel"
    is_latched: bool = False
    last: Packet | None = None  # last message of a latched topic
    end: Callable[[], None] | None = None  # stops following it; None if not followed


class Bridge(AbstractContextManager["Bridge"]):
    """A bridge from a bus to Foxglove; the owner of the monitor closes it.

    ``node`` publishes clients' messages on the ``allowed`` topics; None if clients may not publish.
    ``notify`` is called with sentences for the user.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        topics: RecordedTopics,
        notify: Callable[[str], None],
        node: Node | None = None,
        allowed: RecordedTopics | None = None,
    ) -> None:
        self._monitor, self._topics, self._notify = monitor, topics, notify
        self._schemas = Schemas()
        self._decoder = Decoder(monitor.types_of)
        self._following = Following(monitor.url)
        self._offers: dict[str, _Offer] = {}
        self._subscribers: Counter[str] = Counter()
        self._wishes: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._told: set[str] = set()
        self._translating = threading.Lock()
        self._announced: list[str] = []
        self._trouble = ""
        self.publishing: Publishing | None = None
        if node is not None and allowed is not None:
            self.publishing = Publishing(node, allowed, self._schemas, self._refuse)

    def __exit__(self, *_: object) -> None:
        """Stop following topics."""
        self._following.close()

    def serve(self, server: FoxgloveServer, on_ready: Callable[[], None]) -> None:
        """Serve until an exception ends it, for example Ctrl-C.

        ``on_ready`` is called when all present topics are offered: the package sometimes refuses
        clients that subscribe to a topic at the moment it is offered.
        """
        self._monitor.discover()
        while self.update_offers(self._monitor.graph(), server):
            self._receive()
        on_ready()
        next_look = 0.0
        while True:
            trouble = self._receive()
            if trouble != self._trouble:
                self._trouble = trouble
                server.show_problem("bus", trouble)
                self._notify(trouble or "the bus is back")
            if time.monotonic() >= next_look:
                has_more = self.update_offers(self._monitor.graph(), server)
                next_look = time.monotonic() + (_TURN if has_more else _LOOK_PERIOD)

    # Called for clients' actions on the server's threads; names of ``ServerListener``

    def on_subscribe(self, _: "Client", channel: "ChannelView") -> None:
        """Note that a client subscribes to a topic."""
        self._wishes.put(partial(self._begin, channel.topic))

    def on_unsubscribe(self, _: "Client", channel: "ChannelView") -> None:
        """Note that a client no longer subscribes to a topic."""
        self._wishes.put(partial(self._end, channel.topic))

    def on_client_advertise(self, client: "Client", channel: "ClientChannel") -> None:
        """Note that a client wants to publish."""
        if self.publishing:
            self.publishing.advertise(client.id, channel)

    def on_client_unadvertise(self, client: "Client", channel: int) -> None:
        """Note that a client no longer wants to publish."""
        if self.publishing:
            self.publishing.dismiss(client.id, channel)

    def on_message_data(self, client: "Client", channel: int, data: bytes) -> None:
        """Take a client's message."""
        if self.publishing:
            self.publishing.publish(client.id, channel, data)

    def refuse_origin(self, origin: str) -> None:
        """Note that a page of a website was refused."""
        lets = f"--allow-origin {origin} lets it in"
        if origin == "null":  # also of any website's sandboxed frames
            lets = f"{lets}, and so may frames of any website"
        self._refuse(f"a page of {origin} was refused; {lets}")

    def _refuse(self, text: str) -> None:
        self._wishes.put(lambda: self._notify_once(text))

    # On the serving thread

    def _receive(self) -> str:
        """Pass on messages, handle requests; return the bus's problem, "" for none."""
        try:
            packets = self._monitor.receive(_TURN)
        except (BusError, OSError) as error:
            time.sleep(_AGAIN)
            return getattr(error, "strerror", None) or str(error)
        for packet in packets:
            self._following.pass_on(packet)
        try:
            while True:
                self._wishes.get_nowait()()
        except Empty:
            return self._monitor.trouble

    def _begin(self, topic: str) -> None:
        self._subscribers[topic] += 1
        if (offer := self._offers.get(topic)) and offer.last:
            self._send(offer, offer.last)
        self._update_following(topic)

    def _end(self, topic: str) -> None:
        self._subscribers[topic] -= 1
        self._update_following(topic)

    def update_offers(self, graph: Graph, server: FoxgloveServer) -> bool:
        """Offer new topics, and withdraw those that are gone or have another type now.

        Names that are not UTF-8, or have control characters, are not offered.
        Returns whether there is more to offer.
        """
        most = len(self._offers) + _AT_ONCE
        printable = {one.name: one for one in graph.topics() if one.name.isprintable()}
        topics = {name: one for name, one in printable.items() if self._topics.includes(name)}
        for name in self._offers.keys() - topics.keys():
            self._withdraw(name)
        for name, topic in topics.items():
            cls, offer = self._class_of(topic), self._offers.get(name)
            if offer and cls and offer.cls is not cls:
                self._withdraw(name)
            if cls and name not in self._offers and len(self._offers) < most:
                channel = server.offer(name, *self._schemas.of(cls))
                self._offers[name] = _Offer(cls, channel)
            if offer := self._offers.get(name):
                offer.is_latched = topic.is_latched
                self._update_following(name)
        server.draw({name: _ends(topic) for name, topic in topics.items()})
        wanted = self._following.channels
        if wanted != self._announced:
            self._announced = wanted
            self._monitor.listen_to(wanted)
        return len(self._offers) == most

    def _withdraw(self, name: str) -> None:
        offer = self._offers.pop(name)
        if offer.end:
            offer.end()
        offer.channel.close()

    def _update_following(self, topic: str) -> None:
        """Follow a topic while a client subscribes to it, and always if it is latched."""
        offer = self._offers.get(topic)
        if offer is None:
            return
        is_wanted = self._subscribers[topic] > 0 or offer.is_latched
        if is_wanted and offer.end is None:
            offer.end = self._following.add(topic, lambda packet: self._forward(offer, packet))
        elif not is_wanted and offer.end is not None:
            offer.end()
            offer.end = None

    def _forward(self, offer: _Offer, packet: Packet) -> None:
        if offer.is_latched:
            offer.last = packet
        if self._subscribers[packet.channel] > 0:
            self._send(offer, packet)

    def _send(self, offer: _Offer, packet: Packet) -> None:
        """Translate a message and send it; may run on the thread for large messages."""
        try:
            with self._translating:
                message = self._decoder.decode(packet)
                if type(message) is not offer.cls:
                    offered, found = type_name(offer.cls), type_name(type(message))
                    raise DecodeError(f"they are {found}, but offered as {offered}")
                data = self._schemas.write(message)
        except LcmtoolsError as error:
            self._refuse(f"messages on {packet.channel} are left out: {error}")
        else:
            offer.channel.log(data, log_time=packet.time)

    def _class_of(self, topic: Topic) -> type[Message] | None:
        """Return a topic's observed type, else the announced one; None if not known yet."""
        try:
            for number in topic.fingerprints:
                if names := possible_types(number, topic.name, topic.types):
                    return message_class(names[0], number)
            if topic.types and not topic.fingerprints:
                return message_class(topic.types[0])
        except LcmtoolsError as error:
            self._notify_once(f"{topic.name} is left out: {error}")
            return None
        if topic.fingerprints:
            self._notify_once(f"{topic.name} is left out: unknown type; {remedy_of_unknown()}")
        return None

    def _notify_once(self, text: str) -> None:
        if text not in self._told and len(self._told) < _MOST_TOLD:
            self._told.add(text)
            self._notify(text)


def _ends(topic: Topic) -> tuple[list[str], list[str]]:
    """Return the names of publishers and subscribers, without observing commands."""
    others = [str(seen.sender) for seen in topic.foreign if seen.sender]
    return sorted({*_names(topic.publishers), *others}), sorted({*_names(topic.subscribers)})


def _names(ends: Ends) -> Iterable[str]:
    return (node.name for node, _ in ends if not (node.tool or node.stale))
