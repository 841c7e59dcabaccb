"""Messages that did not arrive, counted per sender.

A sender numbers the messages of all its topics together, so loss is a sender's, not a topic's.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from lcmtools.wire.packet import Sender
from lcmtools.wire.sequence import Sequence


class Loss(NamedTuple):
    """Messages of a sender that did not arrive, ``lost`` of the ``sent`` by its own numbers."""

    lost: int = 0
    sent: int = 0

    @property
    def share(self) -> float:
        """The lost fraction, 0 to 1."""
        return self.lost / self.sent if self.sent else 0.0

    def __add__(self, other: "Loss") -> "Loss":  # type: ignore[override] # not tuple addition
        """Return the sum of both, for a node with several senders."""
        return Loss(self.lost + other.lost, self.sent + other.sent)

    def __sub__(self, before: "Loss") -> "Loss":
        """Return the loss since an earlier count."""
        lost = max(0, self.lost - before.lost)
        arrived = (self.sent - self.lost) - (before.sent - before.lost)
        return Loss(lost, lost + max(0, arrived))

    def __str__(self) -> str:
        """Return the loss as text: "12 of 120 (10.0 %)"."""
        return f"{self.lost} of {self.sent} ({100 * self.share:.1f} %)"


Losses = Mapping[Sender, Loss]  # the loss of each sender whose messages have numbers


def losses(numbers: Mapping[Sender, Sequence], since: Losses | None = None) -> dict[Sender, Loss]:
    """Return the loss of each sender (see ``Tap.numbered``), since an earlier count."""
    return {
        sender: Loss(found.lost, found.lost + found.messages) - (since or {}).get(sender, Loss())
        for sender, found in tuple(numbers.items())  # the receiving thread may add one now
    }


def total(senders: Iterable[Sender | None], known: Losses) -> Loss | None:
    """Return the loss of several senders together; None if they have no known numbers."""
    found = [known[sender] for sender in senders if sender is not None and sender in known]
    return sum(found, Loss()) if found else None
