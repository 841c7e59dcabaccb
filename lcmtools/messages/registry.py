"""Finding message types by name, in any usual spelling, by class and by fingerprint.

A look-up reads tables and imports only the type that is found. If two types have the same name, the
user's own takes precedence, because it is under development. The others are still found by their
fingerprints. Where users' types are is decided at the edge of the program (``supply.set_supply``);
nothing here reads the environment, the working directory or the command line.
"""

import importlib
import re
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import ClassVar, Protocol, cast

from lcmtools.errors import UnknownType
from lcmtools.messages.supply import Supply, current_supply
from lcmtools.messages.type_names import STUDENTS, find, full_name, near_miss, preference
from lcmtools.messages.type_source import Problem, TypeSource

_SHIPPED = "lcmtools.types."
_USERS = "lcmtools_types_"  # prefix of the package below which packages.cache writes types


class Message(Protocol):
    """The interface of every class made by lcm-gen.

    The tables have one entry per field, in wire order: its name, its LCM type (nested types as
    ``module.Name``) and its array sizes (numbers, or names of length fields), None for no array.
    """

    __slots__: ClassVar[list[str]]
    __typenames__: ClassVar[list[str]]
    __dimensions__: ClassVar[list[list[int | str] | None]]

    def encode(self) -> bytes:
        """Return the payload, as encoded by lcm-gen's code; ``codec.encode`` is safer."""

    def get_hash(self) -> int:
        """Return the fingerprint, unsigned 64-bit."""


class ServiceType(Protocol):
    """A service's pair of message types, such as lcmtools.types.std_srvs.Trigger."""

    Request: type[Message]
    Response: type[Message]


class Registry:
    """All types of some sources; if two have the same name, the earlier source takes precedence.

    ``supply`` gives the user's own types; ``warn`` is called with warnings about types in use.
    """

    def __init__(
        self,
        sources: Sequence[TypeSource],
        supply: Supply | None = None,
        warn: Callable[[str], object] = str,
    ) -> None:
        self._fixed = tuple(sources)
        self._supply = supply
        self._warn = warn
        self._warned: set[str] = set()

    def type_names(self) -> list[str]:
        """Return the names of all message types, sorted."""
        return sorted({name for source in self._all() for name in source.fingerprints})

    def service_names(self) -> list[str]:
        """Return the names of all service pairs, sorted."""
        return sorted({name for source in self._all() for name in source.services})

    def message_class(self, name: str, number: int | None = None) -> type[Message]:
        """Import and return the class of a type; see ``lcmtools.message_class``."""
        source, found = self._type(name, number)
        self._warn_once(source, found)
        return cast("type[Message]", _load(source.prefix, found))

    def service_class(self, name: str) -> type[ServiceType]:
        """Return a service's pair of messages; UnknownType unless exactly one has the name."""
        found = self.service_name(name)
        source = next(one for some in self._tiers() for one in some if found in one.services)
        return cast("type[ServiceType]", _load(source.prefix, found))

    def service_name(self, name: str) -> str:
        """Return a service's full name, "std_srvs/Trigger"; UnknownType unless exactly one fits."""
        for sources in self._tiers():
            if found := _find_service(name, sources):
                return found
        for problem in self.problems():
            if problem.concerns(full_name(name)):
                raise problem.error()
        hint = near_miss(name, self.service_names()) or "see: lcmtools srv list"
        if found := find(name, self.type_names(), "type"):
            hint = f"{found} is a message: lcmtools msg show {found}"
        raise UnknownType(f"unknown service type '{name}'", hint)

    def candidates(self, fingerprint: int) -> list[str]:
        """Return the names of the types with this fingerprint (equal fields), likeliest first."""
        for sources in self._tiers():
            if having := [one for one in sources if fingerprint in one.fingerprints.values()]:
                pairs = (pair for one in having for pair in one.fingerprints.items())
                return sorted({name for name, of in pairs if of == fingerprint}, key=preference)
        return []

    def file(self, name: str) -> str:
        """Return the .lcm file of a user's own type; "" for a shipped one."""
        having = (one for some in self._tiers() for one in some if name in one.fingerprints)
        return next((one.files.get(name, "") for one in having), "")

    def files(self) -> dict[str, str]:
        """Return the .lcm file of each of the user's own types."""
        return {
            name: file for source in reversed(self._all()) for name, file in source.files.items()
        }

    def problems(self) -> Sequence[Problem]:
        """Return the problems of the user's own .lcm files."""
        far = self._supply.far() if self._supply else None
        return far.problems if far else ()

    def _type(self, name: str, number: int | None) -> tuple[TypeSource, str]:
        """Return the source of a type, and its full name."""
        problem = other = None
        for sources in self._tiers():
            found = find(name, {one for source in sources for one in source.fingerprints}, "type")
            problem = _problem(found or full_name(name), sources)
            having = [one for one in sources if found in one.fingerprints]
            if problem:  # an installed package may have the missing type
                having = [one for one in having if one not in self._fixed and one.files]
            if found and having:
                same = (one for one in having if one.fingerprints[found] == number)
                if (one := next(same, None)) or number is None:
                    return one or having[0], found
                other = other or (having[0], found)
        if other:
            return other
        if problem:
            raise problem.error()
        raise UnknownType(f"unknown type '{name}'", self._type_hint(name))

    def _tiers(self) -> Iterator[list[TypeSource]]:
        """Yield the sources that are cheap to search; then more, for names not found in these."""
        near = self._supply.near() if self._supply else None
        yield (usual := [*([near] if near else []), *self._fixed])
        far = self._supply.far() if self._supply else None
        yield (usual := [*usual, *([far] if far else [])])
        if recorded := self._supply and self._supply.recorded():
            yield [*usual, *recorded]

    def _all(self) -> list[TypeSource]:
        return list(self._tiers())[-1]

    def _warn_once(self, source: TypeSource, name: str) -> None:
        notes = [source.notes[name]] if name in source.notes else []
        file = None if name.startswith(STUDENTS) else source.files.get(name)
        number = source.fingerprints[name]
        if file and any(one.fingerprints.get(name, number) != number for one in self._fixed):
            notes.append(f"{name} differs from lcmtools' own type; {file} is used")
        for note in notes:
            if note not in self._warned:
                self._warned.add(note)
                self._warn(f"lcmtools: {note}")

    def _type_hint(self, name: str) -> str:
        sources = self._all()
        service = _find_service(name, sources)
        if service:
            return f"{service} is a service; its messages are {service}_Request and _Response"
        known = [one for source in sources for one in source.fingerprints]
        if any(one.startswith(f"{name.strip('/')}/") for one in known):
            return f"it is a package: lcmtools msg package {name.strip('/')} lists its types"
        bare = re.sub(r"^(?:msg|srv)/|\.(?:lcm|msg|srv)$", "", name)
        if bare != name or re.search(r"[{:\s]", name):
            return f"write a type as {bare if bare != name else 'geometry_msgs/Twist'}"
        return near_miss(name, known) or "see: lcmtools msg list"


