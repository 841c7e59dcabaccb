"""Nodes that can be run by name, from installed packages or from the workspace, uninstalled.

Belongs here: listing nodes and importing one. A node is an entry point "lcmtools.nodes", either of
a distribution or in the pyproject.toml of a workspace package, or an executable that such a package
builds. Must not know the command line.
"""

import importlib
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, cast

from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.folders import read_bytes
from lcmtools.packages.cpp_nodes import cpp_sources, cpp_summary
from lcmtools.packages.ros_modules import provide_type_modules
from lcmtools.packages.type_files import GROUPS
from lcmtools.packages.workspace import Package, read_project, table, workspace
from lcmtools.ros_words import python_names

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "lcmtools.nodes"
"""The entry points that are nodes; any installed package can add its own."""
OWN = "lcmtools"
"""The package of lcmtools' own nodes."""
ANSWERS = (
    *("evaluate_controller", "kinect_viewer", "moving_robot", "path_follower"),
    *("pioneer_manual_controller", "reading_laser", "simple_controller"),
)
"""Those of lcmtools' own nodes that students write themselves in a lab."""

TABLE = f'[project.entry-points."{GROUP}"]'
"""The table of a pyproject.toml that declares a package's nodes."""

_DISTRIBUTIONS = {"cv2": "opencv-python", "PIL": "pillow", "serial": "pyserial", "yaml": "PyYAML"}
"""The PyPI projects of packages that nodes often need, if their names differ."""
_TARGET = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*", re.ASCII)


NodeProgram: TypeAlias = Callable[..., int | None]
"""A node's main function; it takes its arguments or nothing; returns an exit code, None for 0."""


@dataclass(frozen=True, slots=True)
class Runnable:
    """A node that can be run."""

    package: str
    name: str
    target: str  # its main function, as "module:function"
    folder: Path | None = None  # the folder its code is imported from; None if installed
    is_noted: bool = False  # True for a package of a noted workspace
    source: Path | None = None  # its source if it is a program in C++, which has no main function

    @property
    def is_near(self) -> bool:
        """True for a package of the workspace around the current folder."""
        return self.folder is not None and not self.is_noted

    @property
    def import_name(self) -> str:
        """The Python package or module of its code."""
        return re.split(r"[.:]", self.target)[0]

    def summary(self) -> str:
        """Return the first line of its module's docstring, read without importing it, or ""."""
        if self.source:
            return cpp_summary(self.source)
        import ast

        top, *rest = self.target.partition(":")[0].split(".")
        try:
            spec = PathFinder.find_spec(top, [str(self.folder)]) if self.folder else find_spec(top)
            if spec is None or spec.origin is None:
                return ""
            place = Path(spec.origin).parent.joinpath(*rest)
            files = (
                (place.with_suffix(".py"), place / "__init__.py") if rest else [Path(spec.origin)]
            )
            text = next((read_bytes(file) for file in files if file.is_file()), b"")
            return (ast.get_docstring(ast.parse(text)) or "").partition("\n")[0].strip()
        except (ImportError, LcmtoolsError, SyntaxError, ValueError):  # running it reports it
            return ""

    def load(self) -> NodeProgram:
        """Import its main function; from then on, other workspace packages can be imported too.

        Raises:
            LcmtoolsError: Its module or function does not exist.
            MissingExtra: It needs a package that is not installed.
            Exception: Its own code fails when it is imported.
        """
        if self.folder is not None and not _TARGET.fullmatch(self.target):
            raise self._lost(f"'{self.target}' is not a function", f"write  {entry(self)}  in")
        if self.package != OWN:
            provide_imports(self.folder)
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
            hint = f"write def {path}(args=None): in it, or see"
            raise self._lost(f"{module} has no function '{path}'", hint)
        return cast("NodeProgram", value)

    def traceback(self, error: BaseException) -> str:
        """Return the traceback of an error in the node's code, without lcmtools' part."""
        from traceback import format_exception

        frames, is_own = error.__traceback__, re.compile(rf"{self.import_name}\b").match
        while frames and not is_own(str(frames.tb_frame.f_globals.get("__name__", ""))):
            frames = frames.tb_next
        return "".join(format_exception(type(error), error, frames, chain=False))

    def _check_installed(self, error: ModuleNotFoundError) -> None:
        """Raise the error for a missing package, unless it is one of the node's own modules."""
        package, point, _ = (error.name or "").partition(".")
        if own := in_place_of_ros(error.name or ""):
            raise LcmtoolsError(f"{self.name} imports '{error.name}', as in ROS", own) from error
        if not point or package not in (OWN, self.import_name):
            raise MissingExtra(
                f"{self.name} needs the Python package '{error.name}', which is not installed",
                f"type: pip install {_DISTRIBUTIONS.get(package, package)}",
            ) from error

    def _lost(self, what: str, hint: str = "see") -> LcmtoolsError:
        hint = f"{hint} {TABLE} of its pyproject.toml"
        return LcmtoolsError(f"the node '{self.name}' of {self.package}: {what}", hint)


