"""Modules of users' types, made in memory: a type's code runs when it is first used.

Belongs here: the packages of one set of types, their classes, enums and services. Must not know
where the code is kept.

A module is lcm-gen's own. The package of a type that only lcmtools ships (geometry_msgs) refers to
``lcmtools.types``, that of a type of which this set has no version to the set that has it.
"""

import importlib
import marshal
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from threading import RLock
from types import ModuleType
from typing import cast

from lcmtools.errors import InvalidFile
from lcmtools.messages.codec import encode
from lcmtools.messages.enums import EnumValue, enum_class
from lcmtools.messages.python_names import python_path
from lcmtools.messages.registry import Message
from lcmtools.messages.type_source import SHIPPED, TypeSource, shown
from lcmtools.packages.unit import TREE, Generated

_FINGERPRINT_BYTES = 8
_ONE_AT_A_TIME = RLock()


class TypeLoader:
    """Makes the packages of a source importable; ``read`` returns a type's code by its name.

    Other types, ``shipped``, are those of the package ``home``.
    """

    def __init__(
        self,
        source: TypeSource,
        names: Collection[str],
        read: Callable[[str], Generated],
        shipped: Mapping[str, int],
        home: str = SHIPPED,
    ) -> None:
        self._source, self._names, self._read, self._home = source, names, read, home
        self._shipped = {_package(name) for name in shipped}
        self._spelled = {_path(name): name for name in (*source.services, *names)}

    def open(self) -> None:
        """Add the packages to ``sys.modules``, the uppermost last."""
        packages = {python_path(_package(name)) for name in self._names} | self._shipped
        for package in list(packages):
            parts = package.split(".")
            packages.update(".".join(parts[:count]) for count in range(len(parts)))
        modules = {package: ModuleType(self._module(package)) for package in sorted(packages)}
        for package, module in modules.items():
            module.__path__ = []
            module.__dict__["__getattr__"] = partial(self._find, package, module)
            if package:
                above, _, short = package.rpartition(".")
                setattr(modules[above], short, module)
        for module in reversed(modules.values()):
            sys.modules[module.__name__] = module

    def _find(self, package: str, module: ModuleType, short: str) -> object:
        """Return a type or a service of a package; AttributeError if there is none."""
        name = self._spelled.get(f"{package}.{short}".lstrip("."), "")
        with _ONE_AT_A_TIME:
            if short in vars(module):  # another thread was faster
                return vars(module)[short]
            if name in self._names:
                found: object = self._type(name, short)
            elif name in self._source.services:
                own = name.rpartition("/")[2]
                parts = {end: getattr(module, f"{own}_{end}") for end in ("Request", "Response")}
                found = type(own, (), {"__doc__": f"The service {name}.", **parts})
            elif package in self._shipped and not short.startswith("__"):
                above = importlib.import_module(f"{self._home}.{package}".rstrip("."))
                return getattr(above, short)
            else:
                raise AttributeError(f"module {module.__name__} has no attribute {short}")
            setattr(module, short, found)
            return found

    def _type(self, name: str, short: str) -> object:
        one, path = self._read(name), self._module(_path(name))
        if one.tables is None:
            found = enum_class(name, path, one.values, one.number)
            found.__file__ = str(one.file.path)
            return found
        module = ModuleType(path)
        setattr(module, TREE, sys.modules[self._source.prefix])
        exec(marshal.loads(one.code), vars(module))  # noqa: S102, S302 - lcm-gen's, our own cache
        cls = cast("type[Message]", getattr(module, short))
        cls.__typenames__ = [
            kind.replace(f"{TREE}.", f"{self._source.prefix}.", 1) for kind in cls.__typenames__
        ]
        # lcm-gen's own way counts a type as often as it occurs
        cls._packed_fingerprint = self._source.fingerprints[name].to_bytes(8, "big")  # type: ignore[attr-defined] # lcm-gen's
        try:
            cls()
        except Exception as error:  # a class from a strange file may raise anything
            what = f"{shown(one.file.path)}: {name} cannot be used as a message: {error}"
            raise InvalidFile(what) from error
        if any(isinstance(kind, type) and issubclass(kind, EnumValue) for kind in self._parts(one)):
            cls._encode_one = _encode_one  # type: ignore[attr-defined] # lcm-gen's takes no numbers
        sys.modules[path] = module
        return cls

    def _parts(self, one: Generated) -> Iterator[object]:
        """Yield the classes of a type's own fields."""
        for name in one.nested():
            package, _, short = _path(name).rpartition(".")
            if name != one.name:
                yield getattr(sys.modules[self._module(package)], short)

    def _module(self, path: str) -> str:
        return f"{self._source.prefix}.{path}".rstrip(".")


def _encode_one(self: Message, buffer: "object") -> None:
    buffer.write(encode(self)[_FINGERPRINT_BYTES:])  # type: ignore[attr-defined] # a BytesIO


def _path(name: str) -> str:
    return python_path(name.replace("/", "."))


def _package(name: str) -> str:
    return name.rpartition("/")[0]
