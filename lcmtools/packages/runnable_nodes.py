"""Nodes that can be run by name, from installed packages or from the workspace, uninstalled.

Belongs here: listing nodes and importing one. A node is an entry point "lcmtools.nodes", either of
a distribution or in the pyproject.toml of a workspace package. Must not know the command line.
"""

import importlib
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, TypeAlias, cast

from lcmtools.errors import LcmtoolsError, MissingExtra
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

    @property
    def import_name(self) -> str:
        """The Python package or module of its code."""
        return re.split(r"[.:]", self.target)[0]

    def summary(self) -> str:
        """Return the first line of its module's docstring, read without importing it, or ""."""
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
            text = next((file.read_bytes() for file in files if file.is_file()), b"")
            return (ast.get_docstring(ast.parse(text)) or "").partition("\n")[0].strip()
        except (ImportError, OSError, SyntaxError, ValueError):  # running it will report the error
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
        if self.folder is not None:
            _make_importable(self.folder)
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


def _provide_messages(package: Package) -> None:
    """Let ``from air_lab0.msg import Stat`` work if a package has no such module itself."""
    from lcmtools.packages.user_types import package_messages

    for part in ("msg", "srv"):
        place = package.import_folder() / package.name / part
        if not ((place / "__init__.py").is_file() or place.with_suffix(".py").is_file()):
            module = ModuleType(f"{package.name}.{part}")
            find = package_messages(module.__name__, str(package.folder / part))
            vars(module)["__getattr__"] = find
            sys.modules.setdefault(module.__name__, module)


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


def installed_packages() -> list[str]:
    """Return the installed packages that have nodes or messages, sorted."""
    from importlib.metadata import entry_points

    found = (entry for group in GROUPS for entry in entry_points(group=group))
    return sorted({_package_of(entry) for entry in found})


def workspace_nodes(package: Package) -> list[Runnable]:
    """Return the nodes in a package's pyproject.toml; a wrong one raises when it is loaded."""
    named = table(read_project(package.folder), "project", "entry-points", GROUP)
    folder = package.import_folder()
    return [Runnable(package.name, name, str(target), folder) for name, target in named.items()]


def entry(node: Runnable) -> str:
    """Return the line of a package's pyproject.toml that declares a node."""
    return f'{node.name} = "{node.package}.{node.name}:main"'


def _make_importable(folder: Path) -> None:
    sys.path.insert(0, str(folder))
    for package in workspace(folder, Path.cwd()).packages:
        if str(package.import_folder()) not in sys.path:
            sys.path.append(str(package.import_folder()))
        _provide_messages(package)


def _package_of(entry: "EntryPoint") -> str:
    module = entry.module.partition(".")[0]
    return OWN if module in (OWN, "lcmtools_sim") else module
