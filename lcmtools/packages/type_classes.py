"""Classes of users' types, made from their fields when they are first used.

Belongs here: the modules of one set of types, and in them its classes, enums and services. Must not
know where types come from.

The classes have lcm-gen's interface, and our codecs. Words that Python cannot spell have other
names here: ``from_``. The package of a type that only lcmtools ships (geometry_msgs) refers to
``lcmtools.types``.
"""

import copyreg
import importlib
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from threading import RLock
from types import ModuleType
from typing import BinaryIO, cast

from lcmtools.errors import InvalidFile, UnknownType
from lcmtools.forks import free_in_child
from lcmtools.message_value import MessageValue
from lcmtools.messages import codec
from lcmtools.messages.array_codec import Cursor
from lcmtools.messages.coder import coder
from lcmtools.messages.enums import enum_class
from lcmtools.messages.python_names import python_name, python_path
from lcmtools.messages.registry import Message, fingerprint, message_class, type_file, type_name
from lcmtools.messages.supply import current_supply, has_supply
from lcmtools.messages.type_source import SHIPPED, TypeSource, shown
from lcmtools.packages import provide_user_types
from lcmtools.packages.lcm_parser import LcmField, LcmType
from lcmtools.packages.type_set import UsableType

_FINGERPRINT_BYTES = 8
_ONE_AT_A_TIME = RLock()
free_in_child(_ONE_AT_A_TIME)
_ZEROS = {"string": "", "boolean": False, "float": 0.0, "double": 0.0}

Default = Callable[[], object]
"""A function that makes a field's value in a new message."""


class OwnType(type):
    """The class of users' message classes, which another process makes anew ("spawn")."""


class OwnMessage(MessageValue, metaclass=OwnType):
    """The base of a user's message class."""

    __slots__ = ()
    _packed_fingerprint = b""

    def encode(self) -> bytes:
        """Return the payload; see ``codec.encode``."""
        return codec.encode(cast("Message", self))

    def get_hash(self) -> int:
        """Return the unsigned 64-bit fingerprint."""
        return int.from_bytes(self._packed_fingerprint, "big")

    @classmethod
    def decode(cls, data: bytes | BinaryIO) -> Message:
        """Return the message in a payload; see ``codec.decode``."""
        payload = data if isinstance(data, (bytes, bytearray, memoryview)) else data.read()
        return codec.decode(cast("type[Message]", cls), payload)

    @classmethod
    def _get_packed_fingerprint(cls) -> bytes:
        return cls._packed_fingerprint

    @classmethod
    def _get_hash_recursive(cls, parents: Sequence[type]) -> int:
        return 0 if cls in parents else int.from_bytes(cls._packed_fingerprint, "big")

    def _encode_one(self, buffer: BinaryIO) -> None:
        buffer.write(self.encode()[_FINGERPRINT_BYTES:])

    @classmethod
    def _decode_one(cls, buffer: BinaryIO) -> Message:
        start = buffer.tell()
        cursor = Cursor(buffer.read(), 0)
        message = coder(cast("type[Message]", cls)).read(cursor)
        buffer.seek(start + cursor.offset)
        return message


class TypeModules:
    """Makes the packages of a source importable; ``types`` are its types by key.

    Other types, ``shipped``, are those of ``lcmtools.types``.
    """

    def __init__(
        self, source: TypeSource, types: Mapping[str, UsableType], shipped: Mapping[str, int]
    ) -> None:
        self._source, self._types = source, types
        self._shipped = {_package(name) for name in shipped}
        self._spelled = {_path(name): name for name in (*source.services, *types)}

    def open(self) -> None:
        """Add the packages to ``sys.modules``, the uppermost last."""
        packages = {python_path(_package(name)) for name in self._types} | self._shipped
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
            if name in self._types:
                found = self._type(name)
            elif name in self._source.services:
                own = name.rpartition("/")[2]
                parts = {end: getattr(module, f"{own}_{end}") for end in ("Request", "Response")}
                found = type(own, (), {"__doc__": f"The service {name}.", **parts})
            elif package in self._shipped and not short.startswith("__"):
                above = importlib.import_module(f"{SHIPPED}.{package}".rstrip("."))
                return getattr(above, short)
            else:
                raise AttributeError(f"module {module.__name__} has no attribute {short}")
            setattr(module, short, found)
            return found

    def _type(self, key: str) -> type:
        usable, path = self._types[key], self._module(_path(key))
        one = usable.type
        if one.values is not None:
            enum = enum_class(one.name, path, one.values, one.number)
            enum.__file__ = usable.file
            return enum
        try:
            cls = _message_class(usable, path, lambda key: self._module(_path(key)))
            cls()
        except Exception as error:  # a class from a strange file may raise anything
            what = f"{shown(usable.file)}: {one.name} cannot be used as a message: {error}"
            raise InvalidFile(what) from error
        module = sys.modules[path] = ModuleType(path)
        setattr(module, cls.__name__, cls)
        return cls

    def _module(self, path: str) -> str:
        return f"{self._source.module}.{path}".rstrip(".")


