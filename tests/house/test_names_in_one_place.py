"""Names that many modules need are written in one place, and imported from there."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _texts(tree: ast.AST) -> Iterator[str]:
    """The string literals of a module, also those within f-strings."""
    nodes = (node for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return (node.value for node in nodes if isinstance(node.value, str))


@pytest.mark.parametrize(
    ("name", "place"),
    [("/clock", "lcmtools/clock.py"), ("sim_msgs/", "lcmtools/observe/simulators.py")],
)
def test_a_name_is_written_in_one_place(name: str, place: str) -> None:
    """A topic, or the beginning of types; help and docstrings begin with other words."""
    found = {
        str(path.relative_to(ROOT))
        for folder in ("lcmtools", "sim")
        for path in (ROOT / folder).rglob("*.py")
        if "types" not in path.relative_to(ROOT).parts  # lcm-gen's
        if any(text.startswith(name) for text in _texts(ast.parse(path.read_text())))
    }
    assert found == {place}
