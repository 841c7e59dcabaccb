"""A node's name, the meaning of other names to it, and its view of the bus.

Its endpoints and callbacks are not known here.
"""

from lcmtools import names
from lcmtools.graph import model
from lcmtools.node.context import Context


class NodeBase:
    """A mixin for objects with a name in a process's context.

    Args:
        name: Its own name; ``__name:=`` on the command line wins, for the first of a process.
        namespace: Its namespace; ``__ns:=`` on the command line wins.
        context: The context that it shares with others.

    Attributes:
        name: Its full name.
        namespace: Its namespace.

    Raises:
        InvalidName: The name or the namespace breaks the naming rules.
    """

    # Private names begin with two underscores, as in Node.

    def __init__(self, name: str, namespace: str, context: Context) -> None:
        self.__context = context
        arguments = context.arguments
        own_name = arguments.name if arguments.name and context.is_first() else name
        names.check_base_name(own_name)
        given = arguments.namespace or namespace
        self.namespace = names.resolve_namespace(given) if given else context.default_namespace
        self.name = names.check_length(names.resolve(f"{self.namespace}/{own_name}"))
        self.__names = names.Resolver(self.namespace, self.name, tuple(arguments.remaps))

    @property
    def context(self) -> Context:
        """The context that this node shares with the others of its process."""
        return self.__context

    def resolve_name(self, name: str) -> str:
        """Return the topic or service that a name means for this node, remapped.

        Raises:
            InvalidName: The name breaks the naming rules.
        """
        return self.__names.resolve(name)

    def graph(self) -> model.Graph:
        """Return the announced nodes of the bus; the first call subscribes to announcements."""
        return self.__context.follower.graph()

    def subscribed_topics(self) -> frozenset[str]:
        """Return the topics with announced subscriptions, so that others need not be computed."""
        return frozenset(
            endpoint.topic
            for node in self.__context.follower.graph().nodes
            if not node.stale
            for endpoint in node.having(model.Role.SUBSCRIBER)
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
