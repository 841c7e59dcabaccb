"""Constants of a module: each has one value, so that none takes another's place unseen."""

import ast
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_no_module_gives_a_constant_two_values():
    twice = []
    for path in [*ROOT.glob("lcmtools/**/*.py"), *ROOT.glob("sim/**/*.py")]:
        given = Counter(
            name.id
            for statement in ast.parse(path.read_text(encoding="utf-8")).body
            if isinstance(statement, ast.Assign | ast.AnnAssign)
            for name in ast.walk(statement)
            if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
        )
        twice += [
            f"{path}: {name}" for name, number in given.items() if number > 1 and name.isupper()
        ]
    assert not twice
