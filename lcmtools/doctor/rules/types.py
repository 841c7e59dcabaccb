"""Rules about message types."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations, zip_longest

from lcmtools.doctor.evidence import Evidence, sender_names
from lcmtools.doctor.findings import (
    Finding,
    Part,
    Severity,
    Statement,
    Subject,
    finding,
    rule,
    state,
    subject,
)
from lcmtools.doctor.rules.shared import simulator_ids
from lcmtools.graph.model import Endpoint, NodeInfo, Topic, Traffic
from lcmtools.messages.registry import (
    candidates,
    is_own,
    message_class,
    problems,
    type_files,
    type_name,
    type_names,
    versioned,
)
from lcmtools.messages.type_versions import (
    added_and_missing,
    may_be_fingerprint,
    other_version,
    own_types_like,
)
from lcmtools.names import is_hidden, is_of_lcm
from lcmtools.observe.reading.decoding import possible_types
from lcmtools.observe.reading.senders import UNKNOWN
from lcmtools.wire.packet import Sender

_BITS = (1 << 64) - 1
_NO_TYPE = -1  # instead of a fingerprint, if there is none or it changes with each message
_SAME_LCM_FILES = {
    "same-lcm-files": "generate the code of both sides from the same .lcm files: lcm-gen",
}
_TYPE_PATH = {
    "type-path": "name the folder of their .lcm files: export LCMTOOLS_TYPE_PATH=FOLDER",
}
_OLDER, _NEWER = "without the field", "with "  # beginnings of a difference from the known version


@dataclass(frozen=True, slots=True)
class _User:
    """A node or program that publishes or subscribes to a topic, with the types that it uses."""

    kind: str  # "publishes", "expects" or "sends"
    subject: Subject
    fingerprints: frozenset[int]
    type: Mapping[str, Part]  # the parts of a statement that describe it
    weight: float = 1.0  # in the vote for the intended type

    def fact(self) -> Statement:
        """Return the fact that it uses the type."""
        part = "sender" if self.kind == "sends" else "node"
        return state(self.kind, **{part: self.subject}, **self.type)

    def remedy(self, topic: str, types: Sequence[str]) -> Statement:
        """Return the remedy that it uses another type."""
        return state(f"{self.kind}-as", program=self.subject, topic=topic, types=types)


@rule(
    "type-mismatch",
    remedy="use the same type, from the same .lcm file, on both sides",
    severity=Severity.ERROR,
    title={
        "type-mismatch": "The types on {topic} do not match:",
        "type-names-differ": "The types on {topic} have the same fields, but different names:",
    },
    facts={
        "appended": "{newer} is {older} with {fields:and} added at the end",
        "differ-in": "{newer} and {older} differ in {fields:and}",
        "expects": "{node} expects {type}",
        "has-more": "{newer} has {fields:and} in addition to the fields of {older}",
        "odd-type": "the odd one is {senders:and}: {programs:and} {programs:use} {types:or}",
        "older-type": "the older version is probably that of {senders:and}",
        "publishes": "{node} publishes {type}",
        "sends": "{sender} sends {type}",
    },
    remedies={
        **_SAME_LCM_FILES,
        "expects-as": "let {program} subscribe to {topic} as {types:or}",
        "publishes-as": "let {program} publish {topic} as {types:or}",
        "remap-one": "remap one of them to another topic, for example {topic}:={topic}_2",
        "rename-one": "let one of them use another channel",
        "same-type": "it works; declare the same type on both sides, so that all commands show the"
        " same",
        "sends-as": "let {program} send {types:or} on {topic}",
        **_TYPE_PATH,
    },
    evidence="announced types, fingerprints in messages, the known types",
)
def topics_have_one_type(evidence: Evidence) -> Iterator[Finding]:
    """All publishers and subscribers of a topic use the same type.

    A subscriber cannot read messages of another type, and drops them. Types of equal fields are the
    same on the wire: those are a note.
    """
    for topic in evidence.graph.topics():
        if is_of_lcm(topic.name):
            continue
        if disagree(topic):
            users = list(_users(topic, evidence))
            title, facts = state("type-mismatch", topic=topic.name), [one.fact() for one in users]
            more, remedies = _diagnosis(topic, users)
            yield from finding(title, [*facts, *more], *remedies)
        elif not is_hidden(topic.name) and _differ_in_name(topic):
            title = state("type-names-differ", topic=topic.name)
            facts = [user.fact() for user in _users(topic, evidence)]
            yield from finding(title, facts, "same-type", severity=Severity.NOTE)


@rule(
    "unknown-type",
    remedy="generate the sender's types again from the same .lcm files",
    severity=Severity.WARNING,
    title={
        "no-lcm-messages": "The following are not LCM messages:",
        "types-without-file": "The types of the following are not known here:",
        "unknown-type": "The types of the following are similar to known ones:",
    },
    facts={"unknown-type": "{topic} from {senders:and}: {type}"},
    remedies={
        **_SAME_LCM_FILES,
        "encode-by-lcm": "if that is not intended, describe them in a .lcm file, and encode them"
        " with the code that lcm-gen generates",
        "correct-file": "correct the file that cannot be read: {problem}",
        **_TYPE_PATH,
    },
    unless={"type-mismatch": "topic"},
    evidence="fingerprints and beginnings of messages, the known types",
)
def types_are_known(evidence: Evidence) -> Iterator[Finding]:
    """The types of all messages are known, and everything sent is an LCM message.

    An unknown type is often an older or newer version of a known one: its fingerprint shows which
    field differs. Other types become known by their .lcm files, in a workspace or in
    LCMTOOLS_TYPE_PATH. Of data that are not LCM messages, such as JSON, lcmtools shows only the
    bytes.
    """
    near: list[Statement] = []
    unknown: list[Statement] = []
    foreign: list[Statement] = []
    numbers = {number for seen in evidence.graph.traffic for number in seen.fingerprints}
    known = {number for number in numbers if candidates(number)}
    own_types = type_files() if numbers - known else {}  # seldom needed, and slow
    formats = {(one.channel, one.sender): one.format for one in evidence.streams}
    for topic in evidence.graph.topics():
        if is_hidden(topic.name):
            continue
        unknown_ones: dict[tuple[int, str], list[Subject]] = defaultdict(list)
        for seen in topic.traffic:
            likely = formats.get((topic.name, seen.sender), "")
            is_hash = any(map(may_be_fingerprint, seen.fingerprints))
            if (is_hash or likely) and known.isdisjoint(seen.fingerprints):
                sender = _sender(seen, sender_names(evidence))
                number = seen.fingerprints[0] if len(seen.fingerprints) == 1 else _NO_TYPE
                unknown_ones[number, likely].append(sender)
        for (number, likely), senders in unknown_ones.items():
            parts = {"format": likely} if likely else _unknown_type(number, topic, own=own_types)
            parts = _name(number, topic) or parts
            fact = state("unknown-type", topic=topic.name, senders=senders, **parts)
            kept = near if "like" in parts else unknown if "fingerprint" in parts else foreign
            kept.append(fact)
    note = Severity.NOTE
    own = any(is_own(str(fact.parts["like"])) for fact in near)  # a shipped type is like many
    severity = Severity.WARNING if own else note
    yield from finding("unknown-type", near, "same-lcm-files", severity=severity)
    files = problems()[:1] if unknown else ()  # it may define the unknown type
    broken = (state("correct-file", problem=str(problem.error())) for problem in files)
    yield from finding("types-without-file", unknown, *broken, "type-path", severity=note)
    yield from finding("no-lcm-messages", foreign, "encode-by-lcm", severity=note)


def disagree(topic: Topic) -> bool:
    """Return whether publishers and subscribers of a topic use different types."""
    if not (topic.publishers or topic.subscribers) and len(topic.traffic) <= 1:
        return False  # as of most channels of a large log
    sent = [set(endpoint.fingerprints) for _, endpoint in topic.publishers if endpoint.fingerprints]
    sent += [{fingerprint} for seen in topic.traffic for fingerprint in _sent_by(seen)]
    taken = [set(e.fingerprints) for _, e in topic.subscribers if e.fingerprints]
    return any(not one & other for one in sent for other in taken) or (
        # without a subscriber that takes both, two publishers of different types conflict
        not taken and len({frozenset(one) for one in sent}) > 1
    )


def _users(topic: Topic, evidence: Evidence) -> Iterator[_User]:
    """Yield the users of a topic; a node once for each type."""
    untyped = _senders_without_type(topic)
    sent_by = {seen.sender for seen in topic.traffic}
    publishers = [(x, e) for x, e in topic.publishers if not (x.senders() & sent_by & untyped)]
    for kind, ends in (("publishes", publishers), ("expects", topic.subscribers)):
        distinct = {(node.id, end.types, end.fingerprints): (node, end) for node, end in ends}
        for node, end in distinct.values():
            if kind == "publishes" or end.fingerprints:
                numbers = frozenset(end.fingerprints)
                yield _User(kind, subject(node), numbers, _announced(end), _weight(node, evidence))
    unannounced = [x for x in topic.traffic if x in topic.foreign or x.sender in untyped]
    for seen in unannounced:
        for number in _sent_by(seen):
            sender = _sender(seen, sender_names(evidence))
            yield _User("sends", sender, frozenset({number}), _type(number, topic))


def _senders_without_type(topic: Topic) -> set[Sender]:
    """Return the senders of publishers that announce no fingerprint: only their messages tell."""
    ends = (node for node, end in topic.publishers if not end.fingerprints)
    return {sender for node in ends for sender in node.senders()}


def _weight(node: NodeInfo, evidence: Evidence) -> float:
    """Return a node's weight: a simulator's types are fixed, those of a command just typed."""
    return 0.5 if node.tool else 1.5 if node.id in simulator_ids(evidence) else 1.0


def _diagnosis(
    topic: Topic, users: Sequence[_User]
) -> tuple[list[Statement], list[Statement | str]]:
    """Return facts about the wrong side, if that is known, and the remedies."""
    if facts := [*_versions(topic, users), *_older(users)]:
        return facts, ["same-lcm-files"]
    if any("difference" in user.type for user in users):
        return [], ["same-lcm-files"]
    unknown = [u for u in users if "fingerprint" in u.type]
    weights: dict[int, float] = defaultdict(float)
    for user in users:
        for number in user.fingerprints:
            weights[number] += user.weight
    usual = max(weights, key=lambda number: weights[number], default=_NO_TYPE)
    is_usual = 2 * weights[usual] > sum(user.weight for user in users)
    odd = [user for user in users if is_usual and usual not in user.fingerprints]
    not_usual = {user.subject for user in odd}  # also beside itself, with several types
    others = [user for user in users if user.subject not in not_usual]
    types = tuple(_possible(usual, topic)[:1])
    remedies: list[Statement | str] = ["same-lcm-files", "type-path"] if unknown else []
    if odd and types and others:
        known = {"senders": [u.subject for u in odd], "programs": [u.subject for u in others]}
        facts.append(state("odd-type", types=types, **known))
        remedies += [user.remedy(topic.name, types) for user in odd]
    # a channel that is not a topic of nodes, such as POSE, is named in the code
    takes_remaps = topic.name[:1] == "/" and any(user.kind != "sends" for user in users)
    kind = "remap-one" if takes_remaps else "rename-one"
    return facts, [*remedies, state(kind, topic=topic.name)]


def _versions(topic: Topic, users: Sequence[_User]) -> Iterator[Statement]:
    """Yield facts about users' types that are versions of one, if they differ only in fields."""
    numbers = dict.fromkeys(number for user in users for number in sorted(user.fingerprints))
    names = {number: known[0] for number in numbers if (known := _possible(number, topic))}
    for one, other in permutations(names, 2):
        newer, older = message_class(names[one], one), message_class(names[other], other)
        added, missing = added_and_missing(newer, older)
        parts = {"newer": names[one], "older": names[other]}
        is_one = type_name(newer) == type_name(older)
        is_more = bool(added) and not missing
        if is_more and (is_one or len(older.__slots__) >= max(2, len(added))):
            is_end = [*newer.__slots__[-len(added) :]] == added
            yield state("appended" if is_end else "has-more", **parts, fields=added)
            senders = [user.subject for user in users if other in user.fingerprints]
            yield state("older-type", senders=senders)
        elif is_one and added and missing and names[one] < names[other]:
            yield state("differ-in", **parts, fields=list(dict.fromkeys([*added, *missing])))