def _message_class(usable: UsableType, module: str, path_of: Callable[[str], str]) -> OwnType:
    """Return the class of a struct; ``path_of`` returns the full names of its fields' types."""
    one = usable.type
    words = {*(field.name for field in one.fields), *one.constants}
    names = {word: python_name(word, words) for word in words}
    kinds, defaults = [], []
    for field in one.fields:
        path, make = field.type, None
        if field.type in usable.parts:
            path = path_of(usable.parts[field.type])
            if field.is_fixed:  # one of variable size may lead back to this type
                make = _class(path)
        kinds.append(path)
        defaults.append(_default(field, field.sizes, make))
    attributes = [names[field.name] for field in one.fields]
    sizes = [[names.get(str(size), size) for size in field.sizes] for field in one.fields]
    short = python_name(one.name.rpartition("/")[2])
    space = {
        "__module__": module,
        "__doc__": f"The message type {one.name}.",
        "__slots__": attributes,
        "__typenames__": kinds,
        "__dimensions__": [one or None for one in sizes],
        "__lcm_name__": one.name,
        "__renamed__": {spelled: word for word, spelled in names.items() if spelled != word},
        "__constant_types__": {name: kind for name, (kind, _) in one.constants.items()},
        "__init__": _initializer(short, attributes, defaults, one),
        "_packed_fingerprint": usable.number.to_bytes(_FINGERPRINT_BYTES, "big"),
        **{names[name]: value for name, (_, value) in one.constants.items()},
    }
    return OwnType(short, (OwnMessage,), space)


def _class(path: str) -> type:
    module, _, short = path.rpartition(".")
    return cast("type", getattr(importlib.import_module(module), short))


def _default(field: LcmField, sizes: Sequence[int | str], make: Default | None) -> Default | None:
    """Return what makes a new value of a field; None for a constant, as returned by ``_zero``."""
    if not sizes:
        return make
    size, inner = sizes[0], sizes[1:]
    if field.type == "byte" and not inner:
        return None
    if isinstance(size, str):
        return list
    element = _default(field, inner, make) or partial(_zero, field)
    return lambda: [element() for _ in range(size)]


def _zero(field: LcmField) -> object:
    if field.type == "byte" and field.sizes:
        size = field.sizes[-1]
        return bytes(size) if isinstance(size, int) else b""
    return _ZEROS.get(field.type, 0)


def _initializer(
    short: str, attributes: Sequence[str], defaults: Sequence[Default | None], one: LcmType
) -> Callable[..., None]:
    """Return the constructor, whose parameters are the fields, length fields last.

    Named parameters keep it fast. Python's own TypeError for an unknown name begins with the
    function's qualified name, which therefore has the fields' names.
    """
    own, make = "self", "make"
    while own in attributes:
        own = f"_{own}"
    while any(name.startswith(make) for name in attributes):
        make = f"_{make}"
    lengths = {size for field in one.fields for size in field.sizes}
    order = sorted(range(len(attributes)), key=lambda at: one.fields[at].name in lengths)
    space: dict[str, object] = {}
    parameters, body = [own], [" pass"]
    for at in order:
        name, default = attributes[at], defaults[at]
        value = name
        space[f"{make}{at}"] = default or _zero(one.fields[at])
        if default:
            value = f"{make}{at}() if {name} is None else {name}"
        parameters.append(f"{name}={None if default else f'{make}{at}'}")
        body.append(f" {own}.{name} = {value}")
    exec(f"def __init__({', '.join(parameters)}):\n" + "\n".join(body), space)  # noqa: S102 - of names
    init = cast("Callable[..., None]", space["__init__"])
    known = f"has the fields {', '.join(attributes[at] for at in order)}" if order else ""
    init.__qualname__ = f"{short} {known or 'has no fields'}; {short}"
    return init


def find_class(name: str, number: int, file: str) -> type[Message]:
    """Return the class of a pickled type; if it is not known, its file's workspace is searched.

    UnknownType is raised if there is no such type, or only one with another fingerprint.
    """
    if not has_supply():
        provide_user_types()
    types = current_supply()
    with suppress(UnknownType):
        if fingerprint(cls := _any_class(name, number)) == number:
            return cls
    if types and file and Path(file).exists():
        types.add_start(Path(file).parent)
    if fingerprint(cls := _any_class(name, number)) != number:
        raise UnknownType(f"{name} has changed since it was pickled")
    return cls


def _any_class(name: str, number: int) -> type[Message]:
    return message_class(name, number, any_version=True)


def _reduce(cls: OwnType) -> str | tuple[object, ...]:
    if "__typenames__" not in vars(cls):  # this base, or a class derived by a user
        return cls.__qualname__
    kind = cast("type[Message]", cls)
    name, number = type_name(kind), fingerprint(kind)
    return find_class, (name, number, type_file(name, number))


copyreg.pickle(OwnType, _reduce)  # type: ignore[arg-type] # for typeshed only functions that return tuples


def _path(name: str) -> str:
    return python_path(name.replace("/", "."))


def _package(name: str) -> str:
    return name.rpartition("/")[0]
