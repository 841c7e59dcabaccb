"""Similar names, and the arguments that give a node's topic another name.

Pure: nodes in, remedies out.
"""

import re
from collections.abc import Iterable
from dataclasses import replace
from difflib import SequenceMatcher
from functools import lru_cache

from lcmtools.doctor.findings import Observed, Part, Statement, state
from lcmtools.graph.model import NodeInfo
from lcmtools.names import base_name_of, namespace_of

DROP_REMAP = {"drop-remap": "start {node} without {argument}"}
REMAPS = {
    **DROP_REMAP,
    "namespace": "start {node} with __ns:={namespace}",
    "remap": "start {node} with {old}:={new}",
    "remove-slash": "let {node} use '{name}' in place of '{topic}': the slash at its start keeps it"
    " out of the namespace {namespace}",
    "remove-slash-of-remap": "let {node} use '{name}' in place of '{topic}': the slash at its start"
    " keeps {argument} from being applied",
    "replace-remap": "start {node} with {old}:={new} in place of {argument}",
    "republish": "let it publish on '{topic}'",
}
"""The sentences of remedies that give a topic another name."""
_REASONS = {
    "no-subscriber": "{channel} of the same type has no subscriber",
    "offered": "{channel} is offered",
    "published": "{channel} is published",
    "publishes": "{publisher} publishes {channel}",
    "same-type": "{channel} is of the same type",
    "subscribes": "{listener} subscribes to {channel}",
}
_MOST_NAMES = 300  # that are compared
_MOST_LETTERS = 4  # that only one of two names has
_SHORT = 4  # characters: shorter names look alike by chance
_LONG = 8  # characters: in a shorter name, an error is a larger part
_ALIKE, _ALIKE_SHORT, _ALIKE_CONSONANTS = 0.84, 0.8, 0.9  # ratios of equal characters


def are_near(one: str, other: str) -> bool:
    """Return whether one name may be a misspelling of the other.

    Names are near if they differ only in case, slashes and spaces, in few characters of namespace
    and base name, or in abbreviated words (velocity_command, velocity_cmd). Names that differ only
    in numbers mean different things (/husky0, /husky1).
    """
    first, second = _pattern(one), _pattern(other)
    # most pairs differ in many letters, which is quickly seen
    if first == second or (_letters(first) ^ _letters(second)).bit_count() > _MOST_LETTERS:
        return False
    return _are_near_patterns(*sorted((first, second)))


def resembles(topic: str, other: str) -> bool:
    """Return whether one topic may be meant by the other: of the same or a similar base name."""
    bases = base_name_of(topic), base_name_of(other)
    return bases[0] == bases[1] or are_near(topic, other) or are_near(*bases)


def near_names(name: str, names: Iterable[str]) -> list[str]:
    """Return the names that are near to a name, those of the same numbers first."""
    numbers = re.findall(r"\d+", name)
    near = (other for other in names if are_near(name, other))
    return sorted(near, key=lambda other: re.findall(r"\d+", other) != numbers)


def comparable(names: Iterable[str]) -> list[str]:
    """Return the first names, of as many kinds as can be compared; their numbers do not count."""
    kinds: dict[str, list[str]] = {}
    for name in names:
        if (pattern := _pattern(name)) in kinds or len(kinds) < _MOST_NAMES:
            kinds.setdefault(pattern, []).append(name)
    return [name for alike in kinds.values() for name in alike]


@lru_cache(100_000)
def _pattern(name: str) -> str:
    return re.sub(r"\d+", "0", name)


@lru_cache(100_000)
def _letters(pattern: str) -> int:
    """Return the set of a pattern's letters as bits."""
    return sum(1 << number for number in {ord(one) % 64 for one in _folded(pattern)})


@lru_cache(100_000)
def _are_near_patterns(one: str, other: str) -> bool:
    one, other = one.replace("0", ""), other.replace("0", "")
    first, second = _folded(one), _folded(other)
    if first == second:
        return True
    if min(len(first), len(second)) <= _SHORT:
        return False
    bases = base_name_of(one), base_name_of(other)
    is_alike = _are_alike(*map(_folded, bases)) or _are_abbreviated(*bases)
    return is_alike and _are_alike(*(_folded(namespace_of(name)) for name in (one, other)))


def _folded(name: str) -> str:
    return re.sub(r"[\s/_]", "", name).casefold()


def _are_alike(one: str, other: str) -> bool:
    least = _ALIKE if max(len(one), len(other)) >= _LONG else _ALIKE_SHORT
    return one == other or _ratio(one, other) >= least


