"""The hints of checks, which are of programs in any language."""

import ast
import re
from pathlib import Path

import pytest

from lcmtools.labs import checks

_OF_PYTHON = re.compile(
    r"\b(lcmtools|node|math|tty|time)\.\w+\(|\btty\.set|finally block|catch KeyboardInterrupt"
)


def _texts(file):
    """Yield the texts of a module but its docstrings, and so all of its hints."""
    tree = ast.parse(file.read_text())
    bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in bare:
            yield node.value


FILES = sorted(Path(checks.__file__).parent.glob("*.py"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_no_hint_is_in_python(file):
    assert [text for text in _texts(file) if _OF_PYTHON.search(text)] == []
