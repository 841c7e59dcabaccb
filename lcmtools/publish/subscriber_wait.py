"""Waiting for those who are to hear what a command publishes.

Belongs here: whom to wait for, how long, and what the person is told meanwhile. Must not know what
is published.
"""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass

from lcmtools.bus.listeners import listening_processes, listening_sockets
from lcmtools.bus.url import BusUrl
from lcmtools.cli.output import talk
from lcmtools.errors import NothingReceived
from lcmtools.messages.registry import Message
from lcmtools.names import did_you_mean, is_hidden
from lcmtools.node.node import Node
from lcmtools.node.publisher import Publisher

_LONGEST = 1.0  # [s] for anybody, where nobody was asked for
_ANSWERED = 0.25  # [s] after which every node that is there has announced itself
_PATIENCE = 2.0  # [s] before the person is told what is waited for
_POLL = 0.01  # [s]


@dataclass(frozen=True, slots=True)
class Wanted:
    """Whom to wait for.

    Attributes:
        subscribers: How many; None for one, and not for long.
        timeout: How long [s]; None for as long as it takes.
    """

    subscribers: int | None
    timeout: float | None


class SubscriberWait:
    """Those who can hear a publisher.

    Args:
        node: The publisher's node.
        publisher: Whom they are to hear.
        url: The bus.
    """

    def __init__(self, node: Node, publisher: Publisher[Message], url: BusUrl) -> None:
        self._node = node
        self._publisher = publisher
        self._sockets = listening_sockets(url)
        publisher.subscriber_ids()  # asks the nodes: the answers come while other things are done

    def wait(self, wanted: Wanted) -> None:
        """Wait for those who are wanted.

        Raises:
            NothingReceived: They do not come within the time.
        """
        if wanted.subscribers is None:
            self._wait_for_anybody()
        elif not wait_until(
            lambda: self._publisher.subscriber_count() >= (wanted.subscribers or 0),
            wanted.timeout,
            lambda: f"waiting for {self._situation(wanted)}",
        ):
            raise NothingReceived(
                f"not within {wanted.timeout:g} s: {self._situation(wanted)}",
                f"lcmtools info {self._publisher.topic} shows who is there",
            )

    def _wait_for_anybody(self) -> None:
        """Plain LCM programs never announce what they hear: for them there is no waiting."""
        if wait_until(self._publisher.subscriber_count, _ANSWERED):
            return
        if self._has_plain_listeners() and not self._deaf():
            return
        if not wait_until(self._publisher.subscriber_count, _LONGEST - _ANSWERED):
            topic = self._publisher.topic
            deaf = self._deaf()
            heard = (one for one in self._node.subscribed_topics() - {topic} if not is_hidden(one))
            near = "" if deaf else did_you_mean(topic, heard)
            talk(
                f"lcmtools pub: no node subscribes to {topic}{deaf} yet;"
                f" {f'{near} ' if near else ''}publishing all the same"
            )

    def _has_plain_listeners(self) -> bool:
        """Whether programs that are no nodes receive from the bus, on whatever channel."""
        nodes = {node.pid for node in self._node.graph().nodes} | {os.getpid()}
        return any(process.pid not in nodes for process in listening_processes(self._sockets))

    def _situation(self, wanted: Wanted) -> str:
        plural = "" if wanted.subscribers == 1 else "s"
        count = self._publisher.subscriber_count()
        topic = self._publisher.topic
        return f"{wanted.subscribers} subscriber{plural} of {topic}{self._deaf()}; {count} so far"

    def _deaf(self) -> str:
        """Who subscribes to the topic as another type, and so cannot hear; "" for nobody."""
        own = self._publisher.endpoint()
        names = [
            f"{node.name} does as {endpoint.type}"
            for node, endpoint in self._node.graph().topic(own.topic).subscribers
            if not node.stale and not set(own.fingerprints) & set(endpoint.fingerprints)
            if endpoint.fingerprints
        ]
        return f" as {own.type} ({', '.join(names)})" if names else ""


def wait_until(
    condition: Callable[[], object],
    timeout: float | None,
    waited_for: Callable[[], str] | None = None,
    pause: Callable[[float], None] = time.sleep,
) -> bool:
    """Wait for a condition; the person is told when that takes long.

    Args:
        condition: What is waited for.
        timeout: How long [s]; None for as long as it takes.
        waited_for: Says what it is.
        pause: Lets some seconds pass.

    Returns:
        Whether it has come true.
    """
    start = time.monotonic()
    told = waited_for is None
    while not condition():
        waited = time.monotonic() - start
        if timeout is not None and waited >= timeout:
            return False
        if not told and waited >= _PATIENCE and waited_for is not None:
            told = True
            talk(f"lcmtools pub: {waited_for()}")
        pause(_POLL)
    return True
