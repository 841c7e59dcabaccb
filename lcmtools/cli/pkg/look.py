"""``lcmtools pkg list``, ``find`` and ``build``."""

from collections.abc import Iterable
from pathlib import Path

from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.msg.build import build_folders
from lcmtools.cli.options import json_option
from lcmtools.cli.output import columns, show, talk
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.names import did_you_mean
from lcmtools.packages.nodes import OWN, installed_packages, runnables
from lcmtools.packages.type_files import module_folders
from lcmtools.packages.workspace import Package, workspace


@subcommand("list", json_option)
@examples("pkg list", "pkg list --json")
def list_packages(*, as_json: bool) -> None:
    """List the packages of the workspace and those that are installed, with their folders.

    The workspace is the nearest folder, from the current one upwards, that holds packages.
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


@subcommand("find", json_option)
@examples("pkg find air_lab0", "pkg prefix air_lab0 --json")
@argument("name", completer="programs:packages")
def find_command(name: str, *, as_json: bool) -> None:
    """Print the folder of a package."""
    found = _folders()
    if name not in found:
        raise unknown_package(name, found)
    folder, is_installed = found[name]
    record = {"name": name, "folder": str(folder), "is_installed": is_installed}
    show(record, [str(folder)], as_json=as_json)


def chosen_package(name: str | None) -> Package:
    """Return a package of the workspace by its name; for None, that of the current folder.

    Raises:
        UsageError: There is no such package, or there are several.
        LcmtoolsError: There is none at all.
    """
    found = workspace(Path.cwd()).packages
    if name is None:
        inside = [one for one in found if Path.cwd().is_relative_to(one.folder)] or found
        if len(inside) > 1:
            names = ", ".join(one.name for one in inside)
            raise UsageError(f"several packages are here: {names}", "choose one by --package")
        if not inside:
            raise _no_package()
        return inside[0]
    for one in found:
        if one.name == name:
            return one
    raise unknown_package(name, (one.name for one in found))


def _no_package() -> LcmtoolsError:
    return LcmtoolsError("there is no package here", "lcmtools pkg create NAME makes one")


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
    return next(iter(module_folders(name)), None) if name != OWN else Path(__file__).parents[2]


@subcommand("build", json_option)
@examples("pkg build", "pkg build air_lab0")
@argument("name", required=False, completer="programs:packages")
def build(name: str | None, *, as_json: bool) -> int:
    """Check and compile the messages of the workspace's packages, or of one.

    This step is optional, because messages are compiled when they are first used. The exit code is
    1 if there are errors.
    """
    found = workspace(Path.cwd()).packages
    chosen = [one for one in found if name in (None, one.name)]
    if not chosen and name:
        raise unknown_package(name, (one.name for one in found))
    if not chosen:
        raise _no_package()
    code = build_folders([one.folder for one in chosen], as_json=as_json)
    if code == 0:
        talk(f"ready: {', '.join(one.name for one in chosen)}")
    return code
