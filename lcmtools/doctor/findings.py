"""Findings and rules. A finding is data; ``sentences`` formats it as text.

Belongs here: the types of findings and rules. Must not know any rule.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from types import MappingProxyType
from typing import Any, TypeAlias

from lcmtools.doctor.evidence import (
    Evidence,
    HostClock,
    LcmProcess,
    Listener,
    Publication,
    SenderFacts,
    Stream,
)
from lcmtools.graph.model import NodeInfo


class Severity(IntEnum):
    """The severity of a finding. The highest one is the exit code of ``wtf``; a note counts 0."""

    NOTE = 0
    WARNING = 1
    ERROR = 2


@dataclass(frozen=True, slots=True)
class Subject:
    """Something that a finding is about."""

    kind: str  # node, process, topic, service, sender, listener, host, interface, user or bus
    name: str  # as it is displayed
    pid: int | None = None  # its process on this computer, if known
    address: str = ""  # in the network, if known

    def __str__(self) -> str:
        """Return the name."""
        return self.name


Observed: TypeAlias = (
    NodeInfo | LcmProcess | SenderFacts | Stream | Publication | Listener | HostClock
)
"""A value of the evidence that a finding can be about."""
Part: TypeAlias = Subject | str | int | float | tuple[Subject, ...] | tuple[str, ...]
"""A subject, or a measured value."""

Sentences: TypeAlias = Mapping[str, str]
"""Templates of statements by their kinds, as ``sentences`` formats them."""

_KINDS = {
    **dict.fromkeys(("topic", "topics", "awaited", "other_topic", "channel"), "topic"),
    **dict.fromkeys(("sender", "senders", "other_sender", "program", "programs", "by"), "sender"),
    **dict.fromkeys(("host", "hosts"), "host"),
    "service": "service",
    **dict.fromkeys(("user", "users"), "user"),
    **dict.fromkeys(("interface", "interfaces", "bridge"), "interface"),
}
"""The kind of the subject that a plain string becomes, by the part's name."""


def subject(observed: Observed) -> Subject:
    """Return a value of the evidence as a subject."""
    match observed:
        case NodeInfo():
            return Subject("node", observed.name, observed.pid, str(observed.sender or ""))
        case LcmProcess():
            return Subject("process", observed.command, observed.pid)
        case SenderFacts():
            return Subject("sender", observed.name, address=str(observed.sender))
        case Stream() | Publication():
            return Subject("sender", observed.name, observed.pid)
        case Listener():
            return Subject("listener", observed.name, observed.pid)
        case HostClock():
            return Subject("host", observed.host, address=observed.address)


@dataclass(frozen=True, slots=True)
class Statement:
    """A title, a fact or a remedy: its kind, and the subjects and values in it by their names."""

    kind: str  # the key of its sentence in its rule; of a remedy, what to do ("wake", "export")
    parts: Mapping[str, Part]
    sentence: str = "%s"  # the template of its text; %s until the sentence of its rule is known
    claims: tuple[Subject, ...] = ()  # of which it is, too, although its text does not name them

    def worded(self, sentences: Sentences) -> "Statement":
        """Return the statement with the sentence of its kind."""
        return replace(self, sentence=self.sentence.replace("%s", sentences[self.kind]))

    def of(self, kind: str, *names: str) -> "Statement":
        """Return the statement with further claims."""
        more = (Subject(kind, name) for name in names)
        return replace(self, claims=(*self.claims, *more))

    def subjects(self) -> Iterator[Subject]:
        """Yield every subject that its text may name."""
        for part in self.parts.values():
            for one in part if isinstance(part, tuple) else (part,):
                if isinstance(one, Subject):
                    yield one


def state(kind: str, **parts: Part | Observed | Iterable[Subject | str]) -> Statement:
    """Make a statement; values of the evidence and names become subjects."""
    return Statement(kind, {name: _part(name, value) for name, value in parts.items()})


