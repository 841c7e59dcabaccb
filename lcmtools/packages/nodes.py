"""Nodes that can be run by name: of installed packages, and of the workspace without installing.

Belongs here: finding nodes and importing one. A node is an entry point "lcmtools.nodes": of a
distribution, or as a workspace package's pyproject.toml writes it. Must not know the command line.
"""

import importlib
import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import TracebackType
from typing import Protocol, cast

from lcmtools.errors import InvalidFile, LcmtoolsError, MissingExtra, UsageError
from lcmtools.names import did_you_mean
from lcmtools.packages.type_files import GROUPS
from lcmtools.packages.workspace import Package, Workspace, read_project, table, workspace

GROUP = "lcmtools.nodes"
"""The entry points that are nodes; any installed package can add its own."""
OWN = "lcmtools"
"""The package of lcmtools' own nodes."""

_TARGET = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*", re.ASCII)


class Program(Protocol):
    """A node's main function."""

    def __call__(self, args: Sequence[str] | None = None) -> int | None:
        """Run until the end; return an exit code, None for 0."""


@dataclass(frozen=True, slots=True)
class Runnable:
    """A node that can be run.

    Attributes:
        package: Its package's name.
        name: Its own name.
        target: Its main function, as "module:function".
        folder: The folder that its code is imported from; None for an installed package.
    """

    package: str
    name: str
    target: str
    folder: Path | None = None

    @property
    def import_name(self) -> str:
        """The Python package or module that its code is in."""
        return re.split(r"[.:]", self.target)[0]

    def load(self) -> Program:
        """Import its main function; other workspace packages can be imported from then on too.

        Raises:
            LcmtoolsError: Its module or function does not exist.
            MissingExtra: It needs a package that is not installed.
            Exception: Its own code fails when it is imported.
        """
        if self.folder is not None:
            sys.path.insert(0, str(self.folder))
            for package in workspace(self.folder, Path.cwd()).packages:
                if str(package.import_folder()) not in sys.path:
                    sys.path.append(str(package.import_folder()))
        module, _, path = self.target.partition(":")
        try:
            value: object = importlib.import_module(module)
        except ModuleNotFoundError as error:
            if self.folder is None or not f"{module}.".startswith(f"{error.name}."):
                self._check_installed(error)
                raise
            raise self._lost(f"there is no module {error.name}") from error
        for attribute in path.split("."):
            value = getattr(value, attribute, None)
        if not callable(value):
            raise self._lost(f"{module} has no function '{path}'")
        return cast("Program", value)

    def traceback(self, error: BaseException) -> str:
        """Return the traceback of an error in the node's code, without the part of lcmtools."""
        from traceback import format_exception

        frames = error.__traceback__
        while frames and not self._is_own(frames):
            frames = frames.tb_next
        return "".join(format_exception(type(error), error, frames, chain=False))

    def _is_own(self, frames: TracebackType) -> bool:
        module = str(frames.tb_frame.f_globals.get("__name__", ""))
        return module.partition(".")[0] == self.import_name

    def _check_installed(self, error: ModuleNotFoundError) -> None:
        """Raise MissingExtra for a package that the node needs; not for a module of its own."""
        package, point, _ = (error.name or "").partition(".")
        if not point or package not in (OWN, self.import_name):
            raise MissingExtra(
                f"{self.name} needs the Python package '{error.name}', which is not installed",
                f"type: pip install {error.name}",
            ) from error

    def _lost(self, what: str) -> LcmtoolsError:
        hint = f'see [project.entry-points."{GROUP}"] in its pyproject.toml'
        return LcmtoolsError(f"the node '{self.name}' of {self.package}: {what}", hint)


def runnables(*starts: Path) -> list[Runnable]:
    """All nodes that can be run, sorted by package; the workspace's before the installed one."""
    found: dict[tuple[str, str], Runnable] = {}
    space = workspace(*starts)
    names = {package.name for package in space.packages}
    for package in space.packages:
        for node in workspace_nodes(package, space):
            found[node.package, node.name] = node
    for entry in entry_points(group=GROUP):
        node = Runnable(_package_of(entry), entry.name, entry.value)
        if node.package not in names:
            found[node.package, node.name] = node
    return [found[key] for key in sorted(found)]


def installed_packages() -> list[str]:
    """The installed packages that have nodes or messages, sorted."""
    found = (entry for group in GROUPS for entry in entry_points(group=group))
    return sorted({_package_of(entry) for entry in found})


def workspace_nodes(package: Package, space: Workspace) -> list[Runnable]:
    """The nodes that a package's pyproject.toml names; a wrong one becomes a problem."""
    named = table(read_project(package.folder), "project", "entry-points", GROUP)
    nodes = []
    for name, target in named.items():
        if isinstance(target, str) and _TARGET.fullmatch(target):
            nodes.append(Runnable(package.name, name, target, package.import_folder()))
        else:
            hint = f'write  {name} = "{package.name}.{name}:main"'
            path = package.folder / "pyproject.toml"
            space.problems.append(InvalidFile(f"{path}: the node '{name}' is no function", hint))
    return nodes


def find_node(words: Sequence[str], known: Sequence[Runnable]) -> tuple[Runnable, list[str]]:
    """The node that ``PACKAGE NODE ...`` or ``NODE ...`` means, and the words after it.

    Raises:
        UsageError: There is no such node, or several packages have it.
    """
    first, rest = words[0], list(words[1:])
    of_package = {node.name: node for node in known if node.package == first}
    named = [node for node in known if node.name == first]
    if of_package and rest and rest[0] in of_package:
        return of_package[rest[0]], rest[1:]
    if of_package and not named:
        wrong = rest[0] if rest else ""
        hint = did_you_mean(wrong, of_package) or f"it has {', '.join(of_package)}"
        raise UsageError(f"the package {first} has no node '{wrong}'", hint)
    own = [node for node in named if node.package == OWN]
    if len(named) > 1 and not own:
        hint = " or ".join(f"{node.package} {node.name}" for node in named)
        raise UsageError(f"several packages have a node '{first}'", f"write {hint}")
    if named:
        return (own or named)[0], rest
    raise _unknown(first, rest, known)


def _unknown(first: str, rest: Sequence[str], known: Iterable[Runnable]) -> UsageError:
    names = {node.name for node in known}
    packages = {node.package for node in known}
    hint = did_you_mean(first, names | packages) or "lcmtools run --list shows them"
    if rest and rest[0] in names:
        homes = [node.package for node in known if node.name == rest[0]]
        near = did_you_mean(first, packages) or f"{' and '.join(homes)} has such a node"
        return UsageError(f"there is no package '{first}'", near)
    return UsageError(f"there is no node '{first}'", hint)


def _package_of(entry: EntryPoint) -> str:
    module = entry.module.partition(".")[0]
    return OWN if module in (OWN, "lcmtools_sim") else module
