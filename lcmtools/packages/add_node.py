"""Adding a node to a package: its file, and the line in pyproject.toml that declares it.

Belongs here: what is written, and that nothing else in the package changes.
"""

import re
from pathlib import Path

from lcmtools.errors import LcmtoolsError, UsageError, os_errors_as
from lcmtools.folders import write_whole
from lcmtools.messages.type_source import shown
from lcmtools.packages.create import check_node_name, node_text
from lcmtools.packages.finding import has_main
from lcmtools.packages.runnable_nodes import GROUP, TABLE, Runnable, entry, workspace_nodes
from lcmtools.packages.workspace import Package, load_toml, read_project, table

_HEADER = re.compile(r'\s*\[\s*project\s*\.\s*entry-points\s*\.\s*["\']lcmtools\.nodes["\']\s*\]')


def add_node(
    package: Package, name: str, text: str | None = None, *, replace: bool = False
) -> list[Path]:
    """Add a node to a package; return the written files. An existing file is only declared.

    Without ``text`` the file gets the text of a new package's node. With ``replace`` the new node
    replaces an existing one.

    Raises:
        InvalidName: A name breaks a rule.
        UsageError: The node exists already, or there is a file that cannot be a node.
        LcmtoolsError: A file cannot be read or written.
    """
    check_node_name(name)
    file = package.import_folder() / package.name / f"{name}.py"
    is_declared = any(node.name == name for node in workspace_nodes(package))
    if file.exists() and not replace:
        if text is not None:
            raise UsageError(f"{shown(file)} already exists", "--force overwrites it")
        if is_declared:
            raise UsageError(f"{package.name} has a node '{name}' already: {shown(file)}")
        if not has_main(file):
            hint = "give it one:  def main(args=None):  that calls lcmtools.init(args)"
            raise UsageError(f"{shown(file)} has no function main", hint)
    node = Runnable(package.name, name, "")
    project = package.folder / "pyproject.toml"
    texts = {} if is_declared else {project: _declared(project, node)}
    if replace or not file.exists():
        texts[file] = (
            node_text(package.name, name, _dependencies(package)) if text is None else text
        )
    for path, content in texts.items():
        with os_errors_as(f"cannot write {path}"):
            path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
    return sorted(texts)


def _dependencies(package: Package) -> list[str]:
    deps = table(read_project(package.folder), "tool", "lcmtools").get("deps")
    return [str(one) for one in deps] if isinstance(deps, list) else []


def _declared(project: Path, node: Runnable) -> str:
    """Return the text of a pyproject.toml with the line that declares a node."""
    lines = project.read_text("utf-8").splitlines()
    header = next((i for i, line in enumerate(lines) if _HEADER.match(line)), None)
    if header is None:
        lines += ["", TABLE, entry(node)]
    else:
        tables = (i for i in range(header + 1, len(lines)) if lines[i].lstrip().startswith("["))
        end = next(tables, len(lines))
        while not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#"):
            end -= 1
        lines.insert(end, entry(node))
    text = "\n".join(lines) + "\n"
    try:
        is_found = node.name in table(load_toml(text), "project", "entry-points", GROUP)
    except ValueError:
        is_found = False
    if not is_found:
        hint = f"write it below [project]:  {entry(node)}  as an entry point of {GROUP}"
        raise LcmtoolsError(f"{shown(project)} declares its nodes in an unusual way", hint)
    return text