def _part(name: str, value: Any) -> Any:  # noqa: ANN401 - a part of any kind, and one element of it
    if isinstance(value, Observed):
        return subject(value)
    if isinstance(value, str):
        return Subject(_KINDS[name], value) if name in _KINDS else value
    if isinstance(value, Iterable):
        return tuple(_part(name, one) for one in value)
    return value


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is, or may be, wrong."""

    title: Statement  # the fault
    facts: tuple[Statement, ...] = ()  # its single cases, or further observations
    remedies: tuple[Statement, ...] = ()  # commands and changes
    severity: Severity = Severity.ERROR  # its rule limits it
    rule: str = ""  # the id of the rule that found it ("unconnected-subscriptions")

    def subjects(self) -> list[Subject]:
        """Return the subjects of the title and the facts, each once."""
        statements = (self.title, *self.facts)
        return list(dict.fromkeys(one for s in statements for one in s.subjects()))


def finding(
    title: str | Statement,
    facts: Iterable[Statement] | None = None,
    *remedies: str | Statement,
    severity: Severity = Severity.ERROR,
) -> Iterator[Finding]:
    """Yield a finding without repeated remedies. Yield nothing if ``facts`` is given but empty.

    A string is the kind of a statement without parts. The rule limits the severity.
    """
    items = tuple(facts or ())
    if items or facts is None:
        distinct = {repr(one): one for one in map(_statement, remedies)}
        yield Finding(_statement(title), items, tuple(distinct.values()), severity)


def _statement(stated: str | Statement) -> Statement:
    return Statement(stated, {}) if isinstance(stated, str) else stated


@dataclass(frozen=True, slots=True)
class Unchecked:
    """A rule that lacks evidence, and the reason."""

    rule: str
    reason: Statement


_NONE: Sentences = MappingProxyType({})

Check = Callable[[Evidence], Iterator[Finding]]


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """A rule of ``wtf``."""

    id: str  # its name ("unconnected-subscriptions")
    severity: Severity  # the highest severity of its findings
    explanation: str  # a paragraph: what should be true, and why that matters
    remedy: str  # the usual one; findings are more exact
    check: Check  # looks at the evidence and yields findings
    titles: Sentences  # of findings, by the kinds of their titles
    facts: Sentences
    remedies: Sentences
    evidence: str  # its input
    unless: Mapping[str, str]  # rules that explain what it finds, by ids: ``arbiter``
    root_only: str  # the part of its input that only root can see

    @property
    def summary(self) -> str:
        """The first sentence of the explanation."""
        return self.explanation.partition(". ")[0].rstrip(".")

    def examine(self, evidence: Evidence) -> list[Finding]:
        """Return the findings of this rule."""
        return [self._completed(finding) for finding in self.check(evidence)]

    def _completed(self, finding: Finding) -> Finding:
        return Finding(
            finding.title.worded(self.titles),
            tuple(fact.worded(self.facts) for fact in finding.facts),
            tuple(remedy.worded(self.remedies) for remedy in finding.remedies),
            min(finding.severity, self.severity),
            self.id,
        )


def rule(  # noqa: PLR0913 - all that is known of a rule
    identifier: str,
    *,
    remedy: str,
    title: str | Sentences,
    evidence: str,
    facts: Sentences = _NONE,
    remedies: Sentences = _NONE,
    severity: Severity = Severity.WARNING,
    unless: Mapping[str, str] = _NONE,
    root_only: str = "",
) -> Callable[[Check], Rule]:
    """Make a rule of a check; its docstring is the explanation.

    ``title`` is a sentence if findings have one title, whose kind is the id of the rule. ``remedy``
    is the usual one, ``evidence`` the input of the rule, ``root_only`` what only root can see of
    it, and ``unless`` the rules whose findings explain those of this one (``arbiter``).
    """

    def make(check: Check) -> Rule:
        explanation = " ".join((check.__doc__ or "").split())
        titles = {identifier: title} if isinstance(title, str) else title
        texts = titles, facts, remedies
        return Rule(
            *(identifier, severity, explanation, remedy, check, *texts, evidence, unless),
            root_only,
        )

    return make
