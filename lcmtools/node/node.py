"""The Node class: publishers, subscriptions, timers, services and parameters under one name."""

import contextlib
import os
import sys
import time
import uuid
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from lcmtools import names
from lcmtools.clock import Clock, ManualClock, SystemClock, join_stamp
from lcmtools.errors import BusError, InvalidName
from lcmtools.graph import model
from lcmtools.messages.registry import Message
from lcmtools.node.base import NodeBase
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.logger import LogEntry, Logger, log_message
from lcmtools.node.parameters import Parametric, service_name
from lcmtools.node.process import current_context
from lcmtools.node.publisher import Publisher
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


class Node(NodeBase, Parametric):
    """A named participant of the bus.

    Names are resolved by the ROS rules: "/a" is global, "a" is in the node's namespace, "~a"
    below the node itself; then the remaps of the command line apply.

    Args:
        name: The node's own name; ``__name:=`` on the command line wins.
        namespace: Its namespace; ``__ns:=`` on the command line wins.
        tool: It is a command that looks at the bus, not a part of the system.
        context: The context shared with other nodes; that of ``lcmtools.init`` when None.

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
        NodeBase.__init__(self, name, namespace, context)
        given = context.arguments.parameters
        Parametric.__init__(self, self.name, given, context.declared_parameters)
        self.__publishers: list[Publisher[Message]] = []
        self.__clients: list[Client[Message, Message]] = []
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
        self.__callbacks = Callbacks(self.__logger, context.ok)
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
        """
        resolved = names.check_channel(topic) if literal else self.resolve_name(topic)
        context = self.__context
        publisher = Publisher(context.bus, message_type, resolved, depth, context.follower.graph)
        publisher.on_failure = None if self.__identity.tool else self.__log_lost_message
        self.__publishers.append(publisher)  # type: ignore[arg-type] # kept to be announced only
        context.announcer.announce_soon()
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
            BusError: The bus does not take the subscription.
        """
        types = message_type if isinstance(message_type, tuple) else (message_type,)
        resolved = names.check_channel(topic) if literal else self.resolve_name(topic)
        subscription = Subscription(types, resolved, callback, depth, group)  # type: ignore[arg-type]
        subscription.on_ready = self.__wake
        self.__context.bus.subscribe(resolved, subscription.receive)
        self.__callbacks.subscriptions.append(subscription)
        self.__wake()  # messages may have come before
        self.__context.announcer.announce_soon()
        return subscription

    def create_timer(self, seconds: float, callback: Callable[[], object]) -> Timer:
        """Call a function every ``seconds`` on the node's clock.

        Raises:
            UsageError: The period is not positive.
        """
        timer = Timer(seconds, callback, self.__callbacks.time)
        self.__callbacks.timers.append(timer)
        return timer

    def create_service(
        self,
        service_type: ServiceType[RequestT, ResponseT],
        name: str,
        callback: ServiceCallback[RequestT, ResponseT],
    ) -> Service[RequestT, ResponseT]:
        """Answer requests by ``callback(request, response)``, which returns the response.

        Raises:
            InvalidName: The service's name breaks the naming rules.
        """
        resolved = self.resolve_name(name)
        names.check_length(request_channel(resolved), name)
        service = Service(self.__context.bus, service_type, resolved, callback)
        service.on_ready = self.__wake
        self.__context.bus.subscribe(request_channel(resolved), service.receive)
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
        """
        resolved = self.resolve_name(name)
        names.check_length(request_channel(resolved), name)
        client = Client(self.__context.bus, service_type, resolved)
        client.is_interrupted = lambda: not self.__context.ok()
        client.before_call = self.__context.announcer.announce_changes
        self.__context.bus.subscribe(reply_channel(resolved), client.receive)
        self.__clients.append(client)  # type: ignore[arg-type] # their message types differ
        self.__context.announcer.announce_soon()
        return client

    def warn_of_unknown_parameters(self) -> None:
        """Log the command line's parameters that no node here has declared: likely misspelt."""
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
            self.__context.announcer.announce_soon()

    def destroy_subscription(self, subscription: Subscription) -> None:
        """Receive nothing more by it, no waiting messages either. Does nothing the second time."""
        subscription.close()
        if subscription in self.__callbacks.subscriptions:
            self.__callbacks.subscriptions.remove(subscription)
            self.__context.bus.unsubscribe(subscription.topic, subscription.receive)
            self.__context.announcer.announce_soon()

    def destroy_timer(self, timer: Timer) -> None:
        """Call a timer's function no more. Does nothing the second time."""
        timer.cancel()
        with contextlib.suppress(ValueError):
            self.__callbacks.timers.remove(timer)

    def destroy_node(self) -> None:
        """Say goodbye and receive nothing any more. Does nothing the second time."""
        self.__context.remove(self)
        bus = self.__context.bus
        for subscription in self.__callbacks.subscriptions:
            bus.unsubscribe(subscription.topic, subscription.receive)
        for service in self.__callbacks.services:
            bus.unsubscribe(request_channel(service.name), service.receive)
        for client in self.__clients:
            bus.unsubscribe(reply_channel(client.name), client.receive)
        self.__clients.clear()
        self.__callbacks.clear()

    def describe(self) -> model.Node:
        """Return the announced description of this node."""
        endpoints = (
            *(publisher.endpoint() for publisher in tuple(self.__publishers)),
            *(subscription.endpoint() for subscription in tuple(self.__callbacks.subscriptions)),
            *(service.endpoint() for service in tuple(self.__callbacks.services)),
            *(client.endpoint() for client in tuple(self.__clients)),
        )
        ports = tuple(self.__context.bus.ports)
        busy = self.__callbacks.busy()
        return replace(self.__identity, ports=ports, endpoints=endpoints, busy=busy)

    @property
    def callbacks(self) -> Callbacks:
        """The callbacks that the spin functions run."""
        return self.__callbacks

    def __wake(self) -> None:
        """Let the spinning thread run callbacks; called on the receiving thread."""
        self.__callbacks.note_message()  # before the thread wakes, which checks this alone
        self.__context.wakeup.set()

    def __log_lost_message(self, error: BusError) -> None:
        self.__logger.error(f"{error}", throttle=_LOST_MESSAGE_PERIOD)

    def __forward_log(self, entry: LogEntry) -> None:
        if self.__rosout is not None:
            self.__rosout.publish(log_message(entry))

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
