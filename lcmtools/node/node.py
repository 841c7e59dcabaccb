"""The Node class: publishers, subscriptions, timers, services and parameters under one name."""

import os
import sys
import time
import traceback
import uuid
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar, cast

from lcmtools import names
from lcmtools.clock import Clock, ManualClock, SystemClock, join_stamp, split_stamp
from lcmtools.errors import BusError, DecodeError, LcmtoolsError, UsageError
from lcmtools.graph import model
from lcmtools.messages.registry import Message
from lcmtools.node.context import Context, Participant, current_context
from lcmtools.node.logger import LogEntry, Logger
from lcmtools.node.parameter import Parameter, ParameterValue, ValueT, read_parameter
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
from lcmtools.types.rosgraph_msgs import Clock as ClockMessage
from lcmtools.types.rosgraph_msgs import Log

MessageT = TypeVar("MessageT", bound=Message)

_LOST_MESSAGE_PERIOD = 5.0  # [s] between two complaints about a bus that takes no messages


class Node(Participant):
    """A named participant of the bus.

    Names are resolved by the ROS rules: "/a" is global, "a" stands in the node's namespace, "~a"
    below the node itself; then the remaps of the command line apply.

    Args:
        name: The node's own name; ``__name:=`` on the command line wins.
        namespace: Where it stands; ``__ns:=`` on the command line wins.
        tool: It is a command that looks at the bus, not a part of the system.
        context: What it shares with other nodes; that of ``lcmtools.init`` when None.

    Raises:
        InvalidName: The name or the namespace breaks the naming rules.
        LcmtoolsError: ``lcmtools.init`` has not been called.
    """

    def __init__(
        self,
        name: str,
        *,
        namespace: str = "",
        tool: bool = False,
        context: Context | None = None,
    ) -> None:
        self._context = context or current_context()
        said = self._context.arguments
        own_name = said.name if said.name and self._context.is_first() else name
        names.check_base_name(own_name)
        self.namespace = self._namespace(said.namespace or namespace)
        self.name = names.check_length(names.resolve(f"{self.namespace}/{own_name}"))
        self._names = names.Resolver(self.namespace, self.name, tuple(said.remaps))
        self._parameters: dict[str, Parameter[ParameterValue]] = {}
        self._publishers: list[Publisher[Message]] = []
        self._subscriptions: list[Subscription] = []
        self._timers: list[Timer] = []
        self._services: list[Service[Message, Message]] = []
        self._clients: list[Client[Message, Message]] = []
        self._destroyed = False
        self._identity = self._identify(tool=tool)
        self._clock: Clock = SystemClock()
        self._logger = Logger(self.name, self._clock, self._forward_log)
        self._rosout = None if tool else self.create_publisher(Log, "/rosout", 100)
        if self._rosout:
            self._rosout.on_failure = lambda _: None  # the line has been printed all the same
        if self.declare_parameter("use_sim_time", default=False).value:
            self._use_sim_time()
        self._context.add(self)

    def __enter__(self) -> "Node":
        """Use the node as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Say goodbye."""
        self.destroy_node()

    def create_publisher(
        self, message_type: type[MessageT], topic: str, depth: int = 10, *, literal: bool = False
    ) -> Publisher[MessageT]:
        """A publisher of one type on one topic.

        Args:
            message_type: The messages' class.
            topic: The topic's name, to be resolved.
            depth: Kept for rclpy's sake and announced; LCM sends at once.
            literal: The topic is an LCM channel to the letter, not to be resolved.

        Raises:
            InvalidName: The topic's name breaks the naming rules.
        """
        resolved = names.check_length(topic) if literal else self.resolve_name(topic)
        context = self._context
        publisher = Publisher(context.bus, message_type, resolved, depth, context.graph)
        publisher.on_failure = None if self._identity.tool else self._log_lost_message
        self._publishers.append(publisher)  # type: ignore[arg-type] # kept to be announced only
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
        """A subscription; its callback runs on the thread that spins.

        Args:
            message_type: The messages' class, or several: each message is decoded as the one
                whose fingerprint it carries. The first is the declared type.
            topic: The topic's name, to be resolved.
            callback: Called with each message. What it raises is logged, and the node goes on.
            depth: How many messages wait at most; the newest are kept.
            group: Subscriptions of this node with the same group are alternatives: one that is
                connected is enough.
            literal: The topic is an LCM channel to the letter, not to be resolved.

        Raises:
            InvalidName: The topic's name breaks the naming rules.
            BusError: The bus does not take the subscription.
        """
        types = message_type if isinstance(message_type, tuple) else (message_type,)
        resolved = names.check_length(topic) if literal else self.resolve_name(topic)
        subscription = Subscription(types, resolved, callback, depth, group)  # type: ignore[arg-type]
        subscription.on_ready = self._context.wakeup.set
        self._context.bus.subscribe(resolved, subscription.receive)
        self._subscriptions.append(subscription)
        self._context.announcer.announce_soon()
        return subscription

    def create_timer(self, seconds: float, callback: Callable[[], object]) -> Timer:
        """Call a function every ``seconds`` on the node's clock.

        Raises:
            UsageError: The period is not positive.
        """
        timer = Timer(seconds, callback, self._timer_time())
        self._timers.append(timer)
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
        service = Service(self._context.bus, service_type, resolved, callback)
        service.on_ready = self._context.wakeup.set
        self._context.bus.subscribe(request_channel(resolved), service.receive)
        self._services.append(service)  # type: ignore[arg-type] # run by what they have in common
        self._context.announcer.announce_soon()
        return service

    def create_client(
        self, service_type: ServiceType[RequestT, ResponseT], name: str
    ) -> Client[RequestT, ResponseT]:
        """A client of a service.

        Raises:
            InvalidName: The service's name breaks the naming rules.
        """
        resolved = self.resolve_name(name)
        names.check_length(request_channel(resolved), name)
        client = Client(self._context.bus, service_type, resolved)
        client.is_interrupted = lambda: not self._context.ok()
        self._context.bus.subscribe(reply_channel(resolved), client.receive)
        self._clients.append(client)  # type: ignore[arg-type] # run by what they have in common
        self._context.announcer.announce_soon()
        return client

    def declare_parameter(self, name: str, default: ValueT) -> Parameter[ValueT]:
        """Declare a setting with its default; ``_name:=value`` on the command line wins.

        Raises:
            UsageError: The command line's value is not of the default's type.
        """
        text = self._context.arguments.parameters.get(name)
        # read_parameter gives a value of the default's own type
        value = default if text is None else cast("ValueT", read_parameter(name, text, default))
        self._parameters[name] = Parameter(name, value)
        self._context.declared_parameters.add(name)
        return Parameter(name, value)

    def get_parameter(self, name: str) -> Parameter[ParameterValue]:
        """A declared parameter.

        Raises:
            UsageError: It was not declared.
        """
        if name not in self._parameters:
            raise UsageError(
                f"{self.name} has no parameter '{name}'", names.did_you_mean(name, self._parameters)
            )
        return self._parameters[name]

    def warn_of_unknown_parameters(self) -> None:
        """Log the command line's parameters that no node here has declared: likely misspelt."""
        declared = self._context.declared_parameters
        for name in self._context.arguments.parameters.keys() - declared:
            hint = names.did_you_mean(name, declared)
            self._logger.warning(f"there is no parameter '{name}'{f'; {hint}' if hint else ''}")

    def get_logger(self) -> Logger:
        """The node's log."""
        return self._logger

    def get_clock(self) -> Clock:
        """The node's time: the computer's, or ``/clock`` with ``_use_sim_time:=true``."""
        return self._clock

    @property
    def context(self) -> Context:
        """What this node shares with the others of its process."""
        return self._context

    def graph(self) -> model.Graph:
        """The announced nodes of the bus; the first call starts listening to them."""
        return self._context.graph()

    def resolve_name(self, name: str) -> str:
        """The topic or service that a name means for this node, remapped.

        Raises:
            InvalidName: The name breaks the naming rules.
        """
        return self._names.resolve(name)

    def destroy_node(self) -> None:
        """Say goodbye and receive nothing any more. Does nothing the second time."""
        self._destroyed = True
        self._context.remove(self)
        bus = self._context.bus
        for subscription in self._subscriptions:
            bus.unsubscribe(subscription.topic, subscription.receive)
        for service in self._services:
            bus.unsubscribe(request_channel(service.name), service.receive)
        for client in self._clients:
            bus.unsubscribe(reply_channel(client.name), client.receive)
        for owned in (self._subscriptions, self._services, self._clients, self._timers):
            owned.clear()

    def describe(self) -> model.Node:
        """What is announced of this node."""
        endpoints = (
            *(publisher.endpoint() for publisher in tuple(self._publishers)),
            *(subscription.endpoint() for subscription in tuple(self._subscriptions)),
            *(service.endpoint() for service in tuple(self._services)),
            *(client.endpoint() for client in tuple(self._clients)),
        )
        return replace(self._identity, ports=tuple(self._context.bus.ports), endpoints=endpoints)

    def run_ready(self) -> int:
        """Run every callback that is ready; return how many ran. Called by the spin functions."""
        return self._run_subscriptions() + self._run_services() + self._run_timers()

    def time_to_timer(self) -> float | None:
        """Seconds until the next timer; None when only a message can bring work."""
        if isinstance(self._clock, ManualClock):
            return None
        now = self._timer_time()
        waits = [wait for t in self._timers if (wait := t.remaining(now)) is not None]
        return min(waits, default=None)

    def _run_subscriptions(self) -> int:
        ran = 0
        for subscription in tuple(self._subscriptions):
            for _ in range(subscription.waiting()):
                payload = subscription.take()
                if payload is None or not self._is_running():
                    break
                self._deliver(subscription, payload)
                ran += 1
        return ran

    def _deliver(self, subscription: Subscription, payload: bytes) -> None:
        try:
            message = subscription.decode(payload)
        except DecodeError as error:
            if subscription.is_warning_due(time.monotonic()):
                self._logger.warning(f"{subscription.topic}: message ignored: {error}")
            return
        self._guard(f"callback of {subscription.topic}", lambda: subscription.callback(message))

    def _run_services(self) -> int:
        ran = 0
        for service in tuple(self._services):
            while self._is_running() and (request := service.take()) is not None:
                ran += 1
                failure = service.answer(request)
                if failure is not None:
                    self._log_failure(f"service {service.name}", failure)
        return ran

    def _run_timers(self) -> int:
        ran = 0
        for timer in tuple(self._timers):
            now = self._timer_time()
            if self._is_running() and timer.is_due(now):
                timer.advance(now)
                self._guard("timer", timer.callback)
                ran += 1
        return ran

    def _is_running(self) -> bool:
        """Whether callbacks may be called; one of them may have ended the node or the program."""
        return self._context.ok() and not self._destroyed

    def _guard(self, what: str, call: Callable[[], object]) -> None:
        """Call user code; log what it raises and go on."""
        try:
            call()
        except Exception as error:  # noqa: BLE001 - a node outlives its callbacks' faults
            if isinstance(error, LcmtoolsError) and not self._context.ok():
                return  # no fault: the program ends, and what it waited for with it
            self._log_failure(what, error)

    def _log_lost_message(self, error: BusError) -> None:
        self._logger.error(f"{error}", throttle=_LOST_MESSAGE_PERIOD)

    def _log_failure(self, what: str, error: BaseException) -> None:
        trace = "".join(traceback.format_exception(error)).rstrip()
        self._logger.error(f"{what} raised {type(error).__name__}: {error}\n{trace}")

    def _forward_log(self, entry: LogEntry) -> None:
        if self._rosout is None:
            return
        message = Log()
        message.header.stamp.sec, message.header.stamp.nsec = split_stamp(entry.time)
        message.level, message.name = entry.severity, entry.node
        message.msg = entry.text.encode("utf-8", "replace").decode()  # file names may be no UTF-8
        message.file, message.function, message.line = entry.file, entry.function, entry.line
        self._rosout.publish(message)

    def _use_sim_time(self) -> None:
        clock = ManualClock()
        self._clock = clock
        self._logger = Logger(self.name, clock, self._forward_log)

        def set_clock(message: ClockMessage) -> None:
            clock.set(join_stamp(message.clock.sec, message.clock.nsec))

        self.create_subscription(ClockMessage, "/clock", set_clock, 1)

    def _timer_time(self) -> int:
        """Timers follow simulated time, or else a clock that nobody sets back."""
        if isinstance(self._clock, ManualClock):
            return self._clock.now()
        return time.monotonic_ns()

    def _namespace(self, given: str) -> str:
        return names.resolve_namespace(given) if given else self._context.default_namespace

    def _identify(self, *, tool: bool) -> model.Node:
        return model.Node(
            name=self.name,
            id=uuid.uuid4().hex,
            host=self._context.host,
            pid=os.getpid(),
            start_time=time.time_ns(),
            command=" ".join(sys.argv),
            tool=tool,
        )
