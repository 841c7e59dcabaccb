"""Which message types there are: by name, by class and by fingerprint.

Belongs here: how a type's name is read and written, and how its class is found. Must not know
what is inside a message. A look-up by name or fingerprint reads tables and imports no type.
"""

import importlib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Protocol, cast

from lcmtools.errors import UnknownType

PREFERRED = (
    "std_msgs/Empty",
    "std_msgs/Bool",
    "std_msgs/Int8",
    "std_msgs/UInt8",
    "std_msgs/Int16",
    "std_msgs/Int32",
    "std_msgs/Int64",
    "std_msgs/Time",
    "builtin_interfaces/Time",
    "geometry_msgs/Vector3",
    "geometry_msgs/Twist",
    "geometry_msgs/TwistStamped",
    "geometry_msgs/TwistWithCovariance",
    "geometry_msgs/TwistWithCovarianceStamped",
)
"""What a payload is taken for when several types have its fingerprint: the type that robots send
most. Types that are not listed follow in alphabetical order."""

_NAME = re.compile(r"(?:([\w.]+?)[/.](?:(?:msg|srv)[/.])?)?(\w+)", re.ASCII)


class Message(Protocol):
    """What every class made by lcm-gen offers.

    The tables have one entry a field, in wire order: its name, its LCM type (nested types as
    ``module.Name``) and its array sizes (numbers, or names of length fields), None for no array.
    """

    __slots__: ClassVar[list[str]]
    __typenames__: ClassVar[list[str]]
    __dimensions__: ClassVar[list[list[int | str] | None]]

    def encode(self) -> bytes:
        """The payload, as lcm-gen's code makes it; ``codec.encode`` is the safe way."""

    def get_hash(self) -> int:
        """The fingerprint, unsigned 64-bit."""


class ServiceType(Protocol):
    """A pair of message types, like lcmtools.types.std_srvs.Trigger: asked and answered."""

    Request: type[Message]
    Response: type[Message]


@dataclass(frozen=True, slots=True)
class TypeSource:
    """A place that generated classes are imported from.

    Attributes:
        prefix: The module above the packages, as given to lcm-gen ("lcmtools.types").
        fingerprints: Every type's name ("geometry_msgs/Twist") and fingerprint.
        services: Names of the service pairs ("std_srvs/Trigger").
    """

    prefix: str
    fingerprints: Mapping[str, int]
    services: Sequence[str] = ()


class Registry:
    """All types of some sources; an earlier source wins where two have the same name."""

    def __init__(self, sources: Sequence[TypeSource]) -> None:
        self._sources = tuple(sources)
        self._types = {name: s for s in reversed(self._sources) for name in s.fingerprints}
        self._services = {name: s for s in reversed(self._sources) for name in s.services}

    def type_names(self) -> list[str]:
        """Names of all message types, sorted."""
        return sorted(self._types)

    def service_names(self) -> list[str]:
        """Names of all service pairs, sorted."""
        return sorted(self._services)

    def message_class(self, name: str) -> type[Message]:
        """The class of a type, imported now.

        Args:
            name: geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or, where only
                one package has it, Twist.

        Raises:
            UnknownType: There is no such type, or several packages have it.
        """
        found = _find(name, self._types, "type")
        if not found:
            raise UnknownType(f"unknown type '{name}'", self._type_hint(name))
        return cast("type[Message]", _load(self._types[found].prefix, found))

    def service_class(self, name: str) -> type[ServiceType]:
        """The pair of a service; the name is written as for ``message_class``.

        Raises:
            UnknownType: There is no such service, or several packages have it.
        """
        found = self.service_name(name)
        return cast("type[ServiceType]", _load(self._services[found].prefix, found))

    def service_name(self, name: str) -> str:
        """The full name of a service pair ("std_srvs/Trigger"), of any way to write it.

        Raises:
            UnknownType: There is no such service, or several packages have it.
        """
        found = _find(name, self._services, "service")
        if not found:
            hint = _near(name, self._services) or "see: lcmtools srv list"
            raise UnknownType(f"unknown service type '{name}'", hint)
        return found

    def candidates(self, fingerprint: int) -> list[str]:
        """Names of the types with this fingerprint, the likeliest first (see PREFERRED).

        Types with equal field names and types share a fingerprint, so this is a list.
        """
        names = [
            name for name, source in self._types.items() if source.fingerprints[name] == fingerprint
        ]
        return sorted(names, key=_preference)

    def type_name(self, cls: type) -> str:
        """The name of a generated class, whether it is registered here or not."""
        package, _, _ = cls.__module__.rpartition(".")
        for source in self._sources:
            if package.startswith(f"{source.prefix}."):
                return f"{package.removeprefix(source.prefix)[1:]}/{cls.__name__}"
        return "/".join(filter(None, (package.rpartition(".")[2], cls.__name__)))

    def _type_hint(self, name: str) -> str:
        service = _find(name, self._services, "service")
        if service:
            return f"{service} is a service; its messages are {service}_Request and _Response"
        return _near(name, self._types) or "see: lcmtools msg list"


@cache
def default_registry() -> Registry:
    """The registry of the types that lcmtools brings along."""
    from lcmtools.types.fingerprints import FINGERPRINTS, SERVICES

    return Registry([TypeSource("lcmtools.types", FINGERPRINTS, SERVICES)])


def type_names() -> list[str]:
    """Names of all message types, sorted."""
    return default_registry().type_names()


def packages() -> list[str]:
    """Names of the packages that have message types, sorted."""
    return sorted({name.partition("/")[0] for name in type_names()})


def service_names() -> list[str]:
    """Names of all service pairs, sorted."""
    return default_registry().service_names()


def message_class(name: str) -> type[Message]:
    """The class of a type (see Registry.message_class).

    Raises:
        UnknownType: There is no such type, or several packages have it.
    """
    return default_registry().message_class(name)


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


def _find(name: str, known: Iterable[str], kind: str) -> str | None:
    """The one of the known names that is meant, None for none of them."""
    match = _NAME.fullmatch(name)
    if not match:
        return None
    package, short = match.groups()
    if package:
        full = f"{package}/{short}"
        return full if full in known else None
    found = sorted(full for full in known if full.rpartition("/")[2] == short)
    if len(found) > 1:
        raise UnknownType(f"several {kind}s are called '{name}'", f"say {' or '.join(found)}")
    return found[0] if found else None


def _near(name: str, known: Iterable[str]) -> str:
    """A hint that names the known names most like a mistyped one, "" if there are none."""
    import difflib

    package, _, short = re.sub(r"[/.](msg|srv)(?=[/.])", "", name).replace(".", "/").rpartition("/")
    folded: dict[str, list[str]] = {}
    for full in known:
        folded.setdefault(full.rpartition("/")[2].lower(), []).append(full)
    close = difflib.get_close_matches(short.lower(), folded, n=1)
    if not close:
        return ""
    names = folded[close[0]]
    same_package = [full for full in names if full.startswith(f"{package}/")]
    return f"did you mean {' or '.join(sorted(same_package or names))}?"


def _preference(name: str) -> tuple[int, str]:
    return (PREFERRED.index(name) if name in PREFERRED else len(PREFERRED), name)


def _load(prefix: str, name: str) -> object:
    package, _, short = name.rpartition("/")
    return getattr(importlib.import_module(f"{prefix}.{package}"), short)
