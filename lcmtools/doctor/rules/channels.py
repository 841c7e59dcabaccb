"""The rule about the names of channels."""

import re
from collections.abc import Iterator
from itertools import combinations

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Severity, Statement, cases, rule, state
from lcmtools.doctor.renaming import are_near
from lcmtools.doctor.rules.connections import proposed_ways

_LONG_NAME = 60  # bytes; LCM takes 63


@rule("names", "use letters, digits, _ and /, at most 63 bytes, and the same everywhere")
def names_are_good(evidence: Evidence) -> Iterator[Finding]:
    """Channels have names that every program can subscribe to, and no two that look the same.

    liblcm matches names as UTF-8 text: others never arrive. It carries at most 63 bytes.
    """
    proposed = {way.channel for way in proposed_ways(evidence)}  # reported with its subscription
    senders = {s.channel: s.name for s in evidence.streams if s.channel not in proposed}
    bad = [c for c in senders if not c.isprintable() or c != c.strip() or not _matches_itself(c)]
    bad += [c for c in senders if not c]

    def facts(kind: str, channels: list[str]) -> Iterator[Statement]:
        return (state(kind, topic=name, sender=senders[name]) for name in channels)

    patterns = [c for c in bad if c and not _matches_itself(c)]
    remedies = [state("subscribe-to-pattern", pattern=re.escape(c)) for c in patterns[:1]]
    yield from cases("unusable-names", facts("odd-channel", bad), "plain-name", *remedies)
    long = [c for c in senders if len(c.encode("utf-8", "surrogateescape")) >= _LONG_NAME]
    note = Severity.NOTE
    yield from cases("long-names", facts("channel", long), "shorter-name", severity=note)
    alike = (
        state("two-channels", topic=a, sender=senders[a], other_topic=b, other_sender=senders[b])
        for a, b in combinations(sorted(senders), 2)
        if _look_alike(a, b)
    )
    yield from cases("similar-names", alike, "same-name", severity=note)


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