def in_place_of_ros(module: str) -> str:
    """Return a hint about the replacement for a ROS module; "" for other modules."""
    name = module.removeprefix("lcmtools.types.").partition(".")[0]
    if name in python_names.MODULES:
        return "here it is lcmtools: import lcmtools"
    if module != f"lcmtools.types.{name}" and find_spec(f"lcmtools.types.{name}"):
        return f"here it is lcmtools.types.{name}"
    return ""


def runnables(*starts: Path) -> list[Runnable]:
    """Return all nodes that can be run, sorted by package; the workspace's come first."""
    from importlib.metadata import entry_points

    found: dict[tuple[str, str], Runnable] = {}
    space = workspace(*starts)
    names = {package.name for package in space.packages}
    for package in space.packages:
        for node in workspace_nodes(package):
            found[node.package, node.name] = node
    for entry in entry_points(group=GROUP):
        node = Runnable(_package_of(entry), entry.name, entry.value)
        if node.package not in names:
            found[node.package, node.name] = node
    return [found[key] for key in sorted(found)]


def fixed_nodes() -> frozenset[str]:
    """Return the names of lcmtools' own nodes, without those that students write themselves."""
    from importlib.metadata import entry_points

    own = (entry.name for entry in entry_points(group=GROUP) if _package_of(entry) == OWN)
    return frozenset(own) - frozenset(ANSWERS)


def installed_packages() -> list[str]:
    """Return the installed packages that have nodes or messages, sorted."""
    from importlib.metadata import entry_points

    found = (entry for group in GROUPS for entry in entry_points(group=group))
    return sorted({_package_of(entry) for entry in found})


def workspace_nodes(package: Package) -> list[Runnable]:
    """Return the nodes in a package's pyproject.toml and its CMakeLists.txt.

    A wrong one raises when it is loaded or built.
    """
    named = table(read_project(package.folder), "project", "entry-points", GROUP)
    folder = package.import_folder()
    nodes = [
        Runnable(package.name, name, str(target), folder, package.is_noted)
        for name, target in named.items()
    ]
    return nodes + [
        Runnable(package.name, name, "", package.folder, package.is_noted, source)
        for name, source in cpp_sources(package.folder).items()
        if name not in named
    ]


def entry(node: Runnable) -> str:
    """Return the line of a package's pyproject.toml that declares a node."""
    return f'{node.name} = "{node.package}.{node.name}:main"'


def provide_imports(folder: Path | None) -> None:
    """Let a user's code import the packages around its folder and ROS's modules of types."""
    if folder is not None:
        _make_importable(folder)
    provide_type_modules(*filter(None, [folder]), Path.cwd())


def _make_importable(folder: Path) -> None:
    from lcmtools.packages.user_types import user_types

    user_types().add_start(folder)
    if str(folder) not in sys.path[:1]:
        sys.path.insert(0, str(folder))
    for package in workspace(folder, Path.cwd()).packages:
        if str(package.import_folder()) not in sys.path:
            sys.path.append(str(package.import_folder()))


def _package_of(entry: "EntryPoint") -> str:
    module = entry.module.partition(".")[0]
    return OWN if module in (OWN, "lcmtools_sim") else module
