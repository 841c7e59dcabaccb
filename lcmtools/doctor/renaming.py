"""Similar names, and the arguments that give a node's topic another name.

Pure: nodes in, remedies out.
"""

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import zip_longest

from lcmtools.doctor.findings import Observed, Part, Statement, state
from lcmtools.graph.model import Node
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
PLAIN_CHANNEL = {
    "plain-channel": "in {node}, subscribe to {channel} with plain_channel=True,"
    " in C++ to plain_channel({channel})",
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
_SHORT, _LONG = 4, 8  # characters: shorter names look alike by chance, longer ones have more errors
_MOST_EDITS = 2  # of a long name
_MOST_COMPARISONS = 5_000_000  # of two names' letters, which take half a second
_ABBREVIATED = 4  # consonants of a word that may be abbreviated, as command by cmd


def are_near(one: str, other: str) -> bool:
    """Return whether one name may be a misspelling of the other.

    Names are near if they differ only in case, slashes and spaces, in one typing error (two in long
    names), or in abbreviated words (velocity_command, velocity_cmd). Names that differ only in
    numbers mean different things (/husky0, /husky1).
    """
    if _without_numbers(one) == _without_numbers(other):
        return False
    first, second = _folded(one), _folded(other)
    if first == second:
        return True
    if min(len(first), len(second)) <= _SHORT:
        return False
    bases = base_name_of(one), base_name_of(other)
    is_long = min(len(_folded(base)) for base in bases) >= _LONG
    if _has_distance_within(first, second, _MOST_EDITS if is_long else 1):
        return True
    return is_long and namespace_of(one) == namespace_of(other) and _are_abbreviations(*bases)


class NearNames:
    """An index of names for similar ones. Names that differ only in numbers are compared once.

    Among thousands of names that nothing connects, no slip of typing is searched for the last ones.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._alike: dict[str, list[str]] = {}
        self._near: dict[str, tuple[str, ...]] = {}  # a cache by name
        for name in names:
            self._alike.setdefault(_without_numbers(name), []).append(name)
        self._order = {pattern: number for number, pattern in enumerate(self._alike)}
        self._letters = [(*_letters(pattern), pattern) for pattern in self._alike]
        self._by_initials: dict[object, list[str]] = {}
        for pattern in self._alike:
            self._by_initials.setdefault(_initials(pattern), []).append(pattern)
        self._left = _MOST_COMPARISONS

    def of(self, name: str) -> tuple[str, ...]:
        """Return the names that are near to a name."""
        if name not in self._near:
            pattern = _without_numbers(name)
            likely = self._likely(pattern)
            near = (self._alike[one] for one in likely if _are_near_patterns(pattern, one))
            self._near[name] = tuple(one for names in near for one in names if are_near(one, name))
        return self._near[name]

    def _likely(self, pattern: str) -> list[str]:
        """Return the patterns that may be near: of nearly the same letters, or of its initials."""
        count, letters = _letters(pattern)
        self._left -= len(self._letters)
        known = self._letters if self._left >= 0 else ()
        likely = {
            other
            for others, mask, other in known
            if -_MOST_EDITS <= others - count <= _MOST_EDITS
            if (mask ^ letters).bit_count() <= 2 * _MOST_EDITS
        }
        likely.update(self._by_initials.get(_initials(pattern), ()))
        return sorted(likely, key=self._order.__getitem__)


def _letters(pattern: str) -> tuple[int, int]:
    """Return the number of a pattern's letters, and the set of them as bits."""
    letters = _folded(pattern.replace("0", ""))
    return len(letters), sum(1 << number for number in {ord(one) % 64 for one in letters})


def _initials(pattern: str) -> tuple[str, ...]:
    """Return the namespace and the words' initials of a name in which words may be abbreviated.

    A single word is never: short names are not near, and long words need nearly the same letters.
    """
    words = base_name_of(pattern).replace("0", "").casefold().split("_")
    space = namespace_of(pattern).replace("0", "")
    return (space, *(word[:1] for word in words)) if words[1:] else (pattern,)


@lru_cache(100_000)
def _are_near_patterns(one: str, other: str) -> bool:
    return are_near(one.replace("0", ""), other.replace("0", ""))


@lru_cache(100_000)
def _without_numbers(name: str) -> str:
    return re.sub(r"[0-9]+", "0", name)


@lru_cache(100_000)
def _folded(name: str) -> str:
    return re.sub(r"[\s/_]", "", name).casefold()


def _has_distance_within(one: str, other: str, edits: int) -> bool:
    """Return whether the edit distance (with transpositions) of two words is at most ``edits``."""
    if abs(len(one) - len(other)) > edits or len(set(one) ^ set(other)) > 2 * edits:
        return False
    differing = (n for n, (a, b) in enumerate(zip(one, other, strict=False)) if a != b)
    start = next(differing, min(len(one), len(other)))
    one, other = one[start:], other[start:]
    if not edits or one == other:
        return one == other
    swapped = one[1::-1] == other[:2] and _has_distance_within(one[2:], other[2:], edits - 1)
    pairs = (one[1:], other), (one, other[1:]), (one[1:], other[1:])
    return swapped or any(_has_distance_within(first, second, edits - 1) for first, second in pairs)


def _are_abbreviations(one: str, other: str) -> bool:
    """Return whether each word of one name may abbreviate the same word of the other."""
    pairs = zip_longest(*(name.casefold().split("_") for name in (one, other)), fillvalue="")
    return all(a[:1] == b[:1] and _are_near_words(a, b) for a, b in pairs)


def _are_near_words(one: str, other: str) -> bool:
    if min(len(one), len(other)) > _SHORT:
        return _has_distance_within(one, other, 1)
    first, second = (re.sub(r"[aeiou]|(.)(?=\1)", "", word) for word in (one, other))
    return one == other or (
        max(len(first), len(second)) >= _ABBREVIATED and _has_distance_within(first, second, 1)
    )


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


def start_with(node: Node, topic: str, target: str) -> Statement:
    """Return the remedy that starts a node with another topic instead of ``topic``."""
    argument, space = remap_argument(node, topic), namespace_of(node.name)
    source, wanted = argument.partition(":=")[0], expanded(target, node)
    name = base_name_of(topic) if space == namespace_of(topic) else topic
    if not argument and topic != wanted == expanded(topic.lstrip("/"), node):
        return state("remove-slash", node=node, topic=topic, name=topic[1:], namespace=space)
    if not argument:
        return state("remap", node=node, old=name, new=target)
    if expanded(source, node) != wanted:
        return state("replace-remap", node=node, old=source, new=target, argument=argument)
    if are_near(topic, wanted) or wanted == expanded(topic.lstrip("/"), node):
        return state("drop-remap", node=node, argument=argument)
    # source and target of the remap were exchanged
    return state("replace-remap", node=node, old=name, new=target, argument=argument)


def publish_on(publisher: Node, topic: str, target: str) -> Statement:
    """Return the remedy that lets a node publish on another topic."""
    if publisher.tool:  # a command: its topic is an argument, which no remap changes
        return state("republish", topic=expanded(target, publisher))
    space = namespace_of(target)
    is_own = namespace_of(publisher.name) == namespace_of(topic)
    if is_own and base_name_of(topic) == base_name_of(target):
        return state("namespace", node=publisher, namespace=space)
    return start_with(publisher, topic, target)


def remap_argument(node: Node, topic: str) -> str:
    """Return the remap in a node's command line that results in a topic; "" if there is none."""
    for word in node.command.split():
        source, sign, target = word.partition(":=")
        if sign and target and not source.startswith("_") and expanded(target, node) == topic:
            return word
    return ""


def unapplied_remap(node: Node, topic: str) -> tuple[str, str]:
    """Return the remap that a slash at a topic's start keeps from being applied, and its target.

    Both are "" if there is none.
    """
    for word in node.command.split() if ":=" in node.command else ():
        source, sign, target = word.partition(":=")
        if sign and target and topic == f"/{source}" != expanded(source, node):
            return word, expanded(target, node)
    return "", ""


def expanded(name: str, node: Node) -> str:
    """Return the topic that a name means in a node's namespace."""
    return name if name.startswith("/") else f"{namespace_of(node.name).rstrip('/')}/{name}"
