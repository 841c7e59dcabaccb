"""How many of a sender's messages did not come, as the commands that look at topics tell it.

Each sender numbers its messages, all its topics together; so what is lost is told of the sender.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from lcmtools.observe.monitor import BusMonitor
from lcmtools.wire.packet import Sender


@dataclass(frozen=True, slots=True)
class Loss:
    """What did not come of all that a sender sent, while somebody looked.

    Attributes:
        lost: How many messages.
        sent: Of how many, by the sender's own numbers.
    """

    lost: int = 0
    sent: int = 0

    def __add__(self, other: "Loss") -> "Loss":
        """Both together, where a node has several senders."""
        return Loss(self.lost + other.lost, self.sent + other.sent)

    def __str__(self) -> str:
        """As it is shown: "12 of 120 (10.0 %)"."""
        return f"{self.lost} of {self.sent} ({100 * self.lost / max(1, self.sent):.1f} %)"


def losses(monitor: BusMonitor) -> dict[Sender, Loss]:
    """What every sender lost so far; nothing where the bus does not tell."""
    tap = monitor.tap
    if tap is None:
        return {}
    return {
        sender: Loss(numbers.lost, numbers.lost + numbers.messages)
        for sender, numbers in tap.numbered.items()
    }


def total(senders: Iterable[Sender], known: Mapping[Sender, Loss]) -> Loss:
    """What several senders lost."""
    return sum((known[sender] for sender in senders if sender in known), Loss())