def _older(users: Sequence[_User]) -> Iterator[Statement]:
    """Yield a fact with the users of the older version, if the difference shows it."""

    def has(user: _User, words: str) -> bool:
        return words in str(user.type.get("difference", ""))

    older = [user.subject for user in users if has(user, _OLDER)]
    if not older and any(str(user.type.get("difference", "")).startswith(_NEWER) for user in users):
        older = [user.subject for user in users if "difference" not in user.type]
    if older:
        yield state("older-type", senders=older)


def _sender(seen: Traffic, names: Mapping[Sender | None, str]) -> Subject:
    name = names.get(seen.sender, str(seen.sender or UNKNOWN))
    return Subject("sender", name, address=str(seen.sender or ""))


def _differ_in_name(topic: Topic) -> bool:
    """Return whether a subscriber uses other names for the published types."""
    taken = [set(endpoint.types) for _, endpoint in topic.subscribers if endpoint.fingerprints]
    sent = {endpoint.type for _, endpoint in topic.publishers if endpoint.fingerprints}
    return any(not sent & types for types in taken) if sent else False


def _sent_by(traffic: Traffic) -> list[int]:
    """Return a sender's types: all known ones, else its only unknown one, else ``_NO_TYPE``."""
    known = [fingerprint for fingerprint in traffic.fingerprints if candidates(fingerprint)]
    return known or (list(traffic.fingerprints) if len(traffic.fingerprints) == 1 else [_NO_TYPE])


