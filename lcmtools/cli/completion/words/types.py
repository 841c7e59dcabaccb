"""Message types, service types and packages, in the spelling that the word begins."""

import re
from collections.abc import Iterator, Sequence

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.messages.registry import service_names, type_names

_SPELLING = re.compile(r"\w+([/.])((?:msg|srv)[/.])?", re.ASCII)


def types(situation: Situation) -> Iterator[Candidate]:
    """The message types; behind a topic that is on the bus, its type before all others.

    Where nothing is typed yet, that one alone: it can be taken with a single key.
    """
    known = list(_of_topic(situation))
    yield from (Candidate(one) for name in known for one in _spelled(name, situation.word))
    if situation.word or not known:
        yield from _by_package(type_names(), situation.word)


def service_types(situation: Situation) -> Iterator[Candidate]:
    """The service types."""
    yield from _by_package(service_names(), situation.word)


def packages(situation: Situation) -> Iterator[Candidate]:
    """The packages that have message types."""
    del situation
    yield from (Candidate(name) for name in sorted({_package(name) for name in type_names()}))


def _of_topic(situation: Situation) -> Sequence[str]:
    from lcmtools.cli.completion.words.topics import TOPIC, topic_meant, types_of

    topic = situation.first(*TOPIC)
    name = topic_meant(situation, topic) if topic else None
    return types_of(situation.graph, name) if name else ()


def _by_package(names: Sequence[str], word: str) -> Iterator[Candidate]:
    """The packages that the word may begin; the types where it is one, or names one's type."""
    packages = {_package(name) for name in names}
    begun = [name for name in sorted(packages) if name.startswith(word)]
    if len(begun) > 1 and word not in packages:
        yield from (Candidate(f"{name}/", is_open=True) for name in begun)
        yield from (Candidate(short) for short in _unique(names) if word)
        return
    for name in names:
        yield from (Candidate(one) for one in _spelled(name, word))
    if word:
        yield from (Candidate(short) for short in _unique(names))


def _spelled(name: str, word: str) -> Iterator[str]:
    """A type's name as the word begins to spell it."""
    package, _, short = name.rpartition("/")
    match = _SPELLING.match(word)
    yield f"{package}{match[1]}{match[2] or ''}{short}" if match else name


def _unique(names: Sequence[str]) -> list[str]:
    """Names of types that do without their package, because only one has them."""
    shorts = [name.rpartition("/")[2] for name in names]
    return [short for short in shorts if shorts.count(short) == 1]


def _package(name: str) -> str:
    return name.partition("/")[0]
