"""The Node class: publishers, subscriptions, timers, services and parameters under one name."""

import contextlib
import os
import sys
import time
import uuid
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from lcmtools import names
from lcmtools.bus.base import Handler
from lcmtools.clock import Clock, ManualClock, SystemClock, join_stamp
from lcmtools.errors import BusError, InvalidName, UsageError
from lcmtools.graph import model
from lcmtools.messages.registry import Message
from lcmtools.node import checks
from lcmtools.node.callback_errors import CallbackErrors
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.logger import Logger
from lcmtools.node.parameters import Parametric, service_name
from lcmtools.node.process import current_context
from lcmtools.node.publisher import Publisher
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
from lcmtools.types import lcmtools_msgs
from lcmtools.types.rosgraph_msgs import Clock as ClockMessage
from lcmtools.types.rosgraph_msgs import Log

MessageT = TypeVar("MessageT", bound=Message)

_LOST_MESSAGE_PERIOD = 5.0  # [s] between two complaints about a bus that takes no messages


class Node(Parametric):
    """A named participant of the bus.

    Names are resolved by the ROS rules: "/a" is global, "a" is in the node's namespace, "~a"
    below the node itself; then the remaps of the command line apply.

    Args:
        name: The node's own name; ``__name:=`` on the command line wins, for a process's first.
        namespace: Its namespace; ``__ns:=`` on the command line wins.
        tool: It is a command that looks at the bus, not a part of the system.
        context: The context shared with other nodes; that of ``lcmtools.init`` when None.

    Attributes:
        name: Its full name.
        namespace: Its namespace.

    Raises:
        InvalidName: The name or the namespace breaks the naming rules.
        LcmtoolsError: ``lcmtools.init`` has not been called.
    """

    # Private names begin with two underscores: a user's class inherits from this one, and may have
    # a _clock or a _timers of its own.

    def __init__(
        self,
        name: str,
        *,
        namespace: str = "",
        tool: bool = False,
        context: Context | None = None,
    ) -> None:
        self.__context = context = context or current_context()
        self.__is_destroyed = False
        checks.check_text("Node", "name", name)
        arguments = context.arguments
        own_name = arguments.name if arguments.name and context.is_first() else name
        names.check_base_name(own_name)
        namespace = arguments.namespace or namespace or context.default_namespace
        self.namespace = names.resolve_namespace(namespace)
        self.name = names.check_length(names.resolve(f"{self.namespace}/{own_name}"))
        self.__names = names.Resolver(self.namespace, self.name, tuple(arguments.remaps))
        super().__init__(self.name, arguments.parameters, context.declared_parameters)
        self.__publishers: list[Publisher[Message]] = []
        self.__clients: list[Client[Message, Message]] = []
        self.__received: list[tuple[str, Handler]] = []  # channels, with what takes their messages
        self.__identity = model.Node(
            name=self.name,
            id=uuid.uuid4().hex,
            host=context.host,
            pid=os.getpid(),
            start_time=time.time_ns(),
            command=" ".join(sys.argv),
            tool=tool,
        )
        self.__logger = Logger(self.name, SystemClock(), self.__forward_log)
        self.__errors = CallbackErrors(self.__logger, context.announcer.announce_soon)
        self.__callbacks = Callbacks(self.__logger, self.__errors, context.ok)
        self.__rosout = None if tool else self.create_publisher(Log, "/rosout", 100)
        if self.__rosout:
            self.__rosout.on_failure = lambda _: None  # the line has been printed all the same
        self.__keep_time()
        if not tool:
            self.__serve_parameters()
        context.add(self)
        while context.notices:
            self.__logger.warning(context.notices.pop())

    def __enter__(self) -> "Node":
        """Use the node as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Say goodbye."""
        self.destroy_node()

    if not TYPE_CHECKING:  # a type checker would take it for all attributes there are

        def __getattr__(self, name: str) -> object:
            """Explain a missing attribute: a forgotten ``super().__init__``, a name of ROS's."""
            if hasattr(type(self), name):  # a property of the user's that lacks another one
                return object.__getattribute__(self, name)
            raise checks.missing_attribute(self, name)

    @property
    def context(self) -> Context:
        """The context that this node shares with the others of its process."""
        return self.__context

    @property
    def is_destroyed(self) -> bool:
        """True once ``destroy_node`` was called."""
        return self.__is_destroyed

    @property
    def callbacks(self) -> Callbacks:
        """The callbacks that the spin functions run."""
        return self.__callbacks

    def resolve_name(self, name: str) -> str:
        """Return the topic or service that a name means for this node, remapped.

        Raises:
            InvalidName: The name breaks the naming rules.
        """
        return self.__names.resolve(name)

    def create_publisher(
        self, message_type: type[MessageT], topic: str, depth: int = 10, *, literal: bool = False
    ) -> Publisher[MessageT]:
        """Return a publisher of one type on one topic.

        Args:
            message_type: The messages' class.
            topic: The topic's name, to be resolved.
            depth: Announced, as in rclpy; LCM sends at once.
            literal: The topic is an LCM channel to the letter, not to be resolved.

        Raises:
            InvalidName: The topic's name breaks the naming rules.
            UsageError: An argument is of another kind.
        """
        self.__check_alive("create_publisher")
        checks.check_endpoint("create_publisher", [message_type], topic, depth)
        resolved = names.check_channel(topic) if literal else self.resolve_name(topic)
        publisher = Publisher(self.__context.bus, message_type, resolved, depth, self.graph)
        publisher.on_failure = None if self.__identity.tool else self.__log_lost_message
        self.__publishers.append(publisher)  # type: ignore[arg-type] # kept to be announced only
        self.__context.announcer.announce_soon()
        return publisher

    def create_subscription(
        self,
        message_type: type[MessageT] | tuple[type[MessageT], ...],
        topic: str,
        callback: Callable[[MessageT], object],
        depth: int = 10,
        *,
        group: str = "",
        literal: bool = False,
    ) -> Subscription:
        """Return a subscription; its callback runs on the thread that spins.

        Args:
            message_type: The messages' class, or several: each message is decoded as the one
                whose fingerprint it carries. The first is the declared type.
            topic: The topic's name, to be resolved.
            callback: Called with each message. Its exceptions are logged, and the node goes on.
            depth: The number of messages that wait at most; the newest are kept.
            group: Subscriptions of this node with the same group are alternatives: one that is
                connected is enough.
            literal: The topic is an LCM channel to the letter, not to be resolved.

        Raises:
            InvalidName: The topic's name breaks the naming rules.
            UsageError: An argument is of another kind, the callback of another arity for example.
            BusError: The bus does not take the subscription.
        """
        self.__check_alive("create_subscription")
        types = message_type if isinstance(message_type, tuple) else (message_type,)
        checks.check_endpoint("create_subscription", types, topic, depth)
        checks.check_callback("create_subscription", callback, "message")
        resolved = names.check_channel(topic) if literal else self.resolve_name(topic)
        subscription = Subscription(types, resolved, callback, depth, group)  # type: ignore[arg-type]
        subscription.on_ready = self.__wake
        self.__receive(resolved, subscription.receive)
        self.__callbacks.subscriptions.append(subscription)
        self.__wake()  # messages may have come before
        self.__context.announcer.announce_soon()
        return subscription

    def create_timer(self, seconds: float, callback: Callable[[], object]) -> Timer:
        """Call a function every ``seconds`` on the node's clock.

        Raises:
            UsageError: The period is not positive, or the function takes arguments.
        """
        self.__check_period("create_timer", seconds)
        checks.check_callback("create_timer", callback)
        timer = Timer(seconds, callback, self.__callbacks.time)
        self.__callbacks.timers.append(timer)
        return timer

    def create_rate(self, frequency: float) -> Rate:
        """Return a rate for a loop of one's own: its ``sleep`` runs callbacks meanwhile.

        Args:
            frequency: Turns of the loop in a second of the node's clock [Hz].

        Raises:
            UsageError: The frequency is not positive and finite.
        """
        period = checks.period_of(frequency)
        self.__check_period("create_rate", period)
        return Rate(self, Timer(period, lambda: None, self.__callbacks.time))

    def create_service(
        self,
        service_type: ServiceType[RequestT, ResponseT],
        name: str,
        callback: ServiceCallback[RequestT, ResponseT],
    ) -> Service[RequestT, ResponseT]:
        """Answer requests by ``callback(request, response)``, which returns the response.

        Raises:
            InvalidName: The service's name breaks the naming rules.
            UsageError: An argument is of another kind, the callback of another arity for example.
        """
        resolved = self.__resolve_service("create_service", service_type, name)
        checks.check_callback("create_service", callback, "request", "response")
        service = Service(self.__context.bus, service_type, resolved, callback)
        service.on_ready = self.__wake
        self.__receive(request_channel(resolved), service.receive)
        self.__callbacks.services.append(service)  # type: ignore[arg-type] # their message types differ
        self.__wake()  # messages may have come before
        self.__context.announcer.announce_soon()
        return service

    def create_client(
        self, service_type: ServiceType[RequestT, ResponseT], name: str
    ) -> Client[RequestT, ResponseT]:
        """Return a client of a service.

        Raises:
            InvalidName: The service's name breaks the naming rules.
            UsageError: An argument is of another kind.
        """
        resolved = self.__resolve_service("create_client", service_type, name)
        client = Client(self.__context.bus, service_type, resolved)
        client.is_interrupted = lambda: not self.__context.ok()
        client.before_call = self.__context.announcer.announce_changes
        self.__receive(reply_channel(resolved), client.receive)
        self.__clients.append(client)  # type: ignore[arg-type] # their message types differ
        self.__context.announcer.announce_soon()
        return client

    def warn_of_unknown_parameters(self) -> None:
        """Log the command line's parameters that no node here has declared: likely misspelt.

        It is called with the first spin, and logs the context's note too.
        """
        if self.__context.note:
            self.__logger.info(self.__context.note)
            self.__context.note = ""
        declared = self.__context.declared_parameters
        for name in self.__context.arguments.parameters.keys() - declared:
            special = "did you mean __ns:= or __name:=?" if name in ("ns", "name") else ""
            hint = names.did_you_mean(name, declared) or special
            self.__logger.warning(f"there is no parameter '{name}'{f'; {hint}' if hint else ''}")

    def get_logger(self) -> Logger:
        """Return the node's log."""
        return self.__logger

    def get_clock(self) -> Clock:
        """Return the node's clock: the computer's, or ``/clock`` with ``_use_sim_time:=true``."""
        return self.__callbacks.clock

    def destroy_publisher(self, publisher: Publisher[MessageT]) -> None:
        """Announce a publisher no more. Does nothing the second time."""
        if publisher in self.__publishers:
            self.__publishers.remove(publisher)  # type: ignore[arg-type] # see create_publisher
            publisher.is_destroyed = True
            self.__context.announcer.announce_soon()

    def destroy_subscription(self, subscription: Subscription) -> None:
        """Receive nothing more by it, no waiting messages either. Does nothing the second time."""
        subscription.close()
        if subscription in self.__callbacks.subscriptions:
            self.__callbacks.subscriptions.remove(subscription)
            self.__received.remove((subscription.topic, subscription.receive))
            self.__context.bus.unsubscribe(subscription.topic, subscription.receive)
            self.__context.announcer.announce_soon()

    def destroy_timer(self, timer: Timer) -> None:
        """Call a timer's function no more. Does nothing the second time."""
        timer.cancel()
        with contextlib.suppress(ValueError):
            self.__callbacks.timers.remove(timer)

    def destroy_node(self) -> None:
        """Say goodbye and receive nothing any more. Does nothing the second time."""
        self.__errors.report()
        self.__is_destroyed = True
        if not self.__context.is_closed():  # else, the log says that the bus is closed
            for publisher in self.__publishers:
                publisher.is_destroyed = publisher is not self.__rosout
            for client in self.__clients:
                client.is_destroyed = True
        self.__context.remove(self)
        while self.__received:
            self.__context.bus.unsubscribe(*self.__received.pop())
        self.__clients.clear()
        self.__callbacks.clear()

    def describe(self) -> model.Node:
        """Return the announced description of this node."""
        callbacks = self.__callbacks
        endpoints = (
            *(publisher.endpoint() for publisher in tuple(self.__publishers)),
            *(subscription.endpoint() for subscription in tuple(callbacks.subscriptions)),
            *(service.endpoint() for service in tuple(callbacks.services)),
            *(client.endpoint() for client in tuple(self.__clients)),
        )
        return replace(
            self.__identity,
            ports=tuple(self.__context.bus.ports),
            endpoints=endpoints,
            busy=callbacks.busy(),
            errors=self.__errors.newest(),
        )

    def graph(self) -> model.Graph:
        """Return the announced nodes of the bus; the first call subscribes to announcements."""
        return self.__context.follower.graph()

    def subscribed_topics(self) -> frozenset[str]:
        """Return the topics with announced subscriptions, so that others need not be computed."""
        alive = (node for node in self.graph().nodes if not node.stale)
        return frozenset(
            endpoint.topic for node in alive for endpoint in node.having(model.Role.SUBSCRIBER)
        )

    def has_plain_listeners(self, *, at_once: bool = False) -> bool:
        """Return whether programs that are no nodes can be listening, to any topic.

        On a bus that leaves this computer there can always be one.

        Args:
            at_once: Look now, and count every possible one, instead of waiting a second or two
                to be sure.
        """
        listeners = self.__context.plain_listeners
        return bool(listeners and listeners.possible(at_once=at_once))

    def __receive(self, channel: str, handler: Handler) -> None:
        self.__context.bus.subscribe(channel, handler)
        self.__received.append((channel, handler))

    def __check_alive(self, call: str) -> None:
        if self.__is_destroyed:
            raise UsageError(f"{call}: the node {self.name} was destroyed")

    def __check_period(self, call: str, seconds: object) -> None:
        self.__check_alive(call)
        if warning := checks.check_period(call, seconds):
            self.__logger.warning(warning)

    def __resolve_service(self, call: str, service_type: object, name: str) -> str:
        self.__check_alive(call)
        checks.check_service_type(call, service_type, name)
        resolved = self.resolve_name(name)
        names.check_length(request_channel(resolved), name)
        return resolved

    def __wake(self) -> None:
        """Let the spinning thread run callbacks; called on the receiving thread."""
        self.__callbacks.note_message()  # before the thread wakes, which checks this alone
        self.__context.wakeup.set()

    def __log_lost_message(self, error: BusError) -> None:
        self.__logger.error(f"{error}", throttle=_LOST_MESSAGE_PERIOD)

    def __forward_log(self, entry: Log) -> None:
        if self.__rosout is not None:
            self.__rosout.publish(entry)

    def __serve_parameters(self) -> None:
        """Let the bus reach the parameters, unless the node's name leaves no room for it."""
        with contextlib.suppress(InvalidName):
            service = service_name(self.name)
            self.create_service(lcmtools_msgs.Parameters, service, self.answer_parameters)

    def __keep_time(self) -> None:
        about = "the time is that of /clock, not the computer's"
        if self.declare_parameter("use_sim_time", False, about, read_only=True).value:  # noqa: FBT003 - the default
            self.__use_sim_time()

    def __use_sim_time(self) -> None:
        clock = ManualClock()
        self.__callbacks.clock = self.__logger.clock = clock

        def set_clock(message: ClockMessage) -> None:
            clock.set(join_stamp(message.clock.sec, message.clock.nsec))

        self.create_subscription(ClockMessage, "/clock", set_clock, 1)
