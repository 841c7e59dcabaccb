"""The parts of a node that users make and destroy: publishers, subscriptions, timers, services.

Belongs here: what a ``create_...`` call checks, registers with the bus and announces. A node's
name, clock and parameters are not known here.
"""

import contextlib
from collections.abc import Callable
from functools import partial
from typing import TypeVar

from lcmtools import names
from lcmtools.bus.base import Handler, refusal
from lcmtools.errors import BusError, UsageError, explained
from lcmtools.graph.model import Endpoint
from lcmtools.messages.layout import has_byte_array
from lcmtools.messages.registry import Message
from lcmtools.node import checks
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.logger import Logger
from lcmtools.node.publisher import PayloadPublisher, Publisher
from lcmtools.node.rate import Rate
from lcmtools.node.service import (
    Client,
    RequestT,
    ResponseT,
    Service,
    ServiceCallback,
    ServiceType,
    reply_channel,
    request_channel,
)
from lcmtools.node.subscription import Subscription
from lcmtools.node.timer import Timer

MessageT = TypeVar("MessageT", bound=Message)

_LOST_MESSAGE_PERIOD = 5.0  # [s] between two warnings that messages cannot be sent


class Factory:
    """A mixin for nodes, which makes and destroys their parts.

    The resolver also remaps the names of topics and services. In a ``tool``, a command, ``publish``
    raises its errors; other nodes log them.
    """

    # Private names begin with two underscores, as in Node.

    def __init__(
        self,
        context: Context,
        resolver: names.Resolver,
        callbacks: Callbacks,
        logger: Logger,
        *,
        tool: bool,
    ) -> None:
        self.__context = context
        self.__resolver = resolver
        self.__callbacks = callbacks
        self.__logger = logger
        self.__tool = tool
        self.__publishers: list[PayloadPublisher] = []
        self.__clients: list[Client[Message, Message]] = []
        self.__received: list[tuple[str, Handler]] = []  # channels and their handlers
        self.__is_destroyed = False

    @property
    def is_destroyed(self) -> bool:
        """True once ``destroy_node`` was called."""
        return self.__is_destroyed

    def resolve_name(self, name: str) -> str:
        """Return the full name of a topic or service, resolved for this node and remapped.

        Raises:
            InvalidName: The name breaks the naming rules.
        """
        resolver, used = self.__resolver, self.__context.used
        full = resolver.expand(name)
        used.topics[full] = name
        used.remaps.update(one for one, _ in resolver.remaps if resolver.expand(one) == full)
        return resolver.resolve(name)

    @checks.type_first
    @explained
    def create_publisher(
        self,
        message_type: type[MessageT],
        topic: str,
        depth: int = 10,
        *,
        plain_channel: bool = False,
    ) -> Publisher[MessageT]:
        """Return a publisher of one type on one topic.

        Args:
            message_type: The messages' class.
            topic: The topic's name, to be resolved.
            depth: Only announced, for rclpy's sake: LCM sends at once.
            plain_channel: The topic is the exact LCM channel and is not resolved.

        Raises:
            InvalidName: The topic's name breaks the naming rules.
            UsageError: An argument has the wrong type.
        """
        self.__check_alive("create_publisher")
        checks.check_endpoint("create_publisher", [message_type], topic, depth)
        resolved = names.check_channel(topic) if plain_channel else self.resolve_name(topic)
        context = self.__context
        publisher = Publisher(context.bus, message_type, resolved, depth, context.follower.graph)
        self.__add_publisher(publisher)
        return publisher

    @explained
    def create_payload_publisher(
        self, topic: str, type_name: str = "", fingerprint: int | None = None
    ) -> PayloadPublisher:
        """Return a publisher of messages that are already encoded, for example from a log.

        Args:
            topic: The exact LCM channel; it is not resolved.
            type_name: The type of its messages, announced; "" if unknown.
            fingerprint: The fingerprint of this type, announced; None if unknown.

        Raises:
            InvalidName: LCM cannot carry this channel name.
        """
        self.__check_alive("create_payload_publisher")
        checks.check_text("create_payload_publisher", "topic", topic)
        bus, graph = self.__context.bus, self.__context.follower.graph
        kind = type_name, fingerprint
        publisher = PayloadPublisher(bus, kind, names.check_length(topic), 10, graph)
        self.__add_publisher(publisher)
        return publisher

    @checks.type_first
    @explained
    def create_subscription(
        self,
        message_type: type[MessageT] | tuple[type[MessageT], ...],
        topic: str,
        callback: Callable[[MessageT], object],
        depth: int = 10,
        *,
        group: str = "",
        plain_channel: bool = False,
    ) -> Subscription:
        """Return a subscription; its callback runs on the thread that spins.

        Args:
            message_type: The messages' class, or several: each message is decoded as the class that
                has its fingerprint. The first is the declared type.
            topic: The topic's name, to be resolved.
            callback: Called with each message. Its exceptions are logged, and the node goes on.
            depth: The largest number of waiting messages; the newest are kept.
            group: Subscriptions of this node with the same group are alternatives: one that is
                connected is enough.
            plain_channel: The topic is the exact LCM channel and is not resolved.

        Raises:
            InvalidName: The topic's name breaks the naming rules.
            UsageError: An argument is wrong, for example a callback that does not take one message.
            BusError: The bus does not accept the subscription.
        """
        self.__check_alive("create_subscription")
        types = message_type if isinstance(message_type, tuple) else (message_type,)
        checks.check_endpoint("create_subscription", types, topic, depth)
        checks.check_callback("create_subscription", callback, "message")
        resolved = names.check_channel(topic) if plain_channel else self.resolve_name(topic)
        subscription = Subscription(types, resolved, callback, depth, group)  # type: ignore[arg-type]
        subscription.on_ready = self.__callbacks.on_ready(self.__callbacks.deliver, subscription)
        subscription.callbacks = self.__callbacks
        subscription.run = partial(self.__callbacks.run, subscription)
        is_large = any(map(has_byte_array, types))
        self.__receive(resolved, subscription.receive, is_large=is_large)
        bus = self.__context.bus
        before = bus.lost(resolved)
        subscription.lost_by_bus = lambda: (bus.lost(resolved) - before, bus.overflows)
        self.__callbacks.subscriptions.append(subscription)
        return subscription

    @explained
    def create_timer(self, seconds: float, callback: Callable[[], object]) -> Timer:
        """Call a function every ``seconds`` on the node's clock.

        Raises:
            UsageError: The period is not positive, or the function takes arguments.
        """
        self.__check_alive("create_timer")
        if warning := checks.check_period(seconds):
            self.__logger.warning(warning)
        checks.check_callback("create_timer", callback)
        timer = Timer(seconds, callback, self.__callbacks.time)
        self.__callbacks.timers.append(timer)
        self.__context.wake()  # a thread that spins in the background waits for it, too
        return timer

    @explained
    def create_rate(self, frequency: float) -> Rate:
        """Return a rate for the caller's own loop: while its ``sleep`` waits, callbacks run.

        Args:
            frequency: Iterations per second, by the node's clock [Hz].

        Raises:
            UsageError: The frequency is not positive and finite.
        """
        self.__check_alive("create_rate")
        period = checks.period_of(frequency)
        timer = Timer(period, lambda: None, self.__callbacks.time)
        return Rate(self.__context, self.__callbacks, timer)

    @checks.type_first
    @explained
    def create_service(
        self,
        service_type: ServiceType[RequestT, ResponseT],
        name: str,
        callback: ServiceCallback[RequestT, ResponseT],
    ) -> Service[RequestT, ResponseT]:
        """Answer requests with ``callback(request, response)``, which returns the response.

        Raises:
            InvalidName: The service's name breaks the naming rules.
            UsageError: An argument is wrong, for example a callback that does not take two.
        """
        resolved = self.__resolve_service("create_service", service_type, name)
        checks.check_callback("create_service", callback, "request", "response")
        service = Service(self.__context.bus, service_type, resolved, callback)
        service.on_ready = self.__callbacks.on_ready(self.__callbacks.answer, service)  # type: ignore[arg-type]
        self.__receive(request_channel(resolved), service.receive)
        self.__callbacks.services.append(service)  # type: ignore[arg-type] # their message types differ
        return service

    @checks.type_first
    @explained
    def create_client(
        self, service_type: ServiceType[RequestT, ResponseT], name: str
    ) -> Client[RequestT, ResponseT]:
        """Return a client of a service.

        Raises:
            InvalidName: The service's name breaks the naming rules.
            UsageError: An argument has the wrong type.
        """
        resolved = self.__resolve_service("create_client", service_type, name)
        client = Client(self.__context.bus, service_type, resolved)
        client.is_interrupted = lambda: not self.__context.ok()
        client.before_call = self.__before_call
        client.on_spin = self.__callbacks.ready.append
        client.server = partial(self.__context.server, resolved)
        self.__receive(reply_channel(resolved), client.receive)
        self.__clients.append(client)  # type: ignore[arg-type] # their message types differ
        return client

    @explained
    def destroy_publisher(self, publisher: PayloadPublisher) -> None:
        """Stop announcing a publisher. A second call does nothing."""
        if publisher in self.__publishers:
            self.__publishers.remove(publisher)
            publisher.is_destroyed = True
            self.__context.announcer.announce_soon()

    @explained
    def destroy_subscription(self, subscription: Subscription) -> None:
        """Stop receiving, and drop waiting messages. A second call does nothing."""
        subscription.close()
        if subscription in self.__callbacks.subscriptions:
            self.__callbacks.subscriptions.remove(subscription)
            self.__received.remove((subscription.topic, subscription.receive))
            self.__context.bus.unsubscribe(subscription.topic, subscription.receive)
            self.__context.announcer.announce_soon()

    @explained
    def destroy_timer(self, timer: Timer) -> None:
        """Stop calling a timer's function. A second call does nothing."""
        timer.cancel()
        with contextlib.suppress(ValueError):
            self.__callbacks.timers.remove(timer)

    def destroy_node(self) -> None:
        """Stop receiving and sending."""
        self.__is_destroyed = True
        if not self.__context.is_closed():  # else their errors say that the bus is closed
            for publisher in self.__publishers:
                publisher.is_destroyed = True
            for client in self.__clients:
                client.is_destroyed = True
        while self.__received:
            self.__context.bus.unsubscribe(*self.__received.pop())
        self.__clients.clear()
        self.__callbacks.clear()

    def endpoints(self) -> tuple[Endpoint, ...]:
        """Return the announced descriptions of publishers, subscriptions, services and clients."""
        callbacks = self.__callbacks
        return (
            *(publisher.endpoint() for publisher in tuple(self.__publishers)),
            *(subscription.endpoint() for subscription in tuple(callbacks.subscriptions)),
            *(service.endpoint() for service in tuple(callbacks.services)),
            *(client.endpoint() for client in tuple(self.__clients)),
        )

    def __add_publisher(self, publisher: PayloadPublisher) -> None:
        publisher.on_failure = None if self.__tool else self.__log_lost_message
        self.__publishers.append(publisher)
        self.__context.announcer.announce_soon()

    def __receive(self, channel: str, handler: Handler, *, is_large: bool = False) -> None:
        self.__context.bus.subscribe(channel, handler, is_large=is_large)
        self.__received.append((channel, handler))
        self.__context.announcer.announce_soon()

    def __before_call(self) -> None:
        if self.__context.is_of_parent:
            raise refusal(is_of_parent=True)
        self.__context.announcer.announce_changes()

    def __check_alive(self, call: str) -> None:
        if self.__context.is_of_parent:
            raise refusal(is_of_parent=True)
        if self.__is_destroyed:
            raise UsageError(f"{call}: the node {self.__resolver.node} was destroyed")

    def __resolve_service(self, call: str, service_type: object, name: str) -> str:
        self.__check_alive(call)
        checks.check_service_type(call, service_type, name)
        resolved = self.resolve_name(name)
        names.check_length(request_channel(resolved), name)
        return resolved

    def __log_lost_message(self, error: BusError) -> None:
        self.__logger.error(f"{error}", throttle=_LOST_MESSAGE_PERIOD)
