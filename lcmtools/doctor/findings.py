"""Findings and rules. A finding is data, without sentences: ``words`` puts it into words.

Belongs here: what a rule yields, and what a rule is. Must not know any rule.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TypeAlias

from lcmtools.doctor.evidence import Evidence, LcmProcess, Listener, SenderFacts
from lcmtools.graph.model import Node


class Severity(IntEnum):
    """The gravity of a finding; the greatest one is the exit code of ``wtf``, a note counts 0."""

    NOTE = 0
    WARNING = 1
    ERROR = 2


@dataclass(frozen=True, slots=True)
class Subject:
    """Something that a finding is about.

    Attributes:
        kind: "node", "process", "topic", "sender", "listener", "host", "interface", "user" or
            "bus".
        name: Its name, for people.
        pid: Its process on this computer; None where there is none or it is not known.
        address: Its address in the network; "" where it has none or it is not known.
    """

    kind: str
    name: str
    pid: int | None = None
    address: str = ""

    def __str__(self) -> str:
        """Return the name."""
        return self.name

    @classmethod
    def topic(cls, name: str) -> "Subject":
        """A channel."""
        return cls("topic", name)

    @classmethod
    def node(cls, node: Node) -> "Subject":
        """A node, with its process on its own computer."""
        return cls("node", node.name, node.pid, str(node.sender or ""))

    @classmethod
    def process(cls, process: LcmProcess) -> "Subject":
        """A process of this user."""
        return cls("process", process.command, process.pid)

    @classmethod
    def sender(cls, sender: SenderFacts) -> "Subject":
        """A sender of messages."""
        return cls("sender", sender.name, address=str(sender.sender))

    @classmethod
    def named(cls, name: str, pid: int | None = None, address: str = "") -> "Subject":
        """A sender as it is called for people."""
        return cls("sender", name, pid, address)

    @classmethod
    def listener(cls, listener: Listener) -> "Subject":
        """A program that receives from the bus."""
        return cls("listener", listener.name, listener.pid)


Part: TypeAlias = Subject | str | int | float | tuple[Subject, ...] | tuple[str, ...]
"""A subject, or a measured value."""


@dataclass(frozen=True, slots=True)
class Statement:
    """A title, a fact or a remedy: what kind it is, and the subjects and values in it.

    Attributes:
        kind: The key of its sentence in ``words``; of a remedy, what to do ("wake", "export").
        parts: Subjects and values by their names.
    """

    kind: str
    parts: Mapping[str, Part]

    def subjects(self) -> Iterator[Subject]:
        """Every subject in it."""
        for part in self.parts.values():
            for one in part if isinstance(part, tuple) else (part,):
                if isinstance(one, Subject):
                    yield one


def state(kind: str, **parts: Part) -> Statement:
    """A statement of this kind."""
    return Statement(kind, parts)


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is, or may be, wrong.

    Attributes:
        title: The fault.
        facts: The single cases of it, or what else is known.
        remedies: What to type or change.
        severity: Its gravity.
        rule: The id of the rule that found it ("unconnected-subscriptions").
    """

    title: Statement
    facts: tuple[Statement, ...] = ()
    remedies: tuple[Statement, ...] = ()
    severity: Severity = Severity.WARNING
    rule: str = ""

    def subjects(self) -> list[Subject]:
        """Everything it is about, each once."""
        statements = (self.title, *self.facts)
        return list(dict.fromkeys(one for s in statements for one in s.subjects()))


@dataclass(frozen=True, slots=True)
class Unchecked:
    """Something that could not be looked at.

    Attributes:
        rule: The id of the rule that would need it.
        reason: The reason.
    """

    rule: str
    reason: Statement


Check = Callable[[Evidence], Iterator[Finding]]
"""Looks at the evidence and yields findings, of which ``Rule.examine`` says whose they are."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule of ``wtf``.

    Attributes:
        id: Its name ("unconnected-subscriptions").
        severity: The severity of its gravest finding.
        explanation: A paragraph: what should be true, and why that matters.
        remedy: The usual cure; findings give it more exactly.
        check: The rule itself.
    """

    id: str
    severity: Severity
    explanation: str
    remedy: str
    check: Check

    @property
    def title(self) -> str:
        """The first sentence of the explanation."""
        return self.explanation.partition(". ")[0].rstrip(".")

    def examine(self, evidence: Evidence) -> list[Finding]:
        """Everything that this rule finds."""
        return [replace(finding, rule=self.id) for finding in self.check(evidence)]


def rule(identifier: str, severity: Severity, remedy: str) -> Callable[[Check], Rule]:
    """Make a check a rule; its docstring is the explanation."""

    def make(check: Check) -> Rule:
        explanation = " ".join((check.__doc__ or "").split())
        return Rule(identifier, severity, explanation, remedy, check)

    return make
