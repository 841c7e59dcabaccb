"""Finding message types by name, in any usual spelling, by class and by fingerprint.

A look-up reads tables and imports only the type that is found. If two types have the same name, the
user's own takes precedence, because it is under development. The others are still found by their
fingerprints, and by their names with a version: rover/state_t@old/state_t.lcm. Where users' types
are is decided at the edge of the program (``supply.set_supply``); nothing here reads the
environment, the working directory or the command line.
"""

import importlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import PurePath
from typing import ClassVar, Protocol, cast

from lcmtools.errors import UnknownType
from lcmtools.escapes import ESCAPES
from lcmtools.messages.enums import EnumValue
from lcmtools.messages.python_names import python_name, python_path
from lcmtools.messages.supply import Supply, current_supply
from lcmtools.messages.type_names import (
    STUDENTS,
    find,
    full_name,
    near_miss,
    preference,
    resemblance,
)
from lcmtools.messages.type_source import Problem, TypeSource, version_name

_SHIPPED = "lcmtools.types."
_OURS = "lcmtools"  # the version that means lcmtools' own type: std_msgs/String@lcmtools


class Message(Protocol):
    """The interface of every class made by lcm-gen.

    The tables have one entry per field, in wire order: its name, its LCM type (nested types as
    ``module.Name``) and its array sizes (numbers, or names of length fields), None for no array.
    """

    __slots__: ClassVar[list[str]]
    __typenames__: ClassVar[list[str]]
    __dimensions__: ClassVar[list[list[int | str] | None]]

    def __init__(self, **fields: object) -> None:
        """Create a message with default values, except for the given fields."""

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

    ``supply`` returns the user's own types; ``warn`` is called with warnings about types in use.
    """

    def __init__(
        self,
        sources: Sequence[TypeSource],
        supply: Callable[[], Supply | None] = lambda: None,
        warn: Callable[[str], object] = str,
    ) -> None:
        self._fixed = tuple(sources)
        self._get_supply = supply
        self._warn = warn
        self._warned: set[tuple[Supply | None, str]] = set()

    @property
    def _supply(self) -> Supply | None:
        return self._get_supply()

    def type_names(self) -> list[str]:
        """Return the names of all message types, sorted."""
        return sorted({name for source in self._all() for name in source.fingerprints})

    def service_names(self) -> list[str]:
        """Return the names of all service pairs, sorted."""
        return sorted({name for source in self._all() for name in source.services})

    def message_class(
        self, name: str, number: int | None = None, *, any_version: bool = False
    ) -> type[Message]:
        """Import and return the class of a type; see ``lcmtools.message_class``."""
        source, found, meant = self._type(name, number)
        if not any_version and number is None and "@" not in name:
            self._warn_once(source, found)
        return _message_class(source, found, meant)

    def service_class(self, name: str) -> type[ServiceType]:
        """Return a service's pair of messages; UnknownType unless exactly one has the name."""
        found = self.service_name(name)
        source = next(one for some in self._tiers() for one in some if found in one.services)
        return cast("type[ServiceType]", _load(source.module, found))

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

    def enum_names(self) -> list[str]:
        """Return the names of all enums, sorted; lcmtools ships none."""
        return sorted({name for source in self._all() for name in source.enums})

    def enum_class(self, name: str) -> type[EnumValue]:
        """Return the class of an enum, one of ``enum_names``."""
        source = next(one for one in self._all() if name in one.enums)
        return cast("type[EnumValue]", _load(source.module, name))

    def candidates(self, fingerprint: int, channel: str = "") -> list[str]:
        """Return the names of the types with this fingerprint (equal fields), likeliest first.

        These are the ones whose names resemble the channel's, then the user's own.
        """

        def order(name: str) -> tuple[object, ...]:
            short, whole = resemblance(name, channel)
            return -short, -whole, name not in own, *preference(name)

        for sources in self._tiers():
            if found := [(name, one) for one in sources for name in one.names(fingerprint)]:
                names = {name for name, _ in found}
                stored = self._supply.recorded_names(fingerprint) if self._supply else ()
                own = {name for name, one in found if one not in self._fixed}
                own |= set(stored) - names
                return sorted(names | own, key=order)
        return []

    def versioned(self, name: str, fingerprint: int) -> str:
        """Return the name that means the type with this fingerprint and no other.

        It is the name itself, or for a version that the name alone does not mean, with its file:
        "rover/state_t@old/state_t.lcm".
        """
        known = self.versions(name)
        if fingerprint not in known or fingerprint == next(iter(known)):
            return name
        return f"{name}@{_version(fingerprint, known)}"

    def file(self, name: str, number: int | None = None) -> str:
        """Return the .lcm file of a user's own type; "" for a shipped one."""
        having = (one.numbers(name) for some in self._tiers() for one in some)
        found = (known for known in having if known and (number is None or number in known))
        return next((known[number or next(iter(known))] for known in found), "")

    def files(self) -> dict[str, str]:
        """Return the .lcm file of each of the user's own types."""
        return {
            name: file for source in reversed(self._all()) for name, file in source.files.items()
        }

    def problems(self) -> Sequence[Problem]:
        """Return the problems of the user's own .lcm files."""
        installed = self._supply.installed() if self._supply else None
        return installed.problems if installed else ()

    def _type(self, name: str, number: int | None) -> tuple[TypeSource, str, int]:
        """Return the source of a type, its full name and its fingerprint."""
        name, _, version = name.partition("@")
        if version:
            number = self._version_number(name, version)
        if number is not None and (exact := self._exact(full_name(name), number)):
            return exact
        source, found = self._named(name)
        exact = self._exact(found, number) if number is not None else None
        return exact or (source, found, source.fingerprints[found])

    def _exact(self, name: str, number: int) -> tuple[TypeSource, str, int] | None:
        """Return the source that has this very type; a broken file of another does not matter."""
        every = (one for sources in self._tiers() for one in sources)
        return next(((one, name, number) for one in every if number in one.numbers(name)), None)

    def _named(self, name: str) -> tuple[TypeSource, str]:
        """Return the source of the type that a name means, and its full name."""
        problem = None
        for sources in self._tiers():
            found = find(name, {one for source in sources for one in source.fingerprints}, "type")
            problem = _problem(found or full_name(name), sources)
            having = [one for one in sources if found in one.fingerprints]
            if problem:  # an installed package may have the missing type
                having = [one for one in having if one not in self._fixed and one.files]
            if found and having:
                return having[0], found
        if problem:
            raise problem.error()
        raise UnknownType(f"unknown type '{name}'", self._type_hint(name))

    def _tiers(self) -> Iterator[list[TypeSource]]:
        """Yield the sources that are cheap to search; then more, for names not found in these."""
        own = self._supply.workspace() if self._supply else None
        yield (usual := [*([own] if own else []), *self._fixed])
        installed = self._supply.installed() if self._supply else None
        yield (usual := [*usual, *([installed] if installed else [])])
        if recorded := self._supply and self._supply.recorded():
            yield [*usual, *recorded]

    def _all(self) -> list[TypeSource]:
        return list(self._tiers())[-1]

    def versions(self, name: str) -> dict[int, str]:
        """Return the files of a type's versions by fingerprint, that of the name alone first."""
        found: dict[int, str] = {}
        for sources in self._tiers():
            for one in sources:
                for number, file in one.numbers(name).items():
                    found.setdefault(number, _OURS if one in self._fixed else file)
            if found:
                break
        return found

    def _version_number(self, name: str, version: str) -> int:
        """Return the fingerprint of a version of a type; UnknownType for none, or several."""
        _, found = self._named(name)
        known = self.versions(found)
        parts = PurePath(version).parts
        meant = [n for n, file in known.items() if PurePath(file).parts[-len(parts) :] == parts]
        if version.startswith("0x"):
            meant = [number for number in known if f"{number:#018x}" == version]
        if len(meant) != 1:
            names = (f"{found}@{_version(number, known)}" for number in known)
            raise UnknownType(
                f"unknown version '{version}' of {found}", f"write {' or '.join(names)}"
            )
        return meant[0]

    def _warn_once(self, source: TypeSource, name: str) -> None:
        notes = []
        if name in source.notes:
            others = [self.versioned(name, number) for number in list(self.versions(name))[1:]]
            more = f"; the first is used, the other is {' or '.join(others)}" if others else ""
            notes.append(f"{source.notes[name]}{more}")
        file = None if name.startswith(STUDENTS) else source.files.get(name)
        number = source.fingerprints[name]
        if file and any(one.fingerprints.get(name, number) != number for one in self._fixed):
            notes.append(f"{name} differs from lcmtools' own type, {name}@{_OURS}; {file} is used")
        for note in notes:
            if (self._supply, note) not in self._warned:
                self._warned.add((self._supply, note))
                self._warn(f"lcmtools: {note}")

    def _type_hint(self, name: str) -> str:
        sources = self._all()
        service = _find_service(name, sources)
        if service:
            return f"{service} is a service; its messages are {service}_Request and _Response"
        if full_name(name) in (enum for source in sources for enum in source.enums):
            return "it is an enum: msg show lists its values at the fields that hold one"
        known = [one for source in sources for one in source.fingerprints]
        if any(one.startswith(f"{name.strip('/')}/") for one in known):
            return f"it is a package: lcmtools msg package {name.strip('/')} lists its types"
        bare = re.sub(r"^(?:msg|srv)/|\.(?:lcm|msg|srv)$", "", name)
        if bare != name or re.search(r"[{:\s]", name):
            return f"write a type as {bare if bare != name else 'geometry_msgs/Twist'}"
        near, package = near_miss(name, known), full_name(name).rpartition("/")[0]
        folder = next((str(one.error()) for one in self.problems() if one.is_of_folder), "")
        return (folder if f" {package}/" not in near else "") or near or "see: lcmtools msg list"


