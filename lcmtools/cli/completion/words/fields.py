"""Field paths: ``pose.pose.position`` behind a topic, or as the value of ``--field``."""

import contextlib
import re
from collections.abc import Iterable, Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.path import parse_path, target
from lcmtools.messages.registry import Message, message_class

_LAST = re.compile(r"(.*?)([./]?)([^./\[\]]*)", re.DOTALL)
_INDICES = ("[0]", "[-1]", "[0:5]", "[::10]")


def fields(situation: Situation) -> Iterator[Candidate]:
    """The field paths of the topic that stands before."""
    from lcmtools.cli.completion.words.topics import TOPIC, topic_meant, types_of
    from lcmtools.messages.path import splits

    for topic, path in splits(situation.first(*TOPIC)):
        name = topic_meant(situation, topic) if topic else None
        if name:
            types = types_of(situation.graph, name)
            for one in fields_behind(types, f"{path}.{situation.word}"):
                yield Candidate(one.value[len(path) + 1 :], one.help, one.is_open)
            return


def fields_behind(types: Iterable[str], path: str) -> Iterator[Candidate]:
    """The field paths that begin as ``path`` does, for messages of any of the types."""
    for name in types:
        # a type that is not known here, or a path that leads nowhere
        with contextlib.suppress(LcmtoolsError):
            yield from _fields_behind(message_class(name), path)


def _fields_behind(cls: type[Message], path: str) -> Iterator[Candidate]:
    match = _LAST.fullmatch(path)
    owner, separator, name = match.groups() if match else (path, "", "")
    if path.endswith("["):
        yield from _indices(cls, path.removesuffix("["))
        return
    found = target(cls, parse_path(owner))
    if found.message_class is None or (found.dimensions and not found.sliced):
        return
    for field in visible_fields(found.message_class):
        whole = f"{owner}{separator}{field.name}"
        yield Candidate(whole, _described(field), _has_fields(field))
        if field.name == name and field.message_class and not field.dimensions:
            yield from _fields_behind(cls, f"{whole}{separator or '.'}")


def _indices(cls: type[Message], array: str) -> Iterator[Candidate]:
    if target(cls, parse_path(array)).dimensions:
        yield from (Candidate(f"{array}{index}") for index in _INDICES)


def _has_fields(field: Field) -> bool:
    return field.message_class is not None or bool(field.dimensions)


def _described(field: Field) -> str:
    sizes = (str(size) if isinstance(size, int) else "" for size in field.dimensions)
    return field.type + "".join(f"[{size}]" for size in sizes)
