"""Findings, facts and remedies as text, by the sentences of their rules.

In a sentence, ``{name}`` is a part of the statement, and ``{name:and}`` a part that is formatted by
one of ``_SPECS``; backticks enclose a command that can be typed as it is, and are not shown. Pure.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from string import Formatter
from typing import Any, NamedTuple

from lcmtools.doctor.findings import Finding, Statement, Subject, Unchecked
from lcmtools.observe.measuring.counters import duration_text
from lcmtools.text_table import plural

_MOST = 8  # names in a row


class Description(NamedTuple):
    """A finding as text: a title, lines below it, and remedies."""

    title: str
    items: tuple[str, ...]
    remedies: tuple[str, ...]


def describe(finding: Finding) -> Description:
    """Format a finding."""
    return Description(
        _text(finding.title),
        tuple(line for fact in finding.facts for line in fact_lines(fact)),
        tuple(map(remedy_text, finding.remedies)),
    )


def remedy_text(remedy: Statement) -> str:
    """Format a remedy, with its reason."""
    return _fill(remedy.sentence.replace("`", ""), remedy.parts)


def commands(remedy: Statement) -> list[str]:
    """Return the commands in a remedy that can be typed as they are."""
    pids = remedy.parts.get("pids")
    if isinstance(pids, tuple):
        return [f"kill {pid}" for pid in pids]
    typed = (_fill(command, remedy.parts) for command in remedy.sentence.split("`")[1::2])
    return [command for command in typed if command]


def unchecked_text(unchecked: Unchecked) -> str:
    """Format the reason why a rule lacks evidence."""
    return _text(unchecked.reason)


def fact_lines(fact: Statement) -> Iterator[str]:
    """Format a fact as a line; after a colon, a line for each of its topics."""
    yield f" * {_fill(fact.sentence, {**fact.parts, 'type': _type(fact)})}"
    yield from (f"   * {topic}" for topic in _topics_below(fact))


def line_count(fact: Statement) -> int:
    """Return the number of a fact's lines."""
    return 1 + len(_topics_below(fact))


def _topics_below(fact: Statement) -> list[Subject]:
    """Return the topics that are listed below a node, as roswtf lists them."""
    is_head = fact.sentence.endswith(":")
    return [one for one in fact.subjects() if one.kind == "topic"] if is_head else []


def _type(fact: Statement) -> str:
    """Format the message type of a fact, as far as it is known."""
    if "types" in fact.parts:
        return _fill("{types:or}", fact.parts)
    if "format" in fact.parts:
        return str(fact.parts["format"])
    if "fingerprint" not in fact.parts:
        return "data that is not an LCM message"
    near = ": like {like}, but {difference}" if "like" in fact.parts else ""
    name = "{name}" if "name" in fact.parts else "an unknown type"
    return _fill(f"{name} ({{fingerprint}}{near})", fact.parts)


def _first(values: Sequence[object]) -> list[str]:
    """Format the first of many values, and the number of the others."""
    more = [f"{len(values) - _MOST + 1} more"] if len(values) > _MOST else []
    return [*map(_shown, values[: _MOST - len(more)]), *more]


def _shown(value: object) -> str:
    """Format a name; channels that are not topics of nodes are quoted."""
    is_plain = isinstance(value, Subject) and value.kind == "topic" and value.name[:1] != "/"
    return _quoted(value) if is_plain else str(value)


def _quoted(value: object) -> str:
    """Quote a name as Python does, with the hexadecimal value of a byte that is not UTF-8."""
    return re.sub(r"\\udc(?=[89a-f])", r"\\x", repr(str(value)))


def _advice(hint: str) -> tuple[str, str]:
    """Split a hint into the text before its command, and the command; "" if it has none."""
    if hint.startswith("export "):
        return "", hint
    text, sign, command = hint.partition("type: ")
    return text + sign, command


_SPECS: Mapping[str, Callable[[Any], str]] = {
    "advice": lambda hint: _advice(hint)[0],
    "and": lambda values: " and ".join(_first(values)),
    "at": lambda host: f"{host} at {host.address}" if host.address else str(host),
    "brackets": lambda text: f" ({text})" if text else "",
    "called": lambda s: str(s) if s.address in ("", str(s)) else f"{s} ({s.address})",
    "command": lambda hint: _advice(hint)[1],
    "count": lambda messages: f" ({messages} messages)" if messages > 1 else "",
    "holds": lambda size: f"holds {size} bytes" if size else "is too small",
    "kills": lambda pids: " " + " or ".join(f"(kill {pid})" for pid in pids) if pids else "",
    "list": lambda values: ", ".join(_first(values)),
    "messages": lambda count: plural(count, "message"),
    "namespaces": lambda names: ", ".join(f"__ns:={name}" for name in names),
    "not": lambda target: f", not {target:g}" if target != 1 else "",
    "run": lambda several: "runs" if len(several) == 1 else "run",
    "or": lambda values: " or ".join(map(str, values)),
    "call": lambda name: f"the callback of {name}" if str(name).startswith("/") else str(name),
    "repr": _quoted,
    "times": lambda count: f"{count} times" if count > 1 else "once",
    "use": lambda several: "uses" if len(several) == 1 else "use",
    "time": lambda seconds: duration_text(seconds * 1e9),
    "with": lambda topics: (
        f", with {' and '.join(_first(topics))}, which nodes here wait for" if topics else ""
    ),
    "wait": lambda topics: (
        f", and wait there for {' and '.join(_first(topics))}, which is published here"
        if topics
        else ""
    ),
    "work": lambda name: "the timers" if name == "timers" else f"the callback of {name}",
}
"""Formats of parts in addition to Python's."""


class _Sentence(Formatter):
    def format_field(self, value: object, format_spec: str) -> str:
        if isinstance(value, Subject) and not format_spec:
            return _shown(value)
        special = _SPECS.get(format_spec)
        return special(value) if special else str(super().format_field(value, format_spec))


def _text(statement: Statement) -> str:
    return _fill(statement.sentence, statement.parts)


def _fill(sentence: str, parts: Mapping[str, object]) -> str:
    return _Sentence().vformat(sentence, (), parts)
