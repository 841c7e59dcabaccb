"""Sending messages on schedule: as they come, at a rate, and again to late subscribers.

Belongs here: the schedule. Must not know where messages come from.
"""

import itertools
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from lcmtools.errors import BusError, UsageError
from lcmtools.messages.registry import Message
from lcmtools.node.node import Node
from lcmtools.node.publisher import Publisher
from lcmtools.node.spinning import spin_once
from lcmtools.publish.incoming import Incoming, Notify, Template

OnSent: TypeAlias = Callable[[int, Message, bool], None]
"""Called with a message's number, the message, and True if it was sent again."""

_POLL = 0.02  # [s] between two checks for new subscribers
_MOST_BEHIND = 0.1  # [s] of delay that is made up for; after a suspend no burst is sent
_FILE_RATE = 10.0  # [Hz], as in rostopic
_TIMES_RATE = 1.0  # [Hz], as in ros2


@dataclass(frozen=True, slots=True, kw_only=True)
class Schedule:
    """The schedule of messages, by the rules of rostopic and ros2."""

    rate: float | None = None  # [Hz]; None to send messages as they come
    count: int | None = None  # number of messages; None for all
    is_endless: bool = False  # start again after the last one
    stay: float = 0.0  # time to wait after the last message for late subscribers [s]
    notice: str = field(default="", compare=False)  # for the person, where more goes on


def schedule_for(
    incoming: Incoming,
    *,
    rate: float | None = None,
    count: int | None = None,
    latch: bool = False,
    keep_alive: float | None = None,
) -> Schedule:
    """Return the schedule for messages from a source; see ``publish`` for the options.

    Raises:
        UsageError: The rate or the count is not positive.
    """
    if rate is not None and not 0 < rate < math.inf:
        raise UsageError(f"publish: the rate is a positive number of Hz, got {rate}")
    if count is not None and count < 1:
        raise UsageError(f"publish: the count is a number of messages from 1 on, got {count}")
    is_alone = incoming.is_one and not incoming.is_file and rate is None and count is None
    repeats = rate is not None or (incoming.is_file and not latch)
    usual = _TIMES_RATE if count and incoming.is_one else None
    stay = (math.inf if latch or is_alone else 0.0) if keep_alive is None else keep_alive
    is_endless = incoming.is_one and not count and repeats
    notice = ""
    if stay == math.inf:
        notice = "publishing and latching message. Press ctrl-C to terminate"
    elif is_endless and not rate:
        notice = f"publishing the single message {_FILE_RATE:g} times a second, until Ctrl-C"
    rate = rate or (_FILE_RATE if incoming.is_file else usual)
    return Schedule(rate=rate, count=count, is_endless=is_endless, stay=stay, notice=notice)


def due_times(rate: float | None, most_behind: float = 0.0) -> Iterator[float]:
    """Yield the times [s, monotonic] to send at, from now on; without a rate [Hz], immediately.

    Take each when the previous message has been sent. A delay of up to ``most_behind`` [s] is made
    up for; a longer one postpones the rest.
    """
    period = 1 / rate if rate else 0.0
    due = time.monotonic()
    while True:
        yield due
        behind = time.monotonic() - due - period
        due += period + (behind if behind > most_behind else 0.0)


class BrokenOff(UsageError):  # noqa: N818 - named for what happened, as in errors.py
    """A stream failed after some of its messages had been sent."""

    exit_code = 1


@dataclass(slots=True)
class ScheduledPublisher:
    """Sends messages with a publisher of a node, whose clock gives the stamps."""

    node: Node
    publisher: Publisher[Message]
    latch: bool  # send the last message again to each late subscriber
    endures: bool  # if the network fails after the first message, wait for it
    notify: Notify
    on_sent: OnSent
    count: int = 0  # number of messages sent
    last: Template | None = None  # that was sent, or was to be
    _is_cut_off: bool = False
    _served: frozenset[str] = frozenset()
    _next_look: float = 0.0

    def send_all(self, incoming: Incoming, schedule: Schedule) -> None:
        """Send messages until there are no more, or enough have been sent.

        Raises:
            BusError: The bus does not accept one, and ``endures`` does not apply.
            BrokenOff: The stream fails after some messages.
        """
        repeats = schedule.is_endless or (schedule.count and not incoming.is_stream)
        templates = itertools.cycle(incoming.templates) if repeats else incoming.templates
        most_behind = max(_MOST_BEHIND, 1 / schedule.rate if schedule.rate else 0.0)
        due = due_times(schedule.rate, most_behind)
        for template in self._unbroken(templates):
            if template is None:
                self._attend()
                continue
            self._pause(next(due) - time.monotonic())
            self._send(template)
            if self.count == schedule.count:
                break
        self._pause(schedule.stay)

    @property
    def _spins(self) -> bool:
        return bool(self.node.get_parameter("use_sim_time").value)

    def _unbroken(self, templates: Iterator[Template | None]) -> Iterator[Template | None]:
        """The messages; if an error follows some, it reports the number that has been sent."""
        try:
            yield from templates
        except UsageError as error:
            if not self.count:
                raise
            sent = "1 message has" if self.count == 1 else f"{self.count} messages have"
            hint = f"{error.hint}; " if error.hint else ""
            raise BrokenOff(error.what, f"{hint}{sent} been sent") from None

    def _send(self, template: Template) -> None:
        self.last = template
        if not self._is_sent(template):
            return
        self.count += 1
        if self.latch:
            self._served = self.publisher.subscriber_ids()
        self.on_sent(self.count, template.message, False)  # noqa: FBT003 - the first time

    def _pause(self, seconds: float) -> None:
        """Wait, and serve late subscribers meanwhile."""
        end = time.monotonic() + seconds
        while True:
            self._attend()
            left = end - time.monotonic()
            if left <= 0:
                return
            step = min(left, _POLL) if self.latch else left
            if self._spins:
                spin_once(self.node, step)
            else:
                time.sleep(step)

    def _attend(self) -> None:
        if self._spins:
            spin_once(self.node)
        if not self.latch or self.last is None or time.monotonic() < self._next_look:
            return
        self._next_look = time.monotonic() + _POLL
        present = self.publisher.subscriber_ids()
        if present - self._served and self._is_sent(self.last):
            self.on_sent(self.count, self.last.message, True)  # noqa: FBT003 - again
        self._served = present

    def _is_sent(self, template: Template) -> bool:
        """Send a message; return False if the network has failed, which is notified once."""
        payload = template.payload(self.node.get_clock().now())
        try:
            self.publisher.publish_payload(payload)
        except BusError as error:
            if not self.endures or not self.count:
                raise
            if not self._is_cut_off:
                self.notify(f"{error.what}; waiting for the network")
            self._is_cut_off = True
            return False
        if self._is_cut_off:
            self.notify("messages are sent again")
        self._is_cut_off = False
        return True
