"""``lcmtools pkg list``, ``find`` and ``build``."""

from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.msg.build import build_folders
from lcmtools.cli.options import json_option
from lcmtools.cli.output import columns, show, talk
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.names import did_you_mean
from lcmtools.packages.nodes import OWN, installed_packages, runnables
from lcmtools.packages.workspace import workspace


@subcommand("list")
@json_option
def list_packages(*, as_json: bool) -> None:
    """List the packages of the workspace and those that are installed, with their folders.

    The workspace is the nearest folder, from the current one upwards, that holds packages.

    \b
    Examples:
      lcmtools pkg list
      lcmtools pkg list --json
    """
    found = _folders()
    for problem in workspace(Path.cwd()).problems:
        talk(str(problem), "lcmtools pkg list")
    known = runnables(Path.cwd()) if as_json else []
    record = [
        {
            "name": name,
            "folder": str(folder),
            "is_installed": is_installed,
            "nodes": [node.name for node in known if node.package == name],
        }
        for name, (folder, is_installed) in found.items()
    ]
    rows = [(name, str(folder)) for name, (folder, _) in found.items()]
    show(record, columns(rows), as_json=as_json)


@subcommand("find")
@argument("name", completer="programs:packages")
@json_option
def find_command(name: str, *, as_json: bool) -> None:
    """Print the folder of a package.

    \b
    Examples:
      lcmtools pkg find air_lab0
      lcmtools pkg prefix air_lab0 --json
    """
    found = _folders()
    if name not in found:
        raise unknown_package(name, found)
    folder, is_installed = found[name]
    record = {"name": name, "folder": str(folder), "is_installed": is_installed}
    show(record, [str(folder)], as_json=as_json)


def unknown_package(name: str, known: Iterable[str]) -> UsageError:
    """Return the error of a package that does not exist."""
    problems = workspace(Path.cwd()).problems
    hint = did_you_mean(name, list(known)) or (str(problems[0]) if problems else "")
    return UsageError(f"there is no package '{name}'", hint or "lcmtools pkg list shows them")


def _folders() -> dict[str, tuple[Path, bool]]:
    """Every package's folder, and True if it is installed; the workspace's before installed."""
    found = {one: (place, True) for one in installed_packages() if (place := _installed(one))}
    found |= {one.name: (one.folder, False) for one in workspace(Path.cwd()).packages}
    return dict(sorted(found.items()))


def _installed(name: str) -> Path | None:
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):
        return None
    places = (spec and spec.submodule_search_locations) or ()
    return next(iter(map(Path, places)), None) if name != OWN else Path(__file__).parents[2]


@subcommand("build")
@argument("name", required=False, completer="programs:packages")
@json_option
def build(name: str | None, *, as_json: bool) -> int:
    """Check and compile the messages of the workspace's packages, or of one.

    This step is optional, because messages are compiled when they are first used. The exit code is
    1 if there are errors.

    \b
    Examples:
      lcmtools pkg build
      lcmtools pkg build air_lab0
    """
    found = workspace(Path.cwd()).packages
    chosen = [one for one in found if name in (None, one.name)]
    if not chosen and name:
        raise unknown_package(name, (one.name for one in found))
    if not chosen:
        raise LcmtoolsError("there is no package here", "lcmtools pkg create NAME makes one")
    code = build_folders([one.folder for one in chosen], as_json=as_json)
    if code == 0:
        talk(f"ready: {', '.join(one.name for one in chosen)}")
    return code
