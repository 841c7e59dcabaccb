"""Completers for messages: types, packages, field paths, and prototypes to fill in."""

import contextlib
import re
from collections.abc import Iterable, Iterator, Sequence

from lcmtools.cli.completion.bus import TOPIC, service_type, topic_meant, topics, types_of
from lcmtools.cli.completion.situation import Candidate, Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.registry import (
    Message,
    message_class,
    service_class,
    service_name,
    service_names,
    type_names,
)

_SPELLING = re.compile(r"\w+([/.])((?:msg|srv)[/.])?", re.ASCII)
_LAST = re.compile(r"(.*?)([./]?)([^./\[\]]*)", re.DOTALL)
_INDICES = ("[0]", "[-1]", "[0:5]", "[::10]")


def types(situation: Situation) -> Iterator[Candidate]:
    """Complete message types; after a topic on the bus, its type comes first.

    If nothing is typed yet, it is the only candidate, so that TAB inserts it.
    """
    topic = situation.first(*TOPIC)
    name = topic_meant(situation, topic) if topic else None
    known = types_of(situation.graph, name) if name else ()
    yield from (Candidate(_spelled(one, situation.word)) for one in known)
    if situation.word or not known:
        yield from _by_package(type_names(), situation.word)


def service_types(situation: Situation) -> Iterator[Candidate]:
    """Complete service types."""
    yield from _by_package(service_names(), situation.word)


def packages(_: Situation) -> Iterator[Candidate]:
    """Complete packages that have message types."""
    yield from map(Candidate, sorted({_package(name) for name in type_names()}))


def topics_and_fields(situation: Situation) -> Iterator[Candidate]:
    """Complete topics, or the fields of a complete topic that ends in a dot or a slash."""
    yield from topics(situation)
    if any(mark in situation.word[1:] for mark in "./["):
        topic, path, types = _split(situation, situation.word, has_path=True)
        for field in _fields_of_any(types, path):
            yield Candidate(f"{topic}{field.value}", field.help, field.is_open)


def fields(situation: Situation) -> Iterator[Candidate]:
    """Complete the field paths of the topic before the cursor."""
    _, path, types = _split(situation, situation.first(*TOPIC))
    for one in _fields_of_any(types, f"{path}.{situation.word}"):
        yield Candidate(one.value[len(path) + 1 :], one.help, one.is_open)


def prototypes(situation: Situation) -> Iterator[Candidate]:
    """Complete the first value with a template of the type before the cursor."""
    from lcmtools.messages.definition import prototype_line

    name = situation.last("type_")
    if name and not situation.given.get("values") and not situation.last("file"):
        with contextlib.suppress(LcmtoolsError):
            yield Candidate(prototype_line(message_class(name)), name)


def requests(situation: Situation) -> Iterator[Candidate]:
    """Complete the request of a service with a template, or its type if one is begun."""
    from lcmtools.messages.definition import prototype_line

    words = situation.all("words")
    if len(words) > 1 or situation.last("file"):
        return
    known = service_type(situation)
    if not words and known and situation.word:
        yield Candidate(known, "its type")
    with contextlib.suppress(LcmtoolsError):
        name = service_name(words[0]) if words else known
        if name:
            yield Candidate(prototype_line(service_class(name).Request), name)


def _by_package(names: Sequence[str], word: str) -> Iterator[Candidate]:
    """Complete packages, or the types of a complete package name."""
    packages = {_package(name) for name in names}
    begun = [name for name in sorted(packages) if name.startswith(word)]
    shorts = [name.rpartition("/")[2] for name in names]
    unique = [short for short in shorts if shorts.count(short) == 1] if word else []
    if len(begun) > 1 and word not in packages:
        yield from (Candidate(f"{name}/", is_open=True) for name in begun)
    else:
        yield from (Candidate(_spelled(name, word)) for name in names)
    yield from map(Candidate, unique)


def _spelled(name: str, word: str) -> str:
    package, _, short = name.rpartition("/")
    match = _SPELLING.match(word)
    return f"{package}{match[1]}{match[2] or ''}{short}" if match else name


def _package(name: str) -> str:
    return name.partition("/")[0]


def _split(
    situation: Situation, word: str, *, has_path: bool = False
) -> tuple[str, str, Sequence[str]]:
    """Split a word into a topic on the bus and a field path; return them and the topic's types."""
    from lcmtools.messages.path import splits

    for topic, path in splits(word):
        if topic and (path or not has_path) and (name := topic_meant(situation, topic)):
            return topic, path, types_of(situation.graph, name)
    return word, "", ()


def _fields_of_any(types: Iterable[str], path: str) -> Iterator[Candidate]:
    for name in types:
        with contextlib.suppress(LcmtoolsError):  # an unknown type, or no such path
            yield from _fields(message_class(name), path)


def _fields(cls: type[Message], path: str) -> Iterator[Candidate]:
    from lcmtools.messages import fields as message_fields
    from lcmtools.messages.definition import array_type
    from lcmtools.messages.path import parse_path, target

    match = _LAST.fullmatch(path)
    owner, separator, name = match.groups() if match else (path, "", "")
    if path.endswith("["):
        array = path.removesuffix("[")
        if target(cls, parse_path(array)).dimensions:
            yield from (Candidate(f"{array}{index}") for index in _INDICES)
        return
    found = target(cls, parse_path(owner))
    if found.message_class is None or (found.dimensions and not found.sliced):
        return
    for field in message_fields.fields(found.message_class):
        whole = f"{owner}{separator}{field.name}"
        described = array_type(field.type, field.dimensions)
        yield Candidate(whole, described, bool(field.message_class or field.dimensions))
        if field.name == name and field.message_class and not field.dimensions:
            yield from _fields(cls, f"{whole}{separator or '.'}")
