"""The base of users' message classes, whose modules exist only in memory.

Belongs here: pickling a class by its name and fingerprint, so that another process ("spawn") makes
it anew. Must not know how classes are made.
"""

import copyreg
from contextlib import suppress
from pathlib import Path
from typing import cast

from lcmtools.errors import UnknownType
from lcmtools.message_value import MessageValue
from lcmtools.messages.registry import Message, default_registry, fingerprint, type_name


class OwnType(type):
    """The class of users' message classes."""


class OwnMessage(MessageValue, metaclass=OwnType):
    """The base of a user's message class."""

    __slots__ = ()


def find_class(name: str, number: int, file: str) -> type[Message]:
    """Return the class of a pickled type; if it is not known, its file's workspace is searched.

    UnknownType is raised if there is no such type, or only one with another fingerprint.
    """
    from lcmtools.packages.user_types import user_types

    types = user_types()
    with suppress(UnknownType):
        if fingerprint(cls := _class(name, number)) == number:
            return cls
    if file and Path(file).exists():
        types.add_start(Path(file).parent)
    if fingerprint(cls := _class(name, number)) != number:
        raise UnknownType(f"{name} has changed since it was pickled")
    return cls


def _class(name: str, number: int) -> type[Message]:
    return default_registry().message_class(name, number, any_version=True)


def _reduce(cls: OwnType) -> str | tuple[object, ...]:
    if "__typenames__" not in vars(cls):  # not generated: this base, or a class derived by a user
        return cls.__qualname__
    kind = cast("type[Message]", cls)
    name, number = type_name(kind), fingerprint(kind)
    return find_class, (name, number, default_registry().file(name, number))


copyreg.pickle(OwnType, _reduce)  # type: ignore[arg-type] # for typeshed only functions that return tuples
