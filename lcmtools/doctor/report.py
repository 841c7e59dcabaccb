"""Findings as text in the style of roswtf, as JSON, and as changes between two looks.

Also the rules that lack evidence, with the reasons.

Pure: findings in, lines and plain values out.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from itertools import groupby

from lcmtools.color import BOLD, RED, YELLOW, paint
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import (
    Finding,
    Part,
    Rule,
    Severity,
    Statement,
    Subject,
    Unchecked,
    state,
)
from lcmtools.doctor.rules import examine
from lcmtools.doctor.sentences import (
    commands,
    describe,
    fact_lines,
    line_count,
    remedy_text,
    unchecked_text,
)
from lcmtools.errors import InvalidFile, UnknownType
from lcmtools.messages.registry import message_class

_MOST = 24  # items, or remedies, of a finding in text
_HEADINGS = {
    Severity.ERROR: ("error(s)", "Something is wrong, and will not work as it is"),
    Severity.WARNING: (
        "warning(s)",
        "Warnings are things that may be just fine, but are sometimes at fault",
    ),
    Severity.NOTE: ("note(s)", "Notes are seldom at fault"),
}
_COLORS = {"ERROR": RED, "WARNING": YELLOW, "NOTE": BOLD, "CLEARED": BOLD}


def text(findings: Sequence[Finding]) -> list[str]:
    """Format findings by severity, with a count for each."""
    is_well = all(finding.severity is Severity.NOTE for finding in findings)
    rows = ["No errors or warnings", ""] if is_well else []
    for severity, (noun, meaning) in _HEADINGS.items():
        group = [finding for finding in findings if finding.severity is severity]
        if group:
            rows += [f"Found {len(group)} {noun}.", meaning, ""]
        for finding in group:
            rows += [*finding_text(finding), ""]
    return rows[:-1]


def finding_text(finding: Finding) -> list[str]:
    """Format a finding with its items and remedies."""
    title, items, remedies = describe(replace(finding, facts=finding.facts[:_MOST]))
    left = sum(map(line_count, finding.facts[_MOST:]))
    rows = [*_shortened(items, " *", left), *_shortened([f"   -> {x}" for x in remedies], "   ->")]
    return [f"{finding.severity.name} {title}", *rows]


def _shortened(rows: Sequence[str], mark: str, left: int = 0) -> list[str]:
    """Return the first rows, and the number of the others (with ``left``); JSON has all of them."""
    if len(rows) + left <= _MOST:
        return list(rows)
    return [*rows[: _MOST - 1], f"{mark} … and {len(rows) + left - _MOST + 1} more"]


def change_text(change: str, finding: Finding) -> list[str]:
    """Format a changed finding. A cleared one is shown without its remedies."""
    if change != "cleared":
        return finding_text(finding)
    words = describe(finding)
    return [f"CLEARED {words.title}", *_shortened(words.items, " *")]


def colored(row: str) -> str:
    """Color the first word of a finding by its severity; other lines stay as they are."""
    word, space, rest = row.partition(" ")
    return f"{paint(word, _COLORS[word])}{space}{rest}" if word in _COLORS else row


def not_checked(evidence: Evidence, rules: Iterable[Rule]) -> list[str]:
    """Format the rules that lack evidence, a line for each reason, after an empty line."""
    records = groupby(unchecked_json(evidence, rules), lambda one: one["text"])
    groups = ((text, ", ".join(str(one["rule"]) for one in those)) for text, those in records)
    rows = [f"Not checked: {names} ({text})" for text, names in groups]
    return ["", *rows] if rows else []


def unchecked_json(evidence: Evidence, rules: Iterable[Rule]) -> list[dict[str, object]]:
    """Return the rules that lack evidence for JSON, with the keys of findings."""
    wanted = {rule.id for rule in rules}
    keys = ("items", "remedies", "subjects", "facts", "actions")
    empty: dict[str, list[object]] = {key: [] for key in keys}
    return [
        {
            "rule": one.rule,
            "severity": "unchecked",
            "text": unchecked_text(one),
            **empty,
            "values": _plain(one.reason),
        }
        for one in unchecked(evidence)
        if one.rule in wanted
    ]


def to_json(finding: Finding) -> dict[str, object]:
    """Return a finding for JSON: as text and as data."""
    words = describe(finding)
    return {
        "rule": finding.rule,
        "severity": finding.severity.name.lower(),
        "text": words.title,
        "items": [item.strip(" *") for item in words.items],
        "remedies": list(words.remedies),
        "subjects": [{**asdict(x), "address": x.address or None} for x in finding.subjects()],
        "values": _plain(finding.title),
        "facts": [_plain(fact) for fact in finding.facts],
        "actions": [
            {**_plain(remedy), "text": remedy_text(remedy), "commands": commands(remedy)}
            for remedy in finding.remedies
        ],
    }


def _plain(statement: Statement) -> dict[str, object]:

    def plain(part: Part) -> object:
        if isinstance(part, tuple):
            return [str(one) for one in part]
        return str(part) if isinstance(part, Subject) else part

    return {"kind": statement.kind, **{name: plain(p) for name, p in statement.parts.items()}}


def rules_text(rules: Sequence[Rule], *, in_full: bool) -> list[str]:
    """Return a line for each rule, or (``in_full``) its explanation and remedy."""
    rows, width = [], max(len(rule.id) for rule in rules)
    for rule in rules:
        severity = rule.severity.name.lower()
        if in_full:
            rows += [f"{rule.id} ({severity})", "", rule.explanation, "", f"   -> {rule.remedy}"]
        else:
            rows.append(f"{rule.id:{width}}  {severity:7}  {rule.summary}")
    return rows


def rule_json(rule: Rule) -> dict[str, object]:
    """Return a rule for JSON."""
    known = {"explanation": rule.explanation, "remedy": rule.remedy}
    return {"rule": rule.id, "severity": rule.severity.name.lower(), **known}


def watch(
    look: Callable[[], Evidence], rules: Sequence[Rule]
) -> Iterator[list[tuple[str, Finding]]]:
    """Yield the changes after each look, without end; first all findings."""
    known: list[Finding] = []
    while True:
        found = examine(look(), rules)
        yield list(changes(known, found))
        known = found


def changes(before: Iterable[Finding], now: Iterable[Finding]) -> Iterator[tuple[str, Finding]]:
    """Yield findings that "cleared", "appeared" or "changed" their subjects between two looks."""
    known, found = (
        {f"{one.rule} {_without_numbers(describe(one).title)}": one for one in findings}
        for findings in (before, now)
    )
    for key, finding in known.items():
        if key not in found:
            yield "cleared", finding
    for key, finding in found.items():
        if key not in known:
            yield "appeared", finding
            continue
        cases, old = _cases(finding.facts), _cases(known[key].facts)
        if gone := [fact for fact in known[key].facts if not _cases([fact]) <= cases]:
            yield "cleared", replace(known[key], facts=tuple(gone))
        if cases != old:
            yield "changed", finding


def _cases(facts: Iterable[Statement]) -> set[str]:
    """Return the facts of a finding as text, without measured values."""
    rows = (row for fact in facts for row in fact_lines(fact))
    return {_without_numbers(row.partition(": ")[0]) for row in rows}


def _without_numbers(text: str) -> str:
    """Replace numbers, which change from look to look, except those of processes."""
    return re.sub(r"(?<!pid )(?<![\w/.:])\d[\d.]*", "#", text)


_ROOT = 0
_OF_SOCKETS = ("kernel-drops", "stuck-listeners", "small-buffer", "interfaces", "other-users")
_REASONS = {
    "bandwidth-unknown": "{interface} reports no speed",
    "clocks-unknown": "no announcement of {hosts:list} tells when it was sent",
    "buffers-unknown": "this system does not report the size of the listeners' buffers",
    "hidden-programs": "programs of other users ({users:list}) are hidden from you: sudo lcmtools"
    " wtf shows them",
    "zenoh-losses": "wtf does not count losses on Zenoh; lcmtools hz TOPIC does",
    "no-senders": "on {provider}, wtf cannot see senders and losses",
    "no-network": "this system does not report its routes and interfaces (it has no /proc/net)",
    "no-processes": "this system does not report the sockets of programs (it has no /proc)",
    "no-sockets": "this system does not list its sockets (it has no /proc/net/udp)",
    "text": "{text}",
    "unusable-types": "{types:list} cannot be used: lcmtools msg list says why",
}
_OF_NETWORK = ("link", "bandwidth", "rp-filter", "igmp-querier")


def unchecked(evidence: Evidence) -> Iterator[Unchecked]:
    """Yield the rules that lack evidence; none if the bus does not work at all."""
    if evidence.bus_problem:
        return
    provider = evidence.url.partition("://")[0]
    if provider == "udpm":
        yield from _of_sockets(evidence)
        yield from _of_network(evidence)
    elif provider in ("tcpq", "mpudpm"):
        yield _unchecked("loss", "no-senders", provider=provider)
    elif provider == "zenoh":
        yield _unchecked("loss", "zenoh-losses")
    yield from _of_clocks(evidence)
    announced = sorted({name for topic in evidence.graph.topics() for name in topic.types})
    if types := [name for name in announced if not _is_usable(name)]:
        yield _unchecked("type-mismatch", "unusable-types", types=types)


def _is_usable(name: str) -> bool:
    """Return False for a type whose file is wrong; one without a file is no fault."""
    try:
        message_class(name, any_version=True)
    except InvalidFile:
        return False
    except UnknownType:
        pass
    return True


def _of_clocks(evidence: Evidence) -> Iterator[Unchecked]:
    """Yield the rule about clocks for the computers whose clocks could not be compared."""
    compared = {name for clock in evidence.clocks for name in clock.nodes}
    remote = [x for x in evidence.graph.nodes if x.id in evidence.remote and not x.stale]
    known = {node.host for node in remote if node.name in compared}
    hosts = sorted({node.host for node in remote} - known)
    if hosts:
        yield _unchecked("clocks", "clocks-unknown", hosts=hosts)


def _of_sockets(evidence: Evidence) -> Iterator[Unchecked]:
    host, own = evidence.host, evidence.host.uid
    if not host.has_sockets:
        yield from (_unchecked(rule, "no-sockets") for rule in _OF_SOCKETS)
        yield _unchecked("other-buses", "no-processes")
        return
    hidden = {listener.uid for listener in evidence.listeners if listener.pid is None} - {own}
    if hidden and own != _ROOT:
        users = [evidence.users.get(uid, str(uid)) for uid in sorted(hidden)]
        yield _unchecked("stuck-listeners", "hidden-programs", users=users)
    sizes = {listener.buffer_bytes for listener in evidence.listeners}
    if sizes == {None}:  # else a program has closed its socket meanwhile
        yield _unchecked("small-buffer", "buffers-unknown")


def _of_network(evidence: Evidence) -> Iterator[Unchecked]:
    """Yield rules about the network, which do not matter on a local bus."""
    host = evidence.host
    if not evidence.ttl:
        return
    if host.firewall_unknown:
        yield _unchecked("firewall", "text", text=host.firewall_unknown)
    if not host.has_sockets:
        yield from (_unchecked(rule, "no-network") for rule in _OF_NETWORK)
    elif host.interface not in ("", "lo") and not host.is_wireless and not host.speed_mbit:
        yield _unchecked("bandwidth", "bandwidth-unknown", interface=host.interface)


def _unchecked(rule: str, reason: str, **parts: Part | Iterable[Subject | str]) -> Unchecked:
    return Unchecked(rule, state(reason, **parts).worded(_REASONS))
