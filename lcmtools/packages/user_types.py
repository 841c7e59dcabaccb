"""The types of users' own, looked for when somebody asks.

Belongs here: which folders count, in which order, and when to look again. Must not know how types
are made or used.

Near are LCMTOOLS_TYPE_PATH and the workspace: they count before what lcmtools brings, because they
are what somebody is working on. Far are installed packages: they count last, and are only looked at
for a type that is not known otherwise, because finding them takes a moment.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from lcmtools.packages.source import Problem, TypeSource
from lcmtools.packages.type_files import (
    VARIABLE,
    installed_folders,
    read_folders,
    variable_folders,
)
from lcmtools.packages.workspace import package_folders

_NEAR_AGAIN = 1.0
_FAR_AGAIN = 10.0
"""Seconds after which files are looked at again: they may be edited while a command runs."""


@dataclass(slots=True)
class _Look:
    """What was last found, when, and by which words."""

    time: float = float("-inf")
    said: object = None
    source: TypeSource | None = None


class UserTypes:
    """The types of one process's user.

    Args:
        environment: LCMTOOLS_TYPE_PATH, and where the cache is.
        starts: The folders whose workspaces count now.
        shipped: The types that lcmtools brings, with their fingerprints.
        clock: Seconds, from anywhere on.
    """

    def __init__(
        self,
        environment: Mapping[str, str],
        starts: Callable[[], Sequence[Path]],
        shipped: Mapping[str, int],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._environment = environment
        self._starts = starts
        self._more_starts: list[Path] = []
        self._shipped = shipped
        self._clock = clock
        self._near = _Look()
        self._far = _Look()

    def near(self) -> TypeSource | None:
        """The types of LCMTOOLS_TYPE_PATH and of the workspace; None where there is none."""
        return self._look(self._near, _NEAR_AGAIN, self.near_folders)

    def far(self) -> TypeSource | None:
        """These and the types of installed packages."""
        return self._look(self._far, _FAR_AGAIN, self.far_folders)

    def compiled(self, folders: Sequence[Path]) -> TypeSource:
        """The types of some folders, and of the others that theirs may be made of."""
        return self._read([*folders, *self.far_folders()]) or TypeSource("", {})

    def near_folders(self) -> list[Path]:
        """The folders that count before what lcmtools brings."""
        return [*variable_folders(self._environment), *package_folders(*self._all_starts())]

    def far_folders(self) -> list[Path]:
        """All folders, installed packages last."""
        return [*self.near_folders(), *installed_folders()]

    def add_start(self, folder: Path) -> None:
        """Let the workspace of one more folder count."""
        if folder not in self._more_starts:
            self._more_starts.append(folder)

    def _all_starts(self) -> list[Path]:
        return [*self._starts(), *self._more_starts]

    def _look(
        self, look: _Look, again: float, folders: Callable[[], Sequence[Path]]
    ) -> TypeSource | None:
        said = self._environment.get(VARIABLE), self._all_starts()
        if said != look.said or self._clock() - look.time >= again:
            look.source = self._read(folders())
            look.time, look.said = self._clock(), said
        return look.source

    def _read(self, folders: Sequence[Path]) -> TypeSource | None:
        found = read_folders(folders)
        if not found.files:
            return _only_problems(found.problems)
        from lcmtools.packages.cache import cached_types

        source = cached_types(found.files, self._environment, self._shipped)
        return replace(source, problems=[*found.problems, *source.problems])


def _only_problems(problems: Sequence[Problem]) -> TypeSource | None:
    return TypeSource("", {}, problems=problems) if problems else None
