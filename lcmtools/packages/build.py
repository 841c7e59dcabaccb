"""Building importable Python packages and an index of their types from .lcm files.

Belongs here: deciding which types can be used, the packages' ``__init__``, the pairs of services,
fingerprints. Must not know the source of the files or the place of the result.

A type is lcm-gen's own module. The package of a type that only lcmtools ships (geometry_msgs)
consists of names that refer to ``lcmtools.types``.
"""

import importlib
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from tempfile import TemporaryDirectory

from lcmtools.messages.python_names import python_name, python_path
from lcmtools.messages.type_source import SHIPPED, Problem
from lcmtools.packages.generated import Generated, generate, move, unknown_type
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.versions import version_place
from lcmtools.wire.datagram import MESSAGE_MAX

_INIT = '''"""Made by lcmtools of .lcm files: change those, not this."""

{imports}

def __getattr__(name: str) -> object:
    """Import a type that only lcmtools ships."""
    from importlib import import_module

    if {shipped} and not name.startswith("__"):
        return getattr(import_module("{home}"), name)
    raise AttributeError(f"module {{__name__}} has no attribute {{name}}")
'''
_PAIR = '''"""Made by lcmtools of .lcm files: change those, not this."""

from {module}_Request import {short}_Request
from {module}_Response import {short}_Response


class {name}:
    """The service {service}."""

    Request = {short}_Request
    Response = {short}_Response
'''


