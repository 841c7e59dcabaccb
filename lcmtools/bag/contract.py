"""A contract that a log can be held against: topics, types, rates, gaps, losses.

topics:
  /husky0/odometry:
    type: nav_msgs/Odometry
    min_rate: 45        # [Hz]
    max_rate: 55
    max_gap: 0.5        # [s] without a message
    min_messages: 100
    tolerance: 0.001    # of its numbers, when a program is run again (bag rerun)
    fields:
      pose.covariance: ignore
      twist.twist.linear.x: 5%
  /camera/**:           # at least one topic that matches, and each that does
    min_rate: 5
others: false           # no other topics
max_lost: 0             # messages, of all senders together
min_duration: 10        # [s]
tolerance: 1e-6         # of the numbers of all topics
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from lcmtools.bag.summary import LogSummary, TopicSummary
from lcmtools.errors import LcmtoolsError
from lcmtools.folders import read_bytes
from lcmtools.formats.typed import Item, load
from lcmtools.names import Pattern, is_hidden

_LIMITS: Mapping[str, tuple[str, Callable[[TopicSummary], float]]] = {
    "rate": ("{:.2f} Hz", lambda topic: topic.rate or 0.0),
    "gap": ("{:.3g} s", lambda topic: topic.longest_gap / 1e9),
    "messages": ("{:.0f} messages", lambda topic: topic.messages),
}
"""A topic's values that can have limits, with their names in texts."""
_OF_RERUN = {"tolerance", "relative", "delay"}
_OF_TOPIC = {"type", "match", "fields", *_OF_RERUN}
_OF_TOPIC |= {f"{side}_{name}" for side in ("min", "max") for name in _LIMITS}
_OF_LOG = {"topics", "others", "max_lost", "min_duration", "max_duration", *_OF_RERUN}
_MATCHES = ("stamp", "order")
_FIELD_TERM = re.compile(r"ignore|angle|\d+(?:\.\d*)?(?:e-?\d+)?%?")


@dataclass(frozen=True, slots=True)
class TopicTerms:
    """The terms for the topics that match a name or a pattern."""

    pattern: str
    line: int
    type: str = ""
    limits: Mapping[str, float] = field(default_factory=dict)  # by "min_rate" and so on
    match: str = ""  # "order" or "stamp", for ``bag rerun``
    fields: Mapping[str, str] = field(default_factory=dict)  # "0.01", "5%", "angle", "ignore"


@dataclass(frozen=True, slots=True)
class Contract:
    """The terms that a log must meet."""

    source: str
    topics: tuple[TopicTerms, ...] = ()
    others: bool = True  # True if other topics are allowed
    limits: Mapping[str, float] = field(default_factory=dict)  # "max_lost" and so on


@dataclass(frozen=True, slots=True)
class Breach:
    """A term that a log does not meet."""

    topic: str  # "" for the log
    text: str
    line: int  # of the contract; 0 for none

    def to_json(self) -> dict[str, object]:
        """Return the breach for JSON."""
        return {"topic": self.topic or None, "text": self.text, "line": self.line or None}


def read_contract(path: str | Path) -> Contract:
    """Return the contract in a file.

    Raises:
        InvalidFile: It is not a contract; the error has the line.
        LcmtoolsError: It cannot be read.
    """
    text = read_bytes(Path(path), kind=LcmtoolsError).decode("utf-8", "replace")
    keys = load(text, str(path), "contract").fields(_OF_LOG)
    topics, others = keys.pop("topics", None), keys.pop("others", None)
    return Contract(
        str(path),
        tuple(map(_terms, topics.mapping().values())) if topics else (),
        others is None or others.flag(),
        {key: _number(item) for key, item in keys.items()},
    )


def breaches(contract: Contract, summary: LogSummary) -> Iterator[Breach]:
    """Yield the terms that a log does not meet."""
    lost = sum(loss.lost for loss in summary.losses.values())
    if lost > contract.limits.get("max_lost", math.inf):
        yield Breach(
            "", f"{lost} messages were lost, at most {contract.limits['max_lost']:g} allowed", 0
        )
    values = {"duration": summary.duration}
    for text in _outside(contract.limits, values, {"duration": "{:.3g} s"}):
        yield Breach("", f"the log is {text}", 0)
    named: set[str] = set()
    for terms in contract.topics:
        pattern = Pattern(terms.pattern, hidden=True)
        found = [topic for topic in summary.topics if pattern.matches(topic.name)]
        named |= {topic.name for topic in found}
        if not found and terms.limits.get("max_messages") != 0:
            yield Breach(terms.pattern, "there are no messages", terms.line)
        for topic in found:
            yield from _of_topic(terms, topic)
    for topic in summary.topics if not contract.others else ():
        if topic.name not in named and not is_hidden(topic.name):
            yield Breach(topic.name, "the contract does not have this topic", 0)


def _of_topic(terms: TopicTerms, topic: TopicSummary) -> Iterator[Breach]:
    if terms.type and terms.type not in topic.types:
        types = ", ".join(topic.types) or "unknown"
        yield Breach(topic.name, f"the type is {types}, not {terms.type}", terms.line)
    values = {name: value(topic) for name, (_, value) in _LIMITS.items()}
    words = {name: words for name, (words, _) in _LIMITS.items()}
    for text in _outside(terms.limits, values, words):
        yield Breach(topic.name, text, terms.line)


def _outside(
    limits: Mapping[str, float], values: Mapping[str, float], words: Mapping[str, str]
) -> Iterator[str]:
    for name, value in values.items():
        least = limits.get(f"min_{name}", -math.inf)
        most = limits.get(f"max_{name}", math.inf)
        if not least <= value <= most:
            side, limit = ("at least", least) if value < least else ("at most", most)
            what = "without a message for " if name == "gap" else ""
            yield f"{what}{words[name].format(value)}, {side} {words[name].format(limit)} required"


def _terms(item: Item) -> TopicTerms:
    keys = {} if item.node.is_nothing else item.fields(_OF_TOPIC)
    kind, match, parts = (keys.pop(key, None) for key in ("type", "match", "fields"))
    if match and match.text() not in _MATCHES:
        raise match.error(f"'match' must be {' or '.join(_MATCHES)}, not '{match.text()}'")
    fields = parts.mapping() if parts else {}
    for name, part in fields.items():
        if not _FIELD_TERM.fullmatch(part.text()):
            hint = "write a number, a percentage such as 5%, angle or ignore"
            raise part.error(f"'{part.text()}' is no tolerance for {name}", hint)
    return TopicTerms(
        item.name,
        item.node.key_line,
        kind.text() if kind else "",
        {key: _number(one) for key, one in keys.items()},
        match.text() if match else "",
        {name: part.text() for name, part in fields.items()},
    )


def _number(item: Item) -> float:
    return item.number(-math.inf, math.inf)
