"""Names that many modules need are written in one place, and imported from there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _is_literal(name, source):
    """Return whether a string literal of a module, also within an f-string, is such a name."""
    if not re.search(name, source):  # nearly all modules need not be parsed
        return False
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Constant))
    return any(isinstance(one.value, str) and re.fullmatch(name, one.value) for one in nodes)


@pytest.mark.parametrize(
    ("name", "place"),
    [
        (r"/clock(/.*)?", "lcmtools/clock.py"),
        (r"sim_msgs/\w*", "lcmtools/observe/simulators.py"),
    ],
)
def test_a_name_is_written_in_one_place(name, place):
    """A topic, or the types of a package; sentences that mention them do not count."""
    found = {
        str(path.relative_to(ROOT))
        for folder in ("lcmtools", "sim")
        for path in (ROOT / folder).rglob("*.py")
        if "types" not in path.relative_to(ROOT).parts  # lcm-gen's
        if _is_literal(name, path.read_text())
    }
    assert found == {place}
