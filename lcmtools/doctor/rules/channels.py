"""The rule about the names of channels."""

import re
from collections.abc import Iterator
from itertools import combinations

from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.doctor.near_names import are_near
from lcmtools.doctor.rules.connections import said_ways

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
    said = {way.channel for way in said_ways(evidence)}  # with who should hear it
    senders: dict[str, str] = {s.channel: s.name for s in evidence.streams if s.channel not in said}
    bad = [c for c in senders if not c.isprintable() or c != c.strip() or not _matches_itself(c)]
    bad += [c for c in senders if not c]
    if bad:
        text = "The following channels have names that few programs can subscribe to:"
        rows = tuple(f" * {c!r} from {senders[c]}" for c in bad)
        patterns = [c for c in bad if c and not _matches_itself(c)]
        remedies = (f"or subscribe to the pattern {re.escape(patterns[0])}",) if patterns else ()
        advice = "publish on a name of letters, digits, _ and / only"
        yield Finding("names", Severity.WARNING, text, rows, (advice, *remedies))
    long = [c for c in senders if len(c.encode("utf-8", "surrogateescape")) >= _LONG_NAME]
    if long:
        text = "The following names are nearly as long as LCM can carry (63 bytes):"
        rows = tuple(f" * {c} from {senders[c]}" for c in long)
        yield Finding("names", Severity.NOTE, text, rows, ("publish on a shorter name",))
    pairs = [(a, b) for a, b in combinations(sorted(senders), 2) if _look_alike(a, b)]
    if pairs:
        text = "The following channels look like the same, and are not:"
        rows = tuple(f" * {a} from {senders[a]}, and {b} from {senders[b]}" for a, b in pairs)
        yield Finding("names", Severity.NOTE, text, rows, ("publish both on the same name",))


def _matches_itself(channel: str) -> bool:
    """Whether the name, which liblcm takes for a pattern, is one that the name fits."""
    if channel.startswith("#!"):  # LCM's own
        return True
    try:
        return re.fullmatch(channel, channel) is not None
    except re.error:
        return False


def _look_alike(one: str, other: str) -> bool:
    """Whether two names differ in case, slashes or spaces only."""
    return (
        len(one.strip(" /")) == len(other.strip(" /"))
        and are_near(one, other)
        and (one.casefold().strip(" /") == other.casefold().strip(" /"))
    )
