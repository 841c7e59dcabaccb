"""Sending messages in time: as they come, at a rate, and again to those who come late.

Belongs here: when what is sent. Must not know where messages come from.
"""

import time
from collections.abc import Iterator

import lcmtools
from lcmtools.cli.output import talk
from lcmtools.errors import BusError
from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.plain import to_json
from lcmtools.messages.registry import Message
from lcmtools.node.node import Node
from lcmtools.node.publisher import Publisher
from lcmtools.publish.pace import Pace

_POLL = 0.02  # [s] between two looks at who subscribes
_MOST_BEHIND = 0.1  # [s] that are made up for; a computer that slept sends no burst


class Sender:
    """Sends messages with a publisher.

    Args:
        node: The publisher's node, whose clock the stamps are taken from.
        publisher: What sends them.
        latches: Whether who subscribes late is sent the last message.
        is_verbose: Whether to tell the person of every message.
        endures: Whether a network that fails after the first message is waited for.
    """

    def __init__(
        self,
        node: Node,
        publisher: Publisher[Message],
        *,
        latches: bool,
        is_verbose: bool,
        endures: bool,
    ) -> None:
        self.count = 0
        self._endures = endures
        self._is_cut_off = False
        self._node = node
        self._publisher = publisher
        self._latches = latches
        self._is_verbose = is_verbose
        self._spins = bool(node.get_parameter("use_sim_time").value)
        self._last: MessageTemplate[Message] | None = None
        self._served: frozenset[str] = frozenset()
        self._next_look = 0.0

    def send(self, draft: MessageTemplate[Message]) -> None:
        """Send a message, stamped with the time where it asks for that.

        Raises:
            BusError: The bus does not take it, and that is not endured.
        """
        self._last = draft
        if not self._is_sent(draft):
            return
        self.count += 1
        if self._latches:
            self._served = self._publisher.subscriber_ids()
        if self._is_verbose:
            talk(f"publishing #{self.count}: {to_json(draft.message)}")

    def pause(self, seconds: float) -> None:
        """Let time pass, and serve who comes late meanwhile."""
        end = time.monotonic() + seconds
        while True:
            self.attend()
            left = end - time.monotonic()
            if left <= 0:
                return
            step = min(left, _POLL) if self._latches else left
            if self._spins:
                lcmtools.spin_once(self._node, step)
            else:
                time.sleep(step)

    def attend(self) -> None:
        """Send the last message again if somebody has subscribed since."""
        if self._spins:
            lcmtools.spin_once(self._node)
        if not self._latches or self._last is None or time.monotonic() < self._next_look:
            return
        self._next_look = time.monotonic() + _POLL
        present = self._publisher.subscriber_ids()
        if present - self._served and self._is_sent(self._last) and self._is_verbose:
            talk(f"publishing #{self.count} again, to who has just subscribed")
        self._served = present

    def _is_sent(self, draft: MessageTemplate[Message]) -> bool:
        """Send a message; False where the network is gone, which is said once."""
        payload = draft.payload(self._node.get_clock().now())
        try:
            self._publisher.publish_payload(payload)
        except BusError as error:
            if not self._endures or not self.count:
                raise
            if not self._is_cut_off:
                talk(f"lcmtools pub: {error.what}; waiting for the network")
            self._is_cut_off = True
            return False
        if self._is_cut_off:
            talk("lcmtools pub: messages leave again")
        self._is_cut_off = False
        return True


def send_all(sender: Sender, drafts: Iterator[MessageTemplate[Message] | None], pace: Pace) -> None:
    """Send messages until there are no more, or enough of them."""
    period = 1 / pace.rate if pace.rate else 0.0
    due = time.monotonic()
    for draft in drafts:
        if draft is None:
            sender.attend()
            continue
        sender.pause(due - time.monotonic())
        sender.send(draft)
        if sender.count == pace.count:
            break
        behind = time.monotonic() - due - period
        due += period + (behind if behind > max(_MOST_BEHIND, period) else 0.0)
    sender.pause(pace.stay)
