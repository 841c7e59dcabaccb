"""Finding the node that a user means by one or two words.

Belongs here: precedence, and the reasons why there is no such node. A node of the workspace takes
precedence over lcmtools' own, which does over those of installed packages and noted workspaces. An
undeclared file with its name is never ignored silently.
"""

import re
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.folders import read_bytes
from lcmtools.messages.type_source import shown
from lcmtools.names import did_you_mean
from lcmtools.packages.cpp_nodes import has_cpp_main
from lcmtools.packages.runnable_nodes import (
    ANSWERS,
    OWN,
    TABLE,
    Runnable,
    entry,
    installed_packages,
)
from lcmtools.packages.type_files import module_folders
from lcmtools.packages.workspace import Package, package_folders, workspace

_MAIN = re.compile(r"^(async )?def main\b|^main\b.*=", re.MULTILINE)


def find_node(
    words: Sequence[str], known: Sequence[Runnable], *starts: Path
) -> tuple[Runnable, list[str]]:
    """Return the node for ``PACKAGE NODE ...`` or ``NODE ...``, and the words after it.

    Raises:
        UsageError: There is no such node, or several packages have it, or a file of that name in
            the workspaces of ``starts`` is not declared as a node.
    """
    try:
        node, rest = _named(words, known)
    except UsageError as error:
        if file := undeclared(words, known, starts):
            raise file from None
        for problem in workspace(*starts).problems:  # the missing node may be in that package
            raise UsageError(error.what, str(problem)) from error
        raise
    is_alone = words[0] == node.name and node.folder is None
    if is_alone and (file := undeclared(words[:1], known, starts, with_main=True)):
        raise file
    return node, rest


def has_main(file: Path) -> bool:
    """Return True if a source in Python or C++ has a function main."""
    if file.suffix != ".py":
        return has_cpp_main(file)
    try:
        return bool(_MAIN.search(read_bytes(file).decode("utf-8", "replace")))
    except LcmtoolsError:
        return False


def own_answer(node: Runnable) -> str:
    """Return a sentence if lcmtools' solution runs where a user may mean their own; else ""."""
    is_answer = node.package == OWN and node.name in ANSWERS
    return f"this is lcmtools' own {node.name}, the lab's model answer" if is_answer else ""


def _named(words: Sequence[str], known: Sequence[Runnable]) -> tuple[Runnable, list[str]]:
    first, rest = words[0], list(words[1:])
    of_package = {node.name: node for node in known if node.package == first}
    named = [node for node in known if node.name == first]
    for word in (rest[0], rest[0].removesuffix(".py")) if rest else ():
        if word in of_package:
            return of_package[word], rest[1:]
    if of_package and not named:
        wrong = rest[0] if rest else ""
        is_own = any(node.folder for node in of_package.values())
        adding = "; lcmtools pkg add-node NAME adds one" if is_own else ""
        hint = did_you_mean(wrong, of_package) or f"it has {', '.join(of_package)}{adding}"
        raise UsageError(f"the package {first} has no node '{wrong}'", hint)
    own = [node for node in named if node.package == OWN]
    chosen = [node for node in named if node.is_near] or own or named
    if len(chosen) > 1:
        hint = " or ".join(f"{node.package} {node.name}" for node in chosen)
        raise UsageError(f"several packages have a node '{first}'", f"write {hint}")
    if chosen:
        return chosen[0], rest
    raise _unknown(first, rest, known)


def undeclared(
    words: Sequence[str],
    known: Sequence[Runnable],
    starts: Sequence[Path],
    *,
    with_main: bool = False,
) -> UsageError | None:
    """Return the error for a file that exists but is not declared as a node, else None."""
    space = workspace(*starts)
    packages = {package.folder: package for package in space.packages}
    named = [folder for folder, package in packages.items() if package.name == words[0]]
    for folder in dict.fromkeys((*package_folders(*starts), *named)):
        package = packages.get(folder)
        is_named = package is not None and package.name == words[0]
        word = words[1] if is_named and len(words) > 1 else words[0]
        name = word.removesuffix(".py")
        if not name.isidentifier():
            continue
        python = (*folder.glob(f"*/{name}.py"), *folder.glob(f"src/*/{name}.py"))
        for file in (*python, *folder.glob(f"src/{name}.cpp")):
            is_complete = has_main(file)
            if with_main and not is_complete:
                continue
            if package is None:
                problem = next((p for p in space.problems if str(folder) in str(p)), "")
                return UsageError(f"{shown(file)} is not a node yet", str(problem))
            node = Runnable(package.name, name, "", folder)
            is_module = file.suffix == ".py" and file.parent.name != package.name
            if not is_module and not _is_known(node, known):
                hint = _declaring(node, folder, file, is_complete=is_complete)
                return UsageError(f"{shown(file)} is not a node yet", hint)
    return None


