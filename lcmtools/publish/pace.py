"""When to send which messages, by what was asked for and by where they come from.

Belongs here: rostopic's and ros2's rules for it. Must not know how anything is sent.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.registry import Message
from lcmtools.publish.incoming import Incoming

_FILE_RATE = 10.0  # [Hz], as rostopic
_TIMES_RATE = 1.0  # [Hz], as ros2


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """When messages are sent.

    Attributes:
        rate: Messages a second; None for as they come.
        count: How many; None for all.
        is_endless: Whether they begin anew when all are sent.
        stay: How long to stay after the last [s], for those who subscribe late.
    """

    rate: float | None = None
    count: int | None = None
    is_endless: bool = False
    stay: float = 0.0

    def drafts(self, incoming: Incoming) -> Iterator[MessageTemplate[Message] | None]:
        """The messages, over and over where that is wanted."""
        repeats = self.is_endless or (self.count and not incoming.is_stream)
        return itertools.cycle(incoming.drafts) if repeats else incoming.drafts


@dataclass(frozen=True, slots=True)
class PublishOptions:
    """What the options say about when to send.

    Attributes:
        rate: Messages a second; None where nothing was said.
        count: How many; None where nothing was said.
        once: -1 was given, and so is the count.
        latches: -l was given.
        keep_alive: How long to stay after the last [s]; None where nothing was said.
    """

    rate: float | None
    count: int | None
    once: bool
    latches: bool
    keep_alive: float | None

    def pace(self, incoming: Incoming) -> Pace:
        """When to send what comes in."""
        is_endless = incoming.is_one and not self.count and self._repeats(incoming)
        return Pace(
            rate=self.rate or self._usual_rate(incoming),
            count=self.count,
            is_endless=is_endless,
            stay=self._stay(incoming),
        )

    def _repeats(self, incoming: Incoming) -> bool:
        return self.rate is not None or (incoming.is_file and not self.latches)

    def _usual_rate(self, incoming: Incoming) -> float | None:
        if incoming.is_file:
            return _FILE_RATE
        return _TIMES_RATE if self.count and incoming.is_one else None

    def _stay(self, incoming: Incoming) -> float:
        """A message on the command line is latched unless something else is asked for."""
        if self.keep_alive is not None:
            return self.keep_alive
        is_alone = incoming.is_one and not incoming.is_file and self.rate is None
        latches = self.latches or (is_alone and self.count is None)
        return math.inf if latches and not self.once else 0.0
