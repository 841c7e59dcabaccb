"""The package foxglove's server: channels, clients' requests, and errors as lcmtools' own."""

import logging
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, cast

from lcmtools.bag.ros_types import Schema
from lcmtools.errors import BusError, needing_extra

if TYPE_CHECKING:
    from foxglove import Channel

_MOST_WAITING = 256  # messages for a slow client; beyond this, the oldest are dropped


class FoxgloveServer(AbstractContextManager["FoxgloveServer"]):
    """A server for Foxglove and Lichtblick, at a host and port; 0 for any port.

    ``clients`` handles their requests by those methods of the package's ``ServerListener`` that it
    has, on threads of the server; ``encodings`` are of messages that clients may publish.

    Raises:
        MissingExtra: The package is missing.
        BusError: The address cannot be used.
    """

    def __init__(
        self, address: tuple[str, int], clients: object, encodings: Iterable[str] = ()
    ) -> None:
        with needing_extra("foxglove", "foxglove needs"):
            import foxglove
            from foxglove.websocket import Capability, StatusLevel
        logging.getLogger("foxglove").addHandler(logging.NullHandler())  # about lost clients
        self._package: Any = foxglove
        self._level = StatusLevel.Error
        self._context = foxglove.Context()
        self._graph: Mapping[str, tuple[list[str], list[str]]] = {}
        host, port = address
        can = [Capability.ConnectionGraph, *([Capability.ClientPublish] if encodings else [])]
        try:
            self._server = foxglove.start_server(
                name="lcmtools",
                host=host,
                port=port,
                capabilities=can,
                server_listener=cast("Any", _Listener(clients)),
                supported_encodings=list(encodings) or None,
                context=self._context,
                message_backlog_size=_MOST_WAITING,
            )
        except RuntimeError as error:
            reason = str(error).rpartition(": ")[2].partition(" (os error")[0]
            what = f"cannot listen at {host}:{port}: {reason}"
            raise BusError(what, "--port N chooses another port") from error

    def __exit__(self, *_: object) -> None:
        """End all connections."""
        self._server.stop()

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return int(self._server.port)

    def offer(self, topic: str, encoding: str, schema: Schema) -> "Channel":
        """Offer a topic."""
        described = self._package.Schema(name=schema.name, encoding=schema.form, data=schema.text)
        options = {"message_encoding": encoding, "context": self._context}
        channel: Channel = self._package.Channel(topic, schema=described, **options)
        return channel

    def show_problem(self, key: str, text: str) -> None:
        """Show clients a problem, replacing an earlier one with its key; "" removes it."""
        if text:
            self._server.publish_status(text, self._level, key)
        else:
            self._server.remove_status([key])

    def draw(self, graph: Mapping[str, tuple[list[str], list[str]]]) -> None:
        """Show the publishers and subscribers of each topic."""
        if graph == self._graph:
            return
        self._graph = graph
        drawn = self._package.ConnectionGraph()
        for topic, (publishers, subscribers) in graph.items():
            drawn.set_published_topic(topic, publishers)
            drawn.set_subscribed_topic(topic, subscribers)
        self._server.publish_connection_graph(drawn)


class _Listener:
    """The listener that the package calls: ``clients``; other calls do nothing."""

    def __init__(self, clients: object) -> None:
        self._clients = clients

    def __getattr__(self, name: str) -> Callable[..., None]:
        if not name.startswith("on_"):
            raise AttributeError(name)
        found: Callable[..., None] = getattr(self._clients, name, lambda *_: None)
        return found