def _version(number: int, known: Mapping[int, str]) -> str:
    """Return the shortest end of a version's file that no other has; else its fingerprint."""
    parts, others = (
        PurePath(known[number]).parts,
        [PurePath(known[n]).parts for n in known if n != number],
    )
    for count in range(1 if len(parts) == 1 else 2, len(parts) + 1):
        if not any(one[-count:] == parts[-count:] for one in others):
            return "/".join(parts[-count:])
    return f"{number:#018x}"


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


def _message_class(source: TypeSource, name: str, number: int) -> type[Message]:
    key = name if source.fingerprints[name] == number else version_name(name, number)
    return cast("type[Message]", _load(source.module, key))


def _load(prefix: str, name: str) -> object:
    package, _, short = name.rpartition("/")
    module = importlib.import_module(f"{prefix}.{python_path(package)}" if package else prefix)
    return cast("object", getattr(module, python_name(short)))


@cache
def shipped_types() -> TypeSource:
    """Return the types that lcmtools ships."""
    from lcmtools.types.fingerprints import FINGERPRINTS, SERVICES

    return TypeSource(_SHIPPED[:-1], FINGERPRINTS, SERVICES)


def _log(text: str) -> None:
    """Log a warning; it goes to standard error unless the program configures logging."""
    import logging

    logging.getLogger("lcmtools").warning("%s", text.translate(ESCAPES))


