"""The step that drops what an earlier rule has explained.

A finding claims what its statements name, and what they claim besides. A rule says in ``unless``
which rules explain what it finds, and by claims of which kind:

``topic``, ``who``
    a topic or service; the name of a node, program, sender or computer
``pid``
    a process of this computer
``pair``
    somebody and a topic, as one
"" (nothing)
    any finding of that rule explains all of this one's
any other
    claims that the statements make by ``Statement.of``: of topics that nobody publishes any more
    (``published``), for example

Statements about what is claimed are dropped: facts, remedies, and single ones of several topics. A
finding without facts is dropped, too. Pure.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from lcmtools.doctor.findings import Finding, Rule, Statement, Subject

_TOPICS = ("topic", "service")
_OF_TOPICS = ("published", "subscribed", "suggested")  # claims of topics, as ``topic``
_OF_NAMES = ("misled", "far")  # claims of names, as ``who``

_Claims = Mapping[str, set[str]]  # by kind


def arbitrate(findings: Mapping[Rule, list[Finding]], remote: Iterable[str]) -> list[Finding]:
    """Return the findings that no other explains, in the order of their rules.

    ``remote`` are nodes of other computers, whose process numbers mean nothing here.
    """
    known, far = {rule.id: rule for rule in findings}, frozenset(remote)
    settled: dict[str, list[Finding]] = {}
    claimed: dict[str, _Claims] = {}

    def settle(rule: Rule) -> None:  # after those that explain what it finds
        found = findings[rule]
        for other, kinds in rule.unless.items():
            if other in known and other not in settled:
                settle(known[other])
            if settled.get(other):
                found = [left for one in found for left in _left(one, kinds, claimed[other], far)]
        settled[rule.id], claimed[rule.id] = found, _claimed(found, far)

    for rule in findings:
        if rule.id not in settled:
            settle(rule)
    return [_with_distinct_remedies(one) for rule in findings for one in settled[rule.id]]


def _claimed(findings: Iterable[Finding], far: frozenset[str]) -> _Claims:
    claims: dict[str, set[str]] = defaultdict(set)
    statements = (one for finding in findings for one in (finding.title, *finding.facts))
    for kind, name in (claim for statement in statements for claim in _claims(statement, far)):
        claims[kind].add(name)
    return claims


def _with_distinct_remedies(finding: Finding) -> Finding:
    """Return a finding whose remedies are there once, whatever they claimed."""
    bare = (replace(one, claims=()) for one in finding.remedies)
    return replace(finding, remedies=tuple({repr(one): one for one in bare}.values()))


def _left(finding: Finding, kinds: str, claimed: _Claims, far: frozenset[str]) -> Iterator[Finding]:
    """Yield what is left of a finding."""
    for kind in kinds.split() or [""]:
        names = claimed.get(kind, set())
        if not kind or _is_about(finding.title, kind, names, far):
            return
        facts = tuple(_unclaimed(finding.facts, kind, names, far))
        if facts != finding.facts:
            if not any(any(_keys(one, kind, far)) for one in facts):
                return  # the other facts are about those
            remedies = tuple(_unclaimed(finding.remedies, kind, names, far))
            finding = replace(finding, facts=facts, remedies=remedies)
    yield finding


def _unclaimed(
    statements: Iterable[Statement], kind: str, names: set[str], far: frozenset[str]
) -> Iterator[Statement]:
    """Yield the statements that are not about claimed ones, with the rest of their topics."""
    for one in statements:
        topics = one.parts.get("topics")
        if isinstance(topics, tuple) and kind not in ("who", "pid", *_OF_NAMES):
            before = f"{_who(one)} " if kind == "pair" else ""
            left = tuple(str(x) for x in topics if f"{before}{x}" not in names)
            if left:
                kept = tuple(Subject("topic", name) for name in left)
                yield replace(one, parts={**one.parts, "topics": kept})
        elif not _is_about(one, kind, names, far):
            yield one


def _is_about(statement: Statement, kind: str, names: set[str], far: frozenset[str]) -> bool:
    return not names.isdisjoint(_keys(statement, kind, far))


def _keys(statement: Statement, kind: str, far: frozenset[str]) -> Iterator[str]:
    """Yield what a statement is about, as a claim of this kind."""
    alike = "topic" if kind in _OF_TOPICS else "who" if kind in _OF_NAMES else kind
    return (name for known, name in _claims(statement, far) if known in (kind, alike))


def _claims(statement: Statement, far: frozenset[str]) -> Iterator[tuple[str, str]]:
    """Yield what a statement claims: kinds and names."""
    who = _who(statement)
    for one in statement.subjects():
        if one.kind in _TOPICS:
            yield "topic", one.name
            yield "pair", f"{who} {one.name}"
        else:
            yield "who", one.name
            if one.pid and not (one.kind == "node" and one.name in far):
                yield "pid", str(one.pid)
    yield from ((one.kind, one.name) for one in statement.claims)


def _who(statement: Statement) -> str:
    """Return the name of the first one in a statement that is no topic."""
    names = (one.name for one in statement.subjects() if one.kind not in _TOPICS)
    return next(names, "")
