"""Users' own types: where they come from, and their precedence.

Those of the workspace, of LCMTOOLS_TYPE_PATH and of noted workspaces take precedence over the
shipped types, because they are under development. Those of installed packages come last, and only
for types that are otherwise unknown, because finding them takes a moment.
"""

import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

from lcmtools.errors import LcmtoolsError, UnknownType
from lcmtools.folders import read_text
from lcmtools.messages.enums import EnumType, EnumValue
from lcmtools.messages.fields import fields
from lcmtools.messages.python_names import python_name
from lcmtools.messages.registry import (
    Message,
    ServiceType,
    enum_class,
    enum_names,
    fingerprint,
    message_class,
    packages,
    service_class,
    service_names,
    type_file,
    type_files,
    type_name,
    type_names,
)
from lcmtools.messages.supply import current_supply, has_supply
from lcmtools.messages.type_source import Problem, TypeSource
from lcmtools.names import did_you_mean
from lcmtools.packages import provide_user_types
from lcmtools.packages.type_files import (
    LcmFile,
    installed_folders,
    is_type_file,
    read_folders,
    shipped_folder,
    variable_folders,
)
from lcmtools.packages.workspace import noted_type_folders, type_folders

if TYPE_CHECKING:  # most commands need neither
    from lcmtools.packages.placed_type import Comment
    from lcmtools.wire.log_index import RecordedType

_WORKSPACE_AGAIN = 1.0
_INSTALLED_AGAIN = 10.0
"""Seconds after which files are read again, because they may be edited while a command runs."""


@dataclass(slots=True)
class _Found:
    """The files and types found by the last search, with its time and start folders."""

    time: float = float("-inf")
    folders: object = None
    files: Sequence[LcmFile] = ()
    problems: Sequence[Problem] = ()
    source: TypeSource | None = None