def _declaring(node: Runnable, folder: Path, file: Path, *, is_complete: bool) -> str:
    if file.suffix != ".py":
        return f"type: lcmtools pkg add-node {file.name}" if is_complete else "it has no main"
    main = "" if is_complete else "give it a function main(args=None), and "
    hint = f"{main}write  {entry(node)}  in {TABLE} of {shown(folder)}/pyproject.toml"
    return hint + (f", or type: lcmtools pkg add-node {node.name}" if is_complete else "")


def _is_known(node: Runnable, known: Sequence[Runnable]) -> bool:
    return any((one.package, one.name) == (node.package, node.name) for one in known)


def _unknown(first: str, rest: Sequence[str], known: Iterable[Runnable]) -> UsageError:
    names = {node.name for node in known}
    packages = {node.package for node in known}
    hint = did_you_mean(first, names | packages) or "lcmtools run --list shows them"
    if rest and rest[0] in names:
        homes = [node.package for node in known if node.name == rest[0]]
        typed = rest[0] if OWN in homes else f"{homes[0]} {rest[0]}"
        verb = "have" if homes[1:] else "has"
        other = f"{' and '.join(homes)} {verb} such a node: lcmtools run {typed}"
        near = did_you_mean(first, packages) or other
        return UsageError(f"there is no package '{first}'", near)
    if Path(f"{first}.py").is_file():
        hint = f"a file is run with its suffix: lcmtools run {first}.py"
    may_be_package = bool(rest) and rest[0].removesuffix(".py").isidentifier()
    kind = "file" if "/" in first else "package or node" if may_be_package else "node"
    return UsageError(f"there is no {kind} '{first}'", hint)


def package_places(here: Path) -> dict[str, tuple[Path, bool]]:
    """Return each package's folder, and True if it is installed; those around ``here`` first."""
    found = {
        name: (place, True) for name in installed_packages() for place in module_folders(name)[:1]
    }
    found |= {one.name: (one.folder, False) for one in workspace(here).packages}
    return dict(sorted(found.items()))


def find_packages(name: str | None, here: Path) -> list[Package]:
    """Return the one package with this name; for None those around ``here``, else all.

    Raises:
        UsageError: There is none with this name.
        LcmtoolsError: There is none at all.
    """
    known = workspace(here).packages
    near = [one for one in known if not one.is_noted] or known
    found = [one for one in known if one.name == name] if name else near
    if not found and name:
        raise unknown_package(name, [one.name for one in known], here)
    if not found:
        raise LcmtoolsError("there is no package here", "lcmtools pkg create NAME makes one")
    return found


def find_package(name: str | None, here: Path) -> Package:
    """Return the package with a name; for None the one around ``here``, or the only one.

    Raises:
        UsageError: There is none with this name, or there are several.
        LcmtoolsError: There is none at all.
    """
    found = find_packages(name, here)
    inside = [one for one in found if here.is_relative_to(one.folder)] or found
    if len(inside) > 1:
        names = ", ".join(one.name for one in inside)
        raise UsageError(f"several packages are here: {names}", "choose one by --package")
    return inside[0]


def unknown_package(name: str, known: Collection[str], here: Path) -> UsageError:
    """Return the error for a package that does not exist."""
    problems = workspace(here).problems
    hint = did_you_mean(name, known) or (str(problems[0]) if problems else "")
    return UsageError(f"there is no package '{name}'", hint or "lcmtools pkg list shows them")
