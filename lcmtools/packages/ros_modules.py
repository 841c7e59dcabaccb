"""The modules of message types for nodes that lcmtools runs, as ROS and lcm-gen have them.

``nav_msgs.msg``, or ``nav_msgs`` itself. Belongs here: Python's finders of modules for these names.
A module of the user's own, with code, takes precedence. Must not know which types a package has.
"""

import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from threading import RLock
from types import ModuleType

_PARTS = ("msg", "srv")


class _TypeModules(MetaPathFinder):
    """Finds ``air_lab0.msg``; it comes first, as Python takes a folder msg without code for one."""

    def __init__(self, packages: "_TypePackages") -> None:
        self._packages = packages

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the module of a package's types, unless it has one with code."""
        package, _, part = name.rpartition(".")
        if not package or part not in _PARTS:
            return None
        own = PathFinder.find_spec(name, path, target)
        if (own and own.has_location) or package not in self._packages.names:
            return None
        spec = ModuleSpec(name, self._packages, is_package=True)
        spec.submodule_search_locations = list((own and own.submodule_search_locations) or ())
        return spec


class _TypePackages(MetaPathFinder, Loader):
    """Finds a package that has types only (``nav_msgs``); it comes last."""

    def __init__(self, starts: Sequence[Path]) -> None:
        self._starts = starts
        self._names: dict[str, str] | None = None
        self._one_at_a_time = RLock()

    @property
    def names(self) -> dict[str, str]:
        """The packages of types, and those above them, by their names in Python.

        Finding them reads the user's type files.
        """
        with self._one_at_a_time:
            if self._names is None:
                self._names = {}  # finding installed packages asks this finder, too
                self._names = self._find_names()
            return self._names

    def _find_names(self) -> dict[str, str]:
        from lcmtools.messages.python_names import python_path
        from lcmtools.messages.registry import shipped_types
        from lcmtools.packages.user_types import user_types
        from lcmtools.packages.workspace import workspace

        for start in self._starts:
            user_types().add_start(start)
        found = {name.rpartition("/")[0] for name in shipped_types().fingerprints}
        found |= {package.name for package in workspace(*self._starts).packages}
        found |= user_types().declared_packages()
        above = {name[:end] for name in found for end, one in enumerate(name) if one == "."}
        return {python_path(name): name for name in found | above}

    def find_spec(
        self, name: str, _path: Sequence[str] | None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the package for a package of types; ImportError for what such a one lacks."""
        above, _, short = name.rpartition(".")
        if above and _has_code(above):
            return None
        if name in self.names:
            return ModuleSpec(name, self, is_package=True)
        if self._package(above) is not None:
            raise ImportError(self._missing(above, short), name=above)
        return None

    def exec_module(self, module: ModuleType) -> None:
        """Let the module find types when they are imported from it."""
        from lcmtools.packages.user_types import package_messages

        package = f"{self._package(module.__name__)}.msg"
        vars(module)["__getattr__"] = package_messages(package, *self._starts)

    def _package(self, module: str) -> str | None:
        """Return the package whose types are in a module; None for another module."""
        package, _, part = module.rpartition(".")
        return self.names.get(package if package and part in _PARTS else module)

    def _missing(self, module: str, short: str) -> str:
        """Return the text of the error for a name that a module of types lacks."""
        from lcmtools.names import did_you_mean
        from lcmtools.packages.user_types import python_names_in

        known = python_names_in(self._package(module) or "")
        if module in self.names:
            known = [*_PARTS, *known]
        hint = did_you_mean(short, known) or f"it has {', '.join(known) or 'no types'}"
        return f"cannot import name '{short}' from '{module}': {hint}"


def provide_type_modules(*starts: Path) -> None:
    """Let ``import nav_msgs.msg`` work, also for the user's own packages of types.

    These are in the workspaces of the folders, and wherever ``user_types`` looks.
    """
    packages = _TypePackages(starts)
    sys.meta_path.insert(0, _TypeModules(packages))
    sys.meta_path.append(packages)


def _has_code(module: str) -> bool:
    spec = getattr(sys.modules.get(module), "__spec__", None)
    return spec is None or spec.has_location
