"""The package foxglove's server: channels, clients' requests, and errors as lcmtools' own."""

import logging
import secrets
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, cast

from lcmtools.bag.ros_types import Schema
from lcmtools.errors import BusError, needing_extra

if TYPE_CHECKING:
    from foxglove import Channel

_MOST_WAITING = 256  # messages for a slow client; beyond this, the oldest are dropped


class FoxgloveServer(AbstractContextManager["FoxgloveServer"]):
    """A server for Foxglove and Lichtblick, at the address of a gate.

    ``clients`` handles their requests by those methods of the package's ``ServerListener`` that it
    has, on threads of the server; ``encodings`` are of messages that clients may publish.

    Raises:
        MissingExtra: The package is missing.
        BusError: It cannot listen.
    """

    def __init__(self, clients: object, encodings: Iterable[str] = ()) -> None:
        with needing_extra("foxglove", "foxglove needs"):
            import foxglove
            from foxglove.websocket import Capability, StatusLevel
        logging.getLogger("foxglove").addHandler(logging.NullHandler())  # about lost clients
        self._package: Any = foxglove
        self.host = _hidden_host()
        self._level = StatusLevel.Error
        self._context = foxglove.Context()
        self._graph: Mapping[str, tuple[list[str], list[str]]] = {}
        can = [Capability.ConnectionGraph, *([Capability.ClientPublish] if encodings else [])]
        try:
            self._server = foxglove.start_server(
                name="lcmtools",
                host=self.host,
                port=0,
                capabilities=can,
                server_listener=cast("Any", _Listener(clients)),
                supported_encodings=list(encodings) or None,
                context=self._context,
                message_backlog_size=_MOST_WAITING,
            )
        except RuntimeError as error:
            raise BusError(f"cannot listen at {self.host}: {error}") from error

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


def _hidden_host() -> str:
    """Return an address of this computer that pages cannot guess, where systems have others.

    Else only the port is unknown to them.
    """
    if not sys.platform.startswith("linux"):
        return "127.0.0.1"
    return f"127.{'.'.join(str(1 + secrets.randbelow(254)) for _ in range(3))}"


class _Listener:
    """The listener that the package calls: ``clients``; other calls do nothing."""

    def __init__(self, clients: object) -> None:
        self._clients = clients

    def __getattr__(self, name: str) -> Callable[..., None]:
        if not name.startswith("on_"):
            raise AttributeError(name)
        found: Callable[..., None] = getattr(self._clients, name, lambda *_: None)
        return found