def _find_service(name: str, sources: Sequence[TypeSource]) -> str | None:
    return find(name, {one for source in sources for one in source.services}, "service")


def _problem(name: str, sources: Sequence[TypeSource]) -> Problem | None:
    """Return the problem because of which a type is missing or an older one is used."""
    for source in sources:
        if name in source.fingerprints:
            return None
        for problem in source.problems:
            if problem.concerns(name):
                return problem
    return None


def _load(prefix: str, name: str) -> object:
    package, _, short = name.rpartition("/")
    module = importlib.import_module(f"{prefix}.{package}" if package else prefix)
    return cast("object", getattr(module, short))


_current: tuple[Supply | None, Registry] | None = None


def default_registry() -> Registry:
    """Return the registry of the shipped types and of the user's own types (see ``supply``)."""
    global _current  # noqa: PLW0603 - one registry per process, renewed with its supply
    supply = current_supply()
    if _current is None or _current[0] is not supply:
        _current = supply, Registry([shipped_types()], supply, _log)
    return _current[1]


@cache
def shipped_types() -> TypeSource:
    """Return the types that lcmtools ships."""
    from lcmtools.types.fingerprints import FINGERPRINTS, SERVICES

    return TypeSource(_SHIPPED[:-1], FINGERPRINTS, SERVICES)


def _log(text: str) -> None:
    """Log a warning; it goes to standard error unless the program configures logging."""
    import logging

    logging.getLogger("lcmtools").warning("%s", text)


def message_class(name: str, number: int | None = None) -> type[Message]:
    """Return the class of a type; see ``Registry.message_class``."""
    return default_registry().message_class(name, number)


def service_class(name: str) -> type[ServiceType]:
    """Return a service's pair of messages; see ``Registry.service_class``."""
    return default_registry().service_class(name)


def service_name(name: str) -> str:
    """Return a service's full name; see ``Registry.service_name``."""
    return default_registry().service_name(name)


def candidates(fingerprint: int) -> list[str]:
    """Return the names of the types with this unsigned fingerprint, likeliest first."""
    return default_registry().candidates(fingerprint)


def type_names() -> list[str]:
    """Return the names of all message types, sorted."""
    return default_registry().type_names()


def service_names() -> list[str]:
    """Return the names of all service pairs, sorted."""
    return default_registry().service_names()


def packages() -> list[str]:
    """Return the names of the packages that have message types, sorted."""
    return sorted({name.partition("/")[0] for name in type_names() if "/" in name})


def problems() -> Sequence[Problem]:
    """Return the problems of the user's own .lcm files, whose types may be missing."""
    return default_registry().problems()


def type_name(message: Message | type) -> str:
    """Return the name of a message's type, or of a class: "geometry_msgs/Twist"."""
    return _class_name(message if isinstance(message, type) else type(message))


@cache
def fingerprint(cls: type[Message]) -> int:
    """Return the unsigned 64-bit fingerprint of a class."""
    return cls().get_hash()


@cache
def _class_name(cls: type) -> str:
    """Return a generated class's name: lcm-gen puts each class into its own module."""
    package = cls.__module__.rpartition(".")[0]
    if f"{package}.".startswith(_SHIPPED):
        package = package.removeprefix(_SHIPPED[:-1])[1:]
    elif package.startswith(_USERS):
        package = package.partition(".")[2]
    else:
        package = package.rpartition(".")[2]
    return f"{package}/{cls.__name__}" if package else cls.__name__
