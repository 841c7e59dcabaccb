"""The rule about the names of channels."""

import re
from collections.abc import Iterator
from itertools import combinations

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Severity, Statement, Subject, rule, state
from lcmtools.doctor.renaming import are_near
from lcmtools.doctor.rules.connections import proposed_ways

_LONG_NAME = 60  # bytes; LCM takes 63


@rule(
    "names",
    Severity.WARNING,
    "use letters, digits, _ and /, at most 63 bytes, and the same everywhere",
)
def names_are_good(evidence: Evidence) -> Iterator[Finding]:
    """Channels have names that every program can subscribe to, and no two that look the same.

    liblcm matches names as UTF-8 text: others never arrive. It carries at most 63 bytes.
    """
    proposed = {way.channel for way in proposed_ways(evidence)}  # reported with its subscription
    senders = {s.channel: s.name for s in evidence.streams if s.channel not in proposed}
    bad = [c for c in senders if not c.isprintable() or c != c.strip() or not _matches_itself(c)]
    bad += [c for c in senders if not c]

    def facts(channels: list[str], kind: str) -> tuple[Statement, ...]:
        return tuple(
            state(kind, topic=Subject.topic(c), sender=Subject.named(senders[c])) for c in channels
        )

    if bad:
        patterns = [c for c in bad if c and not _matches_itself(c)]
        remedies = [state("plain-name")]
        remedies += [state("subscribe-to-pattern", pattern=re.escape(c)) for c in patterns[:1]]
        yield Finding(state("unusable-names"), facts(bad, "odd-channel"), tuple(remedies))
    long = [c for c in senders if len(c.encode("utf-8", "surrogateescape")) >= _LONG_NAME]
    if long:
        remedies = [state("shorter-name")]
        yield Finding(state("long-names"), facts(long, "channel"), tuple(remedies), Severity.NOTE)
    pairs = [(a, b) for a, b in combinations(sorted(senders), 2) if _look_alike(a, b)]
    if pairs:
        alike = (
            state(
                "two-channels",
                topic=Subject.topic(a),
                sender=Subject.named(senders[a]),
                other_topic=Subject.topic(b),
                other_sender=Subject.named(senders[b]),
            )
            for a, b in pairs
        )
        yield Finding(state("similar-names"), tuple(alike), (state("same-name"),), Severity.NOTE)


def _matches_itself(channel: str) -> bool:
    """Return whether the name, which liblcm takes as a pattern, matches the name."""
    if channel.startswith("#!"):  # LCM's own
        return True
    try:
        return re.fullmatch(channel, channel) is not None
    except re.error:
        return False


def _look_alike(one: str, other: str) -> bool:
    """Return whether two names differ in case, slashes or spaces only."""
    first, second = one.casefold().strip(" /"), other.casefold().strip(" /")
    return first == second and are_near(one, other)
