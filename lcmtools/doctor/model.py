"""Evidence and findings."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

from lcmtools.graph.model import Graph


class Severity(IntEnum):
    """How grave a finding is; the greatest one is the exit code of ``wtf``, a note counts 0."""

    NOTE = 0
    WARNING = 1
    ERROR = 2


@dataclass(frozen=True, slots=True)
class Evidence:
    """Everything that the rules may look at.

    Attributes:
        url: The bus.
        bus_problem: Why the bus cannot be used at all; "" when it can.
        bus_remedy: What to type against that.
        graph: What is known of the bus.
        listened: How long the traffic was watched [s].
        malformed: Senders of datagrams that are none of LCM's, with what is wrong.
    """

    url: str
    bus_problem: str = ""
    bus_remedy: str = ""
    graph: Graph = field(default_factory=Graph)
    listened: float = 0.0
    malformed: Sequence[tuple[str, str]] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is, or may be, wrong.

    Attributes:
        rule: The rule's id ("unconnected-subscriptions").
        severity: How grave.
        text: One line.
        items: Lines below it, indented as they should appear.
        remedies: What to type or change, one line each.
    """

    rule: str
    severity: Severity
    text: str
    items: tuple[str, ...] = ()
    remedies: tuple[str, ...] = ()


Rule = Callable[[Evidence], Iterator[Finding]]
"""Looks at the evidence and yields what it finds."""