def _announced(end: Endpoint) -> dict[str, Part]:
    """Return the parts of a statement that describe an announced type."""
    first = end.fingerprints[0] if end.fingerprints else _NO_TYPE
    if not end.types:  # seen in the messages of a node whose announcement is not readable
        return _type(first, Topic(end.topic))
    if not end.fingerprints:
        return {"types": end.types}
    if len(end.types) != 1 or end.type in candidates(first):
        types = zip_longest(end.types, end.fingerprints[: len(end.types)], fillvalue=_NO_TYPE)
        return {"types": tuple(versioned(str(name), int(number)) for name, number in types)}
    if end.type in type_names():  # another version of a known type
        return {"name": end.type, **_type(first, Topic(end.topic), (end.type,))}
    return {"name": end.type, "fingerprint": f"{first:#018x}"}


def _name(fingerprint: int, topic: Topic) -> dict[str, Part]:
    """Return the parts that describe the announced type of a fingerprint."""
    ends = (end for _, end in topic.publishers + topic.subscribers)
    return next((_announced(end) for end in ends if fingerprint in end.fingerprints), {})


def _possible(fingerprint: int, topic: Topic) -> list[str]:
    return possible_types(fingerprint, topic.name, topic.types)


def _expected(topic: Topic, unknown: int, own: Iterable[str] | None) -> Iterator[str]:
    """Yield the types of a topic: announced, possibly sent, and the user's own named so."""
    yield from (name for name in topic.types if name in type_names())
    for number in topic.fingerprints:
        yield from _possible(number, topic) if number != unknown else ()
    yield from own_types_like(topic.name, own)


def _type(fingerprint: int, topic: Topic, expected: Sequence[str] = ()) -> dict[str, Part]:
    """Return the parts of a statement that describe the type of messages on a topic."""
    if fingerprint == _NO_TYPE:
        return {}
    if known := _possible(fingerprint, topic):
        return {"types": tuple(known)}
    return _unknown_type(fingerprint, topic, expected)


def _unknown_type(
    fingerprint: int,
    topic: Topic,
    expected: Sequence[str] = (),
    own: Iterable[str] | None = None,
) -> dict[str, Part]:
    """Return the parts of a statement that describe a type that no known one is."""
    if fingerprint == _NO_TYPE or not may_be_fingerprint(fingerprint):
        return {}
    near = other_version(fingerprint, [*expected, *_expected(topic, fingerprint, own)])
    hexadecimal: dict[str, Part] = {"fingerprint": f"{fingerprint:#018x}"}
    return hexadecimal | ({"like": near.name, "difference": near.difference} if near else {})
