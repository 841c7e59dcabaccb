"""The packages that the verbs of ``lcmtools pkg`` speak of.

Belongs here: from a name that was typed to a package, of the workspace or installed.
"""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean
from lcmtools.packages.nodes import OWN, installed_packages
from lcmtools.packages.workspace import Package, workspace


def workspace_packages() -> list[Package]:
    """The packages of the workspace; a problem with one of them stops no other."""
    return workspace(Path.cwd()).packages


def folders() -> dict[str, tuple[Path, bool]]:
    """Every package's folder, and whether it is installed; the workspace's before installed."""
    found = {one: (place, True) for one in installed_packages() if (place := _installed(one))}
    found |= {one.name: (one.folder, False) for one in workspace_packages()}
    return dict(sorted(found.items()))


def unknown(name: str, known: Sequence[str]) -> UsageError:
    """What to say where there is no such package."""
    problems = workspace(Path.cwd()).problems
    hint = did_you_mean(name, known) or (str(problems[0]) if problems else "")
    return UsageError(f"there is no package '{name}'", hint or "lcmtools pkg list shows them")


def _installed(name: str) -> Path | None:
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):
        return None
    places = (spec and spec.submodule_search_locations) or ()
    return next(iter(map(Path, places)), None) if name != OWN else Path(__file__).parents[2]
