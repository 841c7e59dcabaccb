"""A message to fill in, in one line of YAML, as the word that ``pub`` and ``call`` take."""

import contextlib
from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.cli.completion.words.services import service_type
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.plain import Plain, to_plain
from lcmtools.messages.registry import Message, message_class, service_class, service_name
from lcmtools.messages.text import quoted


def messages(situation: Situation) -> Iterator[Candidate]:
    """A message of the type that stands before, as the first of the values."""
    name = situation.value("type_")
    if name and not situation.given.get("values") and not situation.value("file"):
        with contextlib.suppress(LcmtoolsError):
            yield Candidate(prototype_line(message_class(name)), name)


def requests(situation: Situation) -> Iterator[Candidate]:
    """A request of the service that stands before; or its type, where one is begun."""
    words = situation.given.get("words", ())
    known = service_type(situation)
    if len(words) > 1 or situation.value("file"):
        return
    if not words and known and situation.word:
        yield Candidate(known, "its type")
    with contextlib.suppress(LcmtoolsError):
        name = service_name(words[0]) if words else known
        if name:
            yield Candidate(prototype_line(service_class(name).Request), name)


def prototype_line(cls: type[Message]) -> str:
    """The fields of a type with their defaults, as YAML in one line."""
    return _flow(to_plain(cls()))


def _flow(value: Plain) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{name}: {_flow(part)}' for name, part in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_flow, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return quoted(value) if isinstance(value, str) else repr(value)