@dataclass(slots=True)
class _Build:
    prefix: str
    folder: Path
    shipped: Collection[str]
    home: str = SHIPPED  # the module that has the shipped types
    types: dict[str, Generated] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    places: list[str] = field(default_factory=list)  # folders and files with other definitions

    @property
    def root(self) -> Path:
        return self.folder / self.prefix

    def add(self, file: LcmFile) -> None:
        """Add the types of one file; if two have the same name, the first takes precedence."""
        with TemporaryDirectory(dir=self.folder) as name:
            scratch = Path(name)
            found, problems = generate(file, self.prefix, scratch)
            self.problems += problems
            for one in found:
                if one.name not in self.types:
                    self.types[one.name] = move(one, scratch / self.prefix, self.root)
                elif one.tables != self.types[one.name].tables:
                    first = self.types[one.name].file
                    self.notes[one.name] = (
                        f"{one.name} is defined differently in {first} and in {one.file}"
                    )
                    if (place := str(version_place(one.file, first))) not in self.places:
                        self.places.append(place)

    def drop_too_large(self) -> None:
        """Remove types with more elements than LCM carries bytes: Python would create them all."""
        counts: dict[str, int] = {}
        for one in list(self.types.values()):
            if self._elements(one.name, counts) > MESSAGE_MAX:
                what = f"{one.name} is larger than LCM's {MESSAGE_MAX} bytes"
                self._refuse(one, what, "give the array's size in a field:  double values[size];")
                self._drop(one.name)

    def drop_incomplete(self) -> None:
        """Remove types with fields of unknown types, until all are complete."""
        while incomplete := [found for one in self.types.values() if (found := self._missing(one))]:
            known = {name for name, one in self.types.items() if one.tables} | set(self.shipped)
            for one, missing in incomplete:
                self.problems.append(unknown_type(one, missing, known))
                self._drop(one.name)

    def write_packages(self) -> list[str]:
        """Write each package's ``__init__`` and the services; return the services' names."""
        requests = [one.removesuffix("_Request") for one in self.types if one.endswith("_Request")]
        services = [
            name
            for name in sorted(requests)
            if f"{name}_Response" in self.types and name not in self.types
        ]
        for name in services:
            self._write_pair(name)
        exported = [*sorted(self.types), *services]
        for package in sorted(self._packages(exported)):
            names = [name.rpartition("/")[2] for name in exported if _package(name) == package]
            self._write_init(package, names)
        return services

    def fingerprints(self) -> dict[str, int]:
        """Import all types, and remove types that Python cannot create messages of."""
        sys.path.insert(0, str(self.folder))
        try:
            importlib.invalidate_caches()
            numbers = {name: self._fingerprint(one) for name, one in sorted(self.types.items())}
        finally:
            sys.path.remove(str(self.folder))
            for module in [one for one in sys.modules if one.split(".")[0] == self.prefix]:
                del sys.modules[module]
        return {name: number for name, number in numbers.items() if number is not None}

    def _fingerprint(self, one: Generated) -> int | None:
        if not one.tables:
            return None  # an enum is not a message
        path = one.module.relative_to(self.folder).with_suffix("")
        try:
            message = getattr(importlib.import_module(".".join(path.parts)), path.name)()
            return int(message.get_hash())
        except RecursionError:
            what = f"{one.name} contains itself"
            self._refuse(one, what, "only an array of variable size can hold its own type")
        except Exception as error:  # noqa: BLE001 - a class from a strange file may raise anything
            self._refuse(one, f"{one.name}: it cannot be used as a message: {error}", "")
        return None

    def _refuse(self, one: Generated, what: str, hint: str) -> None:
        self.problems.append(Problem(str(one.file), 0, what, hint, one.name))

    def _drop(self, name: str) -> None:
        self.types.pop(name).module.unlink()

    def _elements(self, name: str, counts: dict[str, int]) -> int:
        """Return the least number of elements of a type's messages; ``counts`` has known ones."""
        one = self.types.get(name)
        if name not in counts and one and one.tables:
            counts[name] = 1  # while it is being counted, for a type that contains itself
            _, kinds, dimensions = one.tables
            counts[name] = sum(
                prod(map(int, sizes or ())) * self._elements(self._named(kind), counts)
                for kind, sizes in zip(kinds, dimensions, strict=True)
                if not any(isinstance(size, str) for size in sizes or ())
            )
        return counts.get(name, 1)

    def _named(self, path: str) -> str:
        """Return the name of the type with a module path: "PREFIX.geometry_msgs.Twist"."""
        return "/".join(path.removeprefix(f"{self.prefix}.").rsplit(".", 1))

    def _missing(self, one: Generated) -> tuple[Generated, str] | None:
        for path in one.nested():
            name = self._named(path)
            there = self.types.get(name)
            if not (there.tables if there else name in self.shipped):
                return one, name
        return None

    def _packages(self, names: Iterable[str]) -> set[str]:
        """Return all packages and their parents, including those that only lcmtools ships."""
        packages = {_package(name) for name in (*names, *self.shipped)}
        for package in list(packages):
            parts = package.split(".")
            packages.update(".".join(parts[:count]) for count in range(len(parts)))
        return packages

    def _write_init(self, package: str, names: Sequence[str]) -> None:
        folder = self.root.joinpath(*filter(None, python_path(package).split(".")))
        folder.mkdir(parents=True, exist_ok=True)
        shipped = any(_package(name) == package for name in self.shipped)
        text = _INIT.format(
            imports="".join(
                f"from .{name} import {name} as {name}\n" for name in map(python_name, names)
            ),
            shipped=shipped,
            home=f"{self.home}.{package}".rstrip("."),
        )
        (folder / "__init__.py").write_text(text, "utf-8")

    def _write_pair(self, service: str) -> None:
        package, _, short = service.rpartition("/")
        spelled = python_path(package)
        module, name = ".".join(filter(None, (self.prefix, spelled, short))), python_name(short)
        text = _PAIR.format(module=module, short=short, name=name, service=service)
        (self.root / Path(*spelled.split("."), f"{name}.py")).write_text(text, "utf-8")


def build(
    files: Sequence[LcmFile],
    prefix: str,
    folder: Path,
    shipped: Mapping[str, int],
    home: str = SHIPPED,
) -> dict[str, object]:
    """Fill an empty folder with the types of some files; return their table, for JSON.

    The types are below a package ``prefix``; ``shipped`` are further types, of a package ``home``,
    that their fields may use. If two files have the same type, the first takes precedence.

    Raises:
        MissingExtra: There is no lcm-gen.
    """
    making = _Build(prefix, folder, shipped, home)
    making.root.mkdir()
    for file in files:
        making.add(file)
    making.drop_too_large()
    making.drop_incomplete()
    services = making.write_packages()
    numbers = making.fingerprints()
    return {
        "fingerprints": {name: f"{number:016x}" for name, number in numbers.items()},
        "files": {name: str(making.types[name].file) for name in numbers},
        "services": [name for name in services if f"{name}_Request" in numbers],
        "problems": [problem._asdict() for problem in making.problems],
        "notes": making.notes,
        "places": making.places,
    }


def _package(name: str) -> str:
    return name.rpartition("/")[0]