class UserTypes:
    """One user's own types.

    The workspaces of the folders ``starts`` are searched; ``shipped`` has the fingerprints of
    lcmtools' own types.
    """

    def __init__(
        self,
        environment: Mapping[str, str],
        starts: Sequence[Path],
        shipped: Mapping[str, int],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._environment = environment
        self._starts = list(starts)
        self._shipped = shipped
        self._clock = clock
        self._workspace = _Found()
        self._installed = _Found()
        self._recorded: dict[tuple[LcmFile, ...], TypeSource | None] = {}  # by log
        self._recorded_names: defaultdict[int, dict[str, None]] = defaultdict(dict)

    def workspace(self) -> TypeSource | None:
        """The types of LCMTOOLS_TYPE_PATH and of workspaces; None if there are none."""
        return self._current(self._workspace, _WORKSPACE_AGAIN, self.workspace_folders, _Found())

    def installed(self) -> TypeSource | None:
        """The same types and those of installed packages."""
        self.workspace()
        return self._current(self._installed, _INSTALLED_AGAIN, installed_folders, self._workspace)

    def recorded(self) -> list[TypeSource]:
        """The types stored with each log; their files do not exist here, so none are named."""
        for files, source in self._recorded.items():
            if source is None:
                found = self._compiled(files)
                versions = {
                    name: dict.fromkeys(others, "") for name, others in found.versions.items()
                }
                self._recorded[files] = TypeSource(
                    found.module, found.fingerprints, versions=versions
                )
        return [source for source in self._recorded.values() if source]

    def add_recorded(self, types: "Iterable[RecordedType]") -> None:
        """Add the types stored with a log."""
        types = [one for one in types if is_type_file(Path(one.path))]
        self._recorded.setdefault(tuple(dict.fromkeys(map(_recorded_file, types))))
        for one in types:
            self._recorded_names[one.fingerprint][one.name] = None

    def recorded_names(self, fingerprint: int) -> list[str]:
        """Return the names under which logs have stored types with this fingerprint."""
        return list(self._recorded_names.get(fingerprint, ()))

    def compiled_types(self, types: "Iterable[RecordedType]") -> TypeSource:
        """Return types by their text."""
        return self._compiled(tuple(dict.fromkeys(map(_recorded_file, types))))

    def compiled(self, folders: Sequence[Path]) -> TypeSource:
        """Return the types in these folders, and those that they may use from others."""
        found = self._source(*read_folders([*folders, *self.all_folders()]))
        return found or TypeSource("", {})

    def workspace_folders(self) -> list[Path]:
        """The folders that take precedence over the shipped types."""
        around = type_folders(*self._starts)
        noted = noted_type_folders(self._environment)
        return [*variable_folders(self._environment), *around, *noted]

    def all_folders(self) -> list[Path]:
        """All folders, installed packages last."""
        return [*self.workspace_folders(), *installed_folders()]

    def declared_packages(self) -> set[str]:
        """Return the packages that the files declare; a file may be wrong."""
        from lcmtools.packages.lcm_parser import declared

        files, _ = read_folders(self.all_folders())
        named = {file.package for file in files if file.package}
        texts = (one.content.decode("utf-8", "replace") for one in files if not one.package)
        return named.union(*(declared(text)[1] for text in texts))

    def add_start(self, folder: Path) -> None:
        """Also search the workspace of another folder."""
        if folder not in self._starts:
            self._starts.append(folder)

    def _current(
        self, found: _Found, seconds: float, folders: Callable[[], Sequence[Path]], first: _Found
    ) -> TypeSource | None:
        """Return the types of ``first`` and of folders, which are searched from time to time."""
        if found.folders != self._starts or self._clock() - found.time >= seconds:
            files, problems = read_folders(folders())
            found.files = list({file.where: file for file in (*first.files, *files)}.values())
            found.problems = list(dict.fromkeys((*first.problems, *problems)))
            found.source = self._source(found.files, found.problems)
            found.time, found.folders = self._clock(), list(self._starts)
        return found.source

    def _source(self, files: Sequence[LcmFile], problems: Sequence[Problem]) -> TypeSource | None:
        if not files:
            return TypeSource("", {}, problems=problems) if problems else None
        source = self._compiled(files)
        return source._replace(problems=[*problems, *source.problems])

    def _compiled(self, files: Sequence[LcmFile]) -> TypeSource:
        from lcmtools.packages.cache import types_of

        return types_of(files, self._environment, self._shipped)


def _recorded_file(one: "RecordedType") -> LcmFile:
    path = Path(one.path)
    package = one.name.rpartition("/")[0] if path.suffix != ".lcm" else ""
    return LcmFile(str(path), one.source.encode("utf-8", "surrogateescape"), package)


def user_types() -> UserTypes:
    """Return the types of this process's user; reads the environment if not done before."""
    if not has_supply():
        provide_user_types()
    return cast("UserTypes", current_supply())


def sources_of(words: Sequence[str]) -> list[Path]:
    """Return the .lcm files of types and of all types of their fields, sorted.

    ``words`` are types or packages; none for all of the user's own types.

    Raises:
        UnknownType: There is no such type or package, or the user has no own types.
        InvalidFile: A .lcm file is wrong.
    """
    own = type_files()
    names: set[str] = set()
    enums = set() if words else {*enum_names()}
    for word in words or own:
        held = {one for one in enum_names() if word in (one, one.rpartition("/")[0])}
        enums |= held
        if not held or word in packages():
            _add_parts([word] if word in own else _named(word), names)
    if not names and not enums:
        raise UnknownType("there are no types of your own", "name types, or set LCMTOOLS_TYPE_PATH")
    shipped = shipped_folder()
    kinds = [part.type for name in names for part in fields(message_class(name))]
    classes = [kind.cls for kind in kinds if isinstance(kind, EnumType)]
    files = {Path(cls.__file__) for cls in (*classes, *map(enum_class, enums))}
    return sorted(files | {Path(own.get(name) or shipped / f"{name}.lcm") for name in names})


def source_file(kind: type[Message]) -> str:
    """Return the path of a message type's file, a .lcm or ROS file."""
    name = type_name(kind)
    return type_file(name, fingerprint(kind)) or f"{shipped_folder() / name}.lcm"


def source_text(kind: type[Message]) -> str:
    """Return the content of a message type's file, as its author wrote it."""
    return read_source(source_file(kind), type_name(kind))


def type_comments(kind: type[Message]) -> "dict[str, Comment]":
    """Return the comments on a type in its file, by field; see ``placed_type.comments``."""
    from lcmtools.packages.placed_type import comments

    name, file = type_name(kind), source_file(kind)
    package = "" if file.endswith(".lcm") else name.rpartition("/")[0]
    return comments(LcmFile(file, read_source(file, name).encode(), package), name)


def read_source(file: str, name: str) -> str:
    """Return the content of the file that defines a type."""
    what = f"cannot read {file}, which defines {name}"
    return read_text(Path(file), what=what, kind=LcmtoolsError).strip()


def package_messages(
    module: str, *places: str | Path
) -> Callable[[str], type[Message | ServiceType | EnumValue] | list[str]]:
    """Return the ``__getattr__`` of air_lab0/msg, for ``from air_lab0.msg import Stat``.

    In air_lab0/srv it returns services: ``from air_lab0.srv import Drive``, ``Drive.Request``.

    Args:
        module: The module's ``__name__``: "air_lab0.msg".
        places: Its ``__file__``, or folders, whose workspaces are searched wherever the program
            was started.
    """
    package = module.rpartition(".")[0] or module

    def find(name: str) -> type[Message | ServiceType | EnumValue] | list[str]:
        if name.startswith("_") and name != "__all__":
            raise AttributeError(f"module '{module}' has no attribute '{name}'")
        for place in map(Path, places):
            folder = place.resolve()
            user_types().add_start(folder if folder.is_dir() else folder.parent)
        if name == "__all__":
            return python_names_in(package)
        own = name.rstrip("_")  # of a type "pass", which is imported as "pass_"
        is_spelled = python_name(own) == name and f"{package}/{name}" not in type_names()
        named = f"{package}/{own if is_spelled else name}"
        try:
            if named in service_names():
                return service_class(named)
            return enum_class(named) if named in enum_names() else message_class(named)
        except UnknownType as error:
            raise AttributeError(str(error)) from None

    return find


def python_names_in(package: str) -> list[str]:
    """Return the messages, services and enums of a package by their names in Python."""
    names = (*type_names(), *service_names(), *enum_names())
    known = (one.rpartition("/") for one in names)
    return [python_name(short) for of, _, short in known if of == package]


def _named(word: str) -> list[str]:
    """Return the types of a package, or the one with this name."""
    of_package = [name for name in type_names() if name.startswith(f"{word}/")]
    try:
        return of_package or [type_name(message_class(word))]
    except UnknownType:
        near = did_you_mean(word, packages())
        if "/" in word or not near:
            raise
        raise UnknownType(f"there is no package '{word}'", near) from None


def _add_parts(names: Iterable[str], known: set[str]) -> None:
    """Add types and the types of their fields."""
    for name in names:
        if name not in known:
            known.add(name)
            parts = (part.message_class for part in fields(message_class(name)))
            _add_parts((type_name(cls) for cls in parts if cls), known)
