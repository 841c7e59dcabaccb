"""Waiting for subscribers before the first message.

Must not know what is published.
"""

import os
import time
from collections.abc import Callable
from functools import partial

from lcmtools.bus.records import NodeRecords
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import BusUrl
from lcmtools.errors import NothingReceived
from lcmtools.graph.model import Staleness
from lcmtools.messages.registry import Message
from lcmtools.names import did_you_mean, is_hidden
from lcmtools.node.node import Node
from lcmtools.node.publisher import Publisher
from lcmtools.node.spinning import spin_once
from lcmtools.observe.reading.senders import is_here
from lcmtools.publish.incoming import Notify

_LONGEST = 1.0  # [s] to wait for any subscriber, if no number was given
_ANSWERED = 0.25  # [s] after which every running node has announced itself
_SOONEST = 0.05  # [s] the same on this computer, once all nodes with a record have
_PATIENCE = 2.0  # [s] before the user is told about the wait
_POLL = 0.01  # [s]


class SubscriberWait:
    """The wait for the subscribers of a node's publisher."""

    def __init__(
        self,
        node: Node,
        publisher: Publisher[Message],
        url: BusUrl,
        notify: Notify,
        literal: str = "",
    ) -> None:
        """``literal`` is the LCM channel that may be meant by the topic; "" for none."""
        self._node = node
        self._publisher = publisher
        self._notify = notify
        self._url = url
        self._literal = literal
        self._sockets = SocketTable.read()
        publisher.subscriber_ids()  # probes the nodes, which answer while other work is done

    def wait(self, subscribers: int | None, timeout: float | None) -> None:
        """Wait ``timeout`` seconds for this many subscribers; for None, up to a second for one.

        Raises:
            NothingReceived: They do not appear in time.
        """
        if subscribers is None:
            self._wait_for_any()
            return

        def situation() -> str:
            plural = "" if subscribers == 1 else "s"
            topic, count = self._publisher.topic, self._publisher.subscriber_count()
            return f"{subscribers} subscriber{plural} of {topic}{self._misfits()}; {count} so far"

        def are_enough() -> bool:
            return self._publisher.subscriber_count() >= subscribers

        if not wait_until(are_enough, timeout, lambda: self._notify(f"waiting for {situation()}")):
            hint = f"lcmtools info {self._publisher.topic} shows the subscribers"
            raise NothingReceived(f"not within {timeout:g} s: {situation()}", hint)

    def wait_for_clock(self, timeout: float | None) -> None:
        """Wait until the simulated time is known; NothingReceived if it does not come in time."""

        def notify() -> None:
            self._notify("waiting for /clock")

        spin = partial(spin_once, self._node)
        if not wait_until(self._node.get_clock().now, timeout, notify, spin):
            hint = "is the simulator running?"
            raise NothingReceived(f"nothing came on /clock within {timeout:g} s", hint)

    def _wait_for_any(self) -> None:
        """Wait up to 1 s for a node; not if plain LCM programs listen, which announce nothing."""
        soonest, recorded = time.monotonic() + _SOONEST, self._recorded_here()

        def have_answered() -> bool:
            is_soon = time.monotonic() < soonest
            return not is_soon and recorded <= {node.id for node in self._node.graph().nodes}

        wait_until(lambda: self._publisher.subscriber_count() or have_answered(), _ANSWERED)
        if self._publisher.subscriber_count():
            return
        if self._has_plain_listeners() and not self._misfits():
            if self._literal:
                channel = f"for the channel {self._literal} of plain LCM programs, which listen"
                self._notify(f"publishes on {self._publisher.topic}; {channel}: --plain-channel")
            return
        if not wait_until(self._publisher.subscriber_count, _LONGEST - _ANSWERED):
            topic, misfits = self._publisher.topic, self._misfits()
            others = (one for one in self._node.subscribed_topics() - {topic} if not is_hidden(one))
            near = "" if misfits else did_you_mean(topic, others)
            doubt = f"{near} " if near else ""
            self._notify(f"no node subscribes to {topic}{misfits} yet; {doubt}publishing anyway")

    def _recorded_here(self) -> frozenset[str]:
        """The ids of the nodes on this computer; an impossible id if other computers take part."""
        if not self._url.is_multicast or self._url.ttl:
            return frozenset({""})
        records = NodeRecords(self._url, os.environ).read()
        return frozenset(node.id for node in records if node.stale is Staleness.HANGS)

    def _has_plain_listeners(self) -> bool:
        """True if programs that are not nodes receive from the bus, on any channel."""
        nodes = {one.pid for one in self._node.graph().nodes if is_here(one)} | {os.getpid()}
        table = self._sockets
        holders = (table.holders.get(inode) for inode in table.listening(self._url))
        return any(holder and holder.pid not in nodes for holder in holders)

    def _misfits(self) -> str:
        """The nodes that subscribe to the topic with another type; "" for none."""
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
    notify: Callable[[], None] | None = None,
    pause: Callable[[float], object] = time.sleep,
) -> bool:
    """Return whether a condition comes true within ``timeout`` seconds (None: no limit).

    ``notify`` is called once if that takes long; ``pause`` waits for a number of seconds.
    """
    start = time.monotonic()
    while not condition():
        waited = time.monotonic() - start
        if timeout is not None and waited >= timeout:
            return False
        if notify and waited >= _PATIENCE:
            notify()
            notify = None
        pause(_POLL)
    return True
