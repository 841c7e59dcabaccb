"""The summary of a node: the first line of its module's docstring, found without an import."""

import ast
import importlib.util
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path


def summary(target: str, folder: Path | None = None) -> str:
    """Return the first line of the docstring of "module:function"'s module, or "".

    ``folder`` is the one that its code is imported from; None for an installed package.
    """
    try:
        spec = _find(target.partition(":")[0].split("."), folder)
        if spec is None or spec.origin is None:
            return ""
        text = Path(spec.origin).read_text(encoding="utf-8")
        docstring = ast.get_docstring(ast.parse(text)) or ""
    except (ImportError, OSError, SyntaxError, ValueError):  # running it will tell
        return ""
    return docstring.partition("\n")[0].strip()


def _find(parts: Sequence[str], folder: Path | None) -> ModuleSpec | None:
    if folder is None:
        spec = importlib.util.find_spec(parts[0])
    else:
        spec = PathFinder.find_spec(parts[0], [str(folder)])
    for end in range(2, len(parts) + 1):
        if spec is None or spec.submodule_search_locations is None:
            return None
        spec = PathFinder.find_spec(".".join(parts[:end]), spec.submodule_search_locations)
    if spec and spec.submodule_search_locations and spec.origin is None:
        return None
    return spec
