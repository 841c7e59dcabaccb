"""Which message types there are: those that lcmtools brings along and the user's own.

The one door to types for everybody else; how they are looked up is catalogue.py's business.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from lcmtools.messages.catalogue import Registry
from lcmtools.messages.message import Message, ServiceType
from lcmtools.packages.source import Problem, TypeSource

if TYPE_CHECKING:  # most look-ups do without them
    from lcmtools.packages.user_types import UserTypes

__all__ = [
    "Message",
    "Registry",
    "ServiceType",
    "candidates",
    "default_registry",
    "fingerprint",
    "message_class",
    "packages",
    "problems",
    "service_class",
    "service_name",
    "service_names",
    "type_name",
    "type_names",
    "user_types",
]


@cache
def default_registry() -> Registry:
    """The registry of the types that lcmtools brings along and of the user's own."""
    return Registry([_shipped()], user_types(), _log)


@cache
def user_types() -> "UserTypes":
    """The types of the person who runs this process (LCMTOOLS_TYPE_PATH, packages)."""
    import os
    import sys

    from lcmtools.packages.user_types import UserTypes

    script = Path(sys.argv[0] if sys.argv and sys.argv[0] else ".").absolute().parent

    def starts() -> list[Path]:
        try:
            here = [Path.cwd()]
        except OSError:  # somebody has removed the current folder
            here = []
        return [*here, *([script] if script.name != "bin" else [])]

    return UserTypes(os.environ, starts, _shipped().fingerprints)


@cache
def _shipped() -> TypeSource:
    from lcmtools.types.fingerprints import FINGERPRINTS, SERVICES

    return TypeSource("lcmtools.types", FINGERPRINTS, SERVICES)


def _log(text: str) -> None:
    """Warn as libraries do: to standard error, unless the program wants it elsewhere."""
    import logging

    logging.getLogger("lcmtools").warning("%s", text)


def type_names() -> list[str]:
    """Names of all message types, sorted."""
    return default_registry().type_names()


def problems() -> Sequence[Problem]:
    """What is wrong with .lcm files of the user's own: types of theirs may be missing."""
    return default_registry().problems()


def packages() -> list[str]:
    """Names of the packages that have message types, sorted."""
    return sorted({name.partition("/")[0] for name in type_names() if "/" in name})


def service_names() -> list[str]:
    """Names of all service pairs, sorted."""
    return default_registry().service_names()


def message_class(name: str, number: int | None = None) -> type[Message]:
    """The class of a type (see Registry.message_class).

    Raises:
        UnknownType: There is no such type, or several packages have it.
        InvalidFile: The .lcm file that should have it is wrong.
    """
    return default_registry().message_class(name, number)


def service_class(name: str) -> type[ServiceType]:
    """The pair of a service (see Registry.service_class).

    Raises:
        UnknownType: There is no such service, or several packages have it.
    """
    return default_registry().service_class(name)


def service_name(name: str) -> str:
    """The full name of a service pair (see Registry.service_name).

    Raises:
        UnknownType: There is no such service, or several packages have it.
    """
    return default_registry().service_name(name)


def candidates(fingerprint: int) -> list[str]:
    """Names of the types with this unsigned fingerprint, the likeliest first."""
    return default_registry().candidates(fingerprint)


def type_name(message: Message | type[Message]) -> str:
    """The name of a message's type, or of a class: "geometry_msgs/Twist"."""
    return _class_name(message if isinstance(message, type) else type(message))


@cache
def fingerprint(cls: type[Message]) -> int:
    """The fingerprint of a class, unsigned 64-bit."""
    return cls().get_hash()


@cache
def _class_name(cls: type) -> str:
    return default_registry().type_name(cls)