_TYPES = Registry([shipped_types()], current_supply, _log)
message_class = _TYPES.message_class
service_class, service_name, service_names = (
    _TYPES.service_class,
    _TYPES.service_name,
    _TYPES.service_names,
)
enum_names, enum_class = _TYPES.enum_names, _TYPES.enum_class
type_names, candidates = _TYPES.type_names, _TYPES.candidates
versions, versioned = _TYPES.versions, _TYPES.versioned
type_file, type_files, problems = _TYPES.file, _TYPES.files, _TYPES.problems


def is_own(name: str) -> bool:
    """Return whether a type, by its full name, is the user's own, not one that lcmtools ships."""
    return bool(type_file(name.partition("@")[0]))


def packages() -> list[str]:
    """Return the names of the packages that have message types, sorted."""
    return sorted({name.partition("/")[0] for name in type_names() if "/" in name})


def means_type(word: str) -> bool:
    """Return whether a word that may be a topic is meant as a type; see ``message_class``.

    UnknownType is raised for the short name of several.
    """
    is_of_package = word.partition("/")[0] in packages()
    return is_of_package or find(word.partition("@")[0], set(type_names()), "type") is not None


def type_name(message: Message | type) -> str:
    """Return the name of a message's type, or of a class: "geometry_msgs/Twist"."""
    return _class_name(message if isinstance(message, type) else type(message))


@cache
def fingerprint(cls: type[Message]) -> int:
    """Return the unsigned 64-bit fingerprint of a class."""
    return cls().get_hash()


@cache
def _class_name(cls: type) -> str:
    """Return a class's name; lcm-gen puts each class into its own module."""
    if name := getattr(cls, "__lcm_name__", ""):  # of a user's type
        return str(name)
    package = cls.__module__.rpartition(".")[0]
    if f"{package}.".startswith(_SHIPPED):
        package = package.removeprefix(_SHIPPED[:-1])[1:]
    else:
        package = package.rpartition(".")[2]
    return f"{package}/{cls.__name__}" if package else cls.__name__
