"""The cases of wtf as text: evidence that differs from a healthy system, and what is said of it.

A file of ``cases`` has blocks: a title after ``==``; the evidence, as ``wtf --save`` writes it, in
YAML and with shorthands; and after ``>`` the findings as text. A line that begins with ``+``
changes the evidence of its block, and what is found then follows; nothing, if nothing does. The
JSON of a finding is added (but for what the text has) if the file has none of its kind before.

``python -m tests.doctor.cases`` writes into the files what is found now: look at the difference.

Shorthands: ``nodes`` are by their ids and added to those of the healthy system (null removes one),
with endpoints such as ``sub /a: std_msgs/String``; ``before`` changes them for the start of the
look. ``alice`` and ``bob`` are senders, ``-5s`` is a time before now, ``98ms`` a duration, and
``50 Hz`` are the times of a stream; ``from -2s for 1s`` may follow.
"""

import json
import re
import sys
from copy import deepcopy
from pathlib import Path

import yaml

from lcmtools.doctor import report, saved
from lcmtools.doctor.rules import RULES, examine, in_doubt
from lcmtools.messages.registry import fingerprint, message_class, type_names

FILES = sorted((Path(__file__).parent / "cases").glob("*.txt"))
_SECOND = 1_000_000_000
_NOW = 1_000_000 * _SECOND
_SENDERS = {"alice": "10.0.0.1:4000", "bob": "10.0.0.2:5000"}
_ROLES = {"pub": "PUBLISHER", "sub": "SUBSCRIBER", "serve": "SERVICE", "call": "CLIENT"}
_UNITS = {"s": _SECOND, "ms": _SECOND // 1000}
_USUAL = {  # of the elements of lists
    "streams": {"sender": "alice", "name": "alice", "times": "50 Hz"},
    "senders": {"sender": "alice", "name": "alice"},
    "traffic": {"sender": "alice", "fingerprints": [], "messages": 5, "bytes": 50}
    | {"first_time": "-1s", "last_time": "-0s"},
    "listeners": {"pid": 7, "uid": 1000, "buffer_bytes": 212_992},
    "processes": {"pid": 9, "command": "driver"},
    "relays": {"relay": "/relay", "host": "here", "bus": "tcpq://office"},
    "remembered": {"sender": "alice", "name": "alice", "pid": 9, "rate": 50.0, "gap": 0.02}
    | {"last_time": "-1s"},
    "oddities": {"topic": "/a", "name": "/talker", "text": "it is odd"},
}
_HEALTHY = {
    "url": "udpm://239.255.76.67:7667?ttl=1",
    "ttl": 1,
    "listened": 1.0,
    "host": {"uid": 1000, "interface": "eth0", "speed_mbit": 1000, "joined": ["eth0"]},
    "nodes": {
        "/talker": {"pid": 7, "pub /a": "std_msgs/String"},
        "/ear": {"pid": 8, "sub /a": {"type": "std_msgs/String", "depth": 10}},
    },
}


def blocks(text):
    """The head of a file, and its blocks, each of which begins with ``==``."""
    return re.split(r"^(?=== )", text, flags=re.MULTILINE)


def render(text):
    """The text of a file with what is found now."""
    head, *cases = blocks(text)
    seen = set()
    return head + "".join(_rendered(block, seen) for block in cases)


def _rendered(block, seen):
    lines = [line for line in block.splitlines() if not line.startswith(">")]
    end = len(lines)
    while end and not lines[end - 1].strip():
        end -= 1
    first = next((n for n, line in enumerate(lines[:end]) if line[0] == "+"), end)
    document = yaml.safe_load("\n".join(lines[1:first])) or {}
    rows = [*lines[:first], *_found(document, seen)]
    for line in lines[first:end]:
        change = yaml.safe_load(f"{{{line[1:]}\n}}") if line[0] == "+" else {}
        rows += [line, *(_found(_merged(document, _split(change)), seen) if change else ())]
    return "\n".join([*rows, *lines[end:], ""])


def _found(document, seen):
    evidence = saved.from_text(json.dumps(expanded(document)))
    rows = []
    for finding in examine(evidence):
        rows += report.finding_text(finding)
        kinds = {(finding.rule, *kind) for kind in kinds_of(finding)}
        if not kinds <= seen:
            rows.append(json.dumps(_data(finding)))
        seen |= kinds
    if not any(row.startswith(("ERROR", "WARNING")) for row in rows) and in_doubt(evidence):
        rows.append("A longer look may show more.")
    rows += filter(None, report.not_checked(evidence, RULES))
    return [f"> {row}" for row in rows]


def kinds_of(finding):
    """The kinds of a finding's statements, with the table of their sentences."""
    yield "titles", finding.title.kind
    yield from (("facts", one.kind) for one in finding.facts)
    yield from (("remedies", one.kind) for one in finding.remedies)


def _data(finding):
    """A finding as JSON, without what its text says and without what is empty."""
    record = report.to_json(finding)
    title, items, remedies = report.describe(finding)
    assert record.pop("text") == title
    assert record.pop("items") == [item.strip(" *") for item in items]
    assert record.pop("remedies") == list(remedies)
    assert [one.pop("text") for one in record["actions"]] == list(remedies)
    return {key: value for key, value in record.items() if value}


def expanded(document):
    """The document of ``wtf --save`` of a case, which may be one already."""
    if "lcmtools_evidence" in document:
        return document
    case = _merged(_HEALTHY, _split(document))
    nodes, before = case.pop("nodes"), case.pop("before", {})
    traffic = case.pop("traffic", [])
    rows = [{**_USUAL["traffic"], **row} for row in traffic]
    for row in rows:
        row["fingerprints"] = [_fingerprint(one) for one in row["fingerprints"]]
    case["graph"] = _graph(nodes, rows, "-0s")
    case["before"] = _graph(_merged(nodes, before), rows, "-1s")
    for name, usual in _USUAL.items():
        if name in case:
            case[name] = [{**usual, **one} for one in case[name]]
    return {"lcmtools_evidence": 1, "evidence": _values(case)}


def _split(document):
    """Split keys such as ``host.ttl`` into nested ones."""
    result = {}
    for key, value in document.items():
        nested = value
        for name in reversed(str(key).split(".")):
            nested = {int(name) if name.isdigit() else name: nested}
        result = _merged(result, nested)
    return result


def _merged(base, change):
    """Merge a change into a value: mappings by key, lists by index; null removes a name."""
    if isinstance(base, list) and isinstance(change, dict):
        return [_merged(one, change[n]) if n in change else one for n, one in enumerate(base)]
    if not (isinstance(base, dict) and isinstance(change, dict)):
        return deepcopy(change)
    gone = {key for key in base if "/" in str(key) and change.get(key, "") is None}
    merged = {**base, **{key: _merged(base.get(key), part) for key, part in change.items()}}
    return {key: part for key, part in merged.items() if key not in gone}


def _graph(nodes, traffic, time):
    made = [_node(key, {"sent": time, **node}, n) for n, (key, node) in enumerate(nodes.items())]
    return {"nodes": made, "traffic": traffic, "time": time}


def _node(key, node, number):
    usual = {"name": key, "id": key, "host": "here", "pid": 10 + number, "start_time": "-100s"}
    node = usual | node
    ends = [name for name in node if name.partition(" ")[0] in _ROLES]
    node["endpoints"] = [_endpoint(name, node.pop(name)) for name in ends]
    return node


def _endpoint(name, end):
    role, _, topic = name.partition(" ")
    end = dict(end) if isinstance(end, dict) else {"type": end}
    types = [_full_name(one) for one in str(end.pop("type", None) or "").split()]
    prints = [_fingerprint(one) for one in types if one in type_names()]
    known = {"topic": topic.partition(" #")[0], "role": _ROLES[role], "types": types}
    made = known | {"fingerprints": prints} | end
    return made | {"fingerprints": [_fingerprint(one) for one in made["fingerprints"]]}


def _full_name(name):
    known = [one for one in type_names() if one.partition("/")[2] == name]
    return known[0] if len(known) == 1 else name


def _fingerprint(one):
    return one if isinstance(one, int) else fingerprint(message_class(_full_name(one)))


def _values(value, key=""):
    """Replace the names of senders, and times."""
    if isinstance(value, dict):
        return {name: _values(part, name) for name, part in value.items()}
    if key == "sender" and isinstance(value, str):
        address, _, port = _SENDERS.get(value, value).partition(":")
        return [address, int(port), ""]
    if key == "times" and isinstance(value, str):
        return _times(value)
    if isinstance(value, list):
        return [_values(part) for part in value]
    found = re.fullmatch(r"([-+]?)([\d.]+)(s|ms)", value) if isinstance(value, str) else None
    if not found:
        return value
    length = round(float(found[2]) * _UNITS[found[3]])
    return _NOW + (-length if found[1] == "-" else length) if found[1] else length


def _times(text):
    """The times of ``50 Hz from -1s for 1s``."""
    found = re.fullmatch(r"([\d.]+) Hz(?: from (\S+)s)?(?: for (\S+)s)?", text)
    rate, start, length = found.groups()
    length = float(length or 1)
    first = _NOW + round(float(start or -length) * _SECOND)
    step = round(_SECOND / float(rate))
    return [first + n * step for n in range(1, round(length * float(rate)) + 1)]


if __name__ == "__main__":
    for file in map(Path, sys.argv[1:] or FILES):
        file.write_text(render(file.read_text()))