def _are_abbreviated(one: str, other: str) -> bool:
    """Return whether words of the same initials have nearly the same consonants."""
    words = [name.casefold().split("_") for name in (one, other)]
    initials = [[word[:1] for word in name] for name in words]
    consonants = ("".join(re.sub(r"[aeiou]|(.)(?=\1)", "", x) for x in name) for name in words)
    is_long = min(len(one), len(other)) >= _LONG
    return is_long and initials[0] == initials[1] and _ratio(*consonants) >= _ALIKE_CONSONANTS


def _ratio(one: str, other: str) -> float:
    if min(len(one), len(other)) * 2 < _ALIKE_SHORT * len(one + other):
        return 0.0
    return SequenceMatcher(None, one, other, autojunk=False).ratio()


def is_legal(channel: str) -> bool:
    """Return whether a channel is a valid topic of a node: one slash before each part."""
    return re.fullmatch(r"(/[A-Za-z0-9_]+)+", channel) is not None


def is_plain(channel: str) -> bool:
    """Return whether a channel has a usual name of plain LCM, without a slash at its start."""
    return re.fullmatch(r"[^\s/]+(/[^\s/]+)*", channel) is not None


def give_reason(remedy: Statement, reason: str, **parts: Part | Observed) -> Statement:
    """Add the reason to a remedy, and the alternative in the part ``or_publish_on``, if any."""
    known = state("", because=reason, **parts).parts
    sentence = _REASONS[reason]
    if reason == "published" and remedy.kind == "republish":
        sentence = sentence.replace("{channel}", "'{channel!s}'")  # its spaces may be the mistake
    sentence += ", by {by}: " if "by" in parts else ": "
    if "or_publish_on" in parts:
        sentence += "let it publish on '{or_publish_on}', or "
    return replace(remedy, parts={**known, **remedy.parts}, sentence=f"{sentence}{remedy.sentence}")


def start_with(node: NodeInfo, topic: str, target: str) -> Statement:
    """Return the remedy that starts a node with another topic instead of ``topic``."""
    argument, space = remap_argument(node, topic), namespace_of(node.name)
    source, wanted = argument.partition(":=")[0], expanded(target, node)
    name = base_name_of(topic) if space == namespace_of(topic) else topic
    if not argument and topic != wanted == inside(node, topic):
        return state("remove-slash", node=node, topic=topic, name=topic[1:], namespace=space)
    if not argument:
        return state("remap", node=node, old=name, new=target)
    if expanded(source, node) != wanted:
        return state("replace-remap", node=node, old=source, new=target, argument=argument)
    if are_near(topic, wanted) or wanted == inside(node, topic):
        return state("drop-remap", node=node, argument=argument)
    # source and target of the remap were exchanged
    return state("replace-remap", node=node, old=name, new=target, argument=argument)


def publish_on(publisher: NodeInfo, topic: str, target: str) -> Statement:
    """Return the remedy that lets a node publish on another topic."""
    if publisher.tool:  # a command: its topic is an argument, which no remap changes
        return state("republish", topic=expanded(target, publisher))
    is_own = namespace_of(publisher.name) == namespace_of(topic)
    if is_own and base_name_of(topic) == base_name_of(target):
        return state("namespace", node=publisher, namespace=namespace_of(target))
    return start_with(publisher, topic, target)


def remove_slash(node: NodeInfo, topic: str) -> Statement:
    """Return the remedy for a slash that keeps a remap from being applied to a topic."""
    argument, _ = unapplied_remap(node, topic)
    parts = {"topic": topic, "name": topic[1:], "argument": argument}
    return state("remove-slash-of-remap", node=node, **parts)


def remap_argument(node: NodeInfo, topic: str) -> str:
    """Return the remap in a node's command line that results in a topic; "" if there is none."""
    for word, source, target in _remaps(node):
        if not source.startswith("_") and expanded(target, node) == topic:
            return word
    return ""


def unapplied_remap(node: NodeInfo, topic: str) -> tuple[str, str]:
    """Return the remap that a slash at a topic's start keeps from being applied, and its target.

    Both are "" if there is none.
    """
    for word, source, target in _remaps(node):
        if topic == f"/{source}" != expanded(source, node):
            return word, expanded(target, node)
    return "", ""


def _remaps(node: NodeInfo) -> list[tuple[str, str, str]]:
    """Return the arguments OLD:=NEW of a node, with both names."""
    words = node.command.split() if ":=" in node.command else []
    parts = ((word, *word.split(":=", 1)) for word in words if ":=" in word)
    return [(word, source, target) for word, source, target in parts if target]


def expanded(name: str, node: NodeInfo) -> str:
    """Return the topic that a name means in a node's namespace."""
    return name if name.startswith("/") else f"{namespace_of(node.name).rstrip('/')}/{name}"


def inside(node: NodeInfo, topic: str) -> str:
    """Return a topic as it is in a node's namespace without its first slash; "" if it has none."""
    return expanded(topic.lstrip("/"), node) if topic.startswith("/") else ""
