"""The Node class: publishers, subscriptions, timers, services and parameters under one name."""

import contextlib
import time
from typing import TYPE_CHECKING

from lcmtools import names
from lcmtools.bus.records import this_process
from lcmtools.clock import CLOCK_TOPIC, Clock, ManualClock, SystemClock, join_stamp
from lcmtools.errors import InvalidName, explained
from lcmtools.graph import model
from lcmtools.graph.full_line import NodeLines
from lcmtools.node import checks
from lcmtools.node.callback_errors import CallbackErrors
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.factory import Factory
from lcmtools.node.logger import Logger
from lcmtools.node.parameters import Parametric, service_name
from lcmtools.node.process import current_context
from lcmtools.node.unused_arguments import unused
from lcmtools.types import lcmtools_msgs
from lcmtools.types.rosgraph_msgs import Clock as ClockMessage
from lcmtools.types.rosgraph_msgs import Log


class Node(Parametric, Factory):
    """A named participant on the bus.

    Names are resolved by the ROS rules: "/a" is global, "a" is in the node's namespace, "~a" is
    below the node itself. Then the remaps of the command line apply.

    Args:
        name: The node's own name; for a process's first node ``__name:=`` takes precedence.
        namespace: Its namespace; ``__ns:=`` on the command line takes precedence.
        tool: The node is a command that observes the bus, not a part of the system.
        context: The context shared with other nodes; None for that of ``lcmtools.init``.

    Attributes:
        name: Its full name.
        namespace: Its namespace.

    Raises:
        InvalidName: The name or the namespace breaks the naming rules.
        LcmtoolsError: ``lcmtools.init`` has not been called.
    """

    # Private names begin with two underscores: a user's class inherits from this one, and may have
    # a _clock or a _timers of its own.

    @explained
    def __init__(
        self, name: str, *, namespace: str = "", tool: bool = False, context: Context | None = None
    ) -> None:
        self.__context = context = context or current_context()
        checks.check_text("Node", "name", name)
        arguments = context.arguments
        own_name = arguments.name if arguments.name and context.is_first() else name
        names.check_base_name(own_name)
        namespace = arguments.namespace or namespace or context.default_namespace
        self.namespace = names.resolve_namespace(namespace)
        self.name = names.check_length(names.resolve(f"{self.namespace}/{own_name}"))
        resolver = names.Resolver(self.namespace, self.name, arguments.remaps)
        self.__identity = this_process(self.name, tool=tool)
        self.__logger = Logger(self.name, SystemClock(), self.__forward_log)
        self.__lines = NodeLines()
        self.__errors = CallbackErrors(self.__logger, context.announcer.announce_soon)
        self.__callbacks = Callbacks(self.__logger, self.__errors, context.ok)
        Parametric.__init__(self, self.name, arguments.parameters, context.used.parameters)
        Factory.__init__(self, context, resolver, self.__callbacks, self.__logger, tool=tool)
        self.__rosout = None if tool else self.create_publisher(Log, "/rosout", 100)
        if self.__rosout:
            self.__rosout.on_failure = lambda _: None  # the line has been printed anyway
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

    if not TYPE_CHECKING:  # else a type checker would accept any attribute

        def __getattr__(self, name: str) -> object:
            """Explain a missing attribute: a forgotten ``super().__init__``, or a ROS name."""
            if hasattr(type(self), name):  # a user's property that lacks another one
                return object.__getattribute__(self, name)
            raise checks.missing_attribute(self, name)

    @property
    def context(self) -> Context:
        """The context that this node shares with the others of its process."""
        return self.__context

    @property
    def callbacks(self) -> Callbacks:
        """The callbacks that the spin functions run."""
        return self.__callbacks

    def warn_of_unused_arguments(self) -> None:
        """Log what in the command line no node of this process has used: likely misspelt.

        Called when nodes first spin; also logs the context's note.
        """
        if self.__context.note:
            self.__logger.info(self.__context.note)
            self.__context.note = ""
        context, expand = self.__context, names.Resolver(self.namespace, self.name).expand
        for line in unused(context.arguments, context.used, expand):
            self.__logger.warning(line)

    def get_logger(self) -> Logger:
        """Return the node's log."""
        return self.__logger

    def get_clock(self) -> Clock:
        """Return the node's clock: the system clock, or ``/clock`` with ``_use_sim_time:=true``."""
        return self.__callbacks.clock

    def destroy_node(self) -> None:
        """Say goodbye and stop receiving. A second call does nothing."""
        if not self.__context.is_of_parent:
            self.__errors.report()
        self.__context.remove(self)
        super().destroy_node()
        if self.__rosout:
            self.__rosout.is_destroyed = False  # to log errors in the program's last steps

    def describe(self) -> model.NodeInfo:
        """Return the announced description of this node."""
        bus, endpoints = self.__context.bus, self.endpoints()
        return self.__identity._replace(
            ports=tuple(bus.ports),
            endpoints=endpoints,
            busy=self.__callbacks.busy(),
            overflows=bus.overflows,
            errors=self.__errors.newest(),
            full_lines=self.__lines.update(endpoints, bus.dropped(), time.monotonic()),
        )

    def graph(self) -> model.Graph:
        """Return the announced nodes of the bus; the first call subscribes to announcements."""
        return self.__context.follower.graph()

    def subscribed_topics(self) -> frozenset[str]:
        """Return the topics with announced subscriptions; data for others need not be computed."""
        alive = (node for node in self.graph().nodes if not node.stale)
        ends = (end for node in alive for end in node.having(model.Role.SUBSCRIBER))
        return frozenset(end.topic for end in ends)

    def has_plain_listeners(self, *, at_once: bool = False) -> bool:
        """Return whether programs can be listening that do not tell to which topics.

        These are programs that are not nodes, and nodes whose announced details cannot be read. On
        a bus that leaves this computer one can always be listening. With ``at_once`` every possible
        listener counts, at once, instead of waiting a second or two to be sure.
        """
        listeners = self.__context.plain_listeners
        is_possible = listeners and listeners.possible(at_once=at_once)
        return bool(is_possible or self.graph().unexplained())

    def __forward_log(self, entry: Log) -> None:
        if self.__rosout is not None:
            self.__rosout.publish(entry)

    def __serve_parameters(self) -> None:
        """Offer the parameters on the bus, unless the node's name is too long for the service's."""
        with contextlib.suppress(InvalidName):
            service = service_name(self.name)
            self.create_service(lcmtools_msgs.Parameters, service, self.answer_parameters)

    def __keep_time(self) -> None:
        about = "the time is that of /clock, not the computer's"
        lockstep = self.__context.lockstep
        usual = lockstep is not None
        if not self.declare_parameter("use_sim_time", usual, about, read_only=True).value:
            return
        clock = ManualClock(lockstep.start if lockstep else 0)
        self.__callbacks.clock = self.__logger.clock = clock

        def set_clock(message: ClockMessage) -> None:
            clock.set(join_stamp(message.clock.sec, message.clock.nsec))

        self.create_subscription(ClockMessage, CLOCK_TOPIC, set_clock, 1)
