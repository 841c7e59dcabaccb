"""Change places of the product at random, and print the share that the tests of the room notice.

    .venv/bin/python bench/mutation.py --count 200 --seed 1
    .venv/bin/python bench/mutation.py --room messages --room wire --count 20

A place is a comparison that is turned, a constant that is changed, or a line that is left out. It
is changed in a copy of the repository, and the tests without a bus run there: first the files that
name its module, then all others of its room; with --process also those in tests/process that name
it. What survives needs a test, unless it only documents or saves time.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
PRODUCT = {"lcmtools": ROOT / "lcmtools", "sim": ROOT / "sim" / "lcmtools_sim"}
GENERATED = {"types", "vendor"}
TURNED: dict[type[ast.cmpop], str] = {
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.In: "not in",
    ast.NotIn: "in",
    ast.Is: "is not",
    ast.IsNot: "is",
}
FOLDERS = {
    "cli": ["tests/cli"],
    "doctor": ["tests/doctor"],
    "bag": ["tests/files/bags", "tests/files/logs"],
    "labs": ["tests/unit/nodes"],
    "launch": ["tests/files/launch"],
    "messages": ["tests/files/messages", "tests/types"],
    "wire": ["tests/files/logs"],
    "sim": ["tests/files/worlds", "tests/physics"],
}
"""The folders with tests of a room, beside its own in tests/unit."""
SECONDS = 1800
"""Time for the tests of a change; one that makes them endless is noticed."""


class Place(NamedTuple):
    """A piece of a file's text, and the text that takes its place."""

    path: Path
    line: int
    start: int  # offset in the line's UTF-8
    end: int
    text: str

    def changed(self) -> str:
        """Return the file's text with the change."""
        lines = self.path.read_bytes().splitlines(keepends=True)
        line = lines[self.line - 1]
        lines[self.line - 1] = line[: self.start] + self.text.encode() + line[self.end :]
        return b"".join(lines).decode()

    def __str__(self) -> str:
        """Return the place and the change in one line."""
        line = self.path.read_bytes().splitlines()[self.line - 1]
        old = line[self.start : self.end].decode()
        return f"{self.path.relative_to(ROOT)}:{self.line}: {old!r} -> {self.text!r}"


def places(path: Path) -> Iterator[Place]:
    """Yield the places of a file that can be changed."""
    source = path.read_bytes()
    lines = source.splitlines()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            yield from _turned(path, lines, node)
        elif isinstance(node, ast.Constant) and (text := _other(node.value)):
            yield Place(path, node.lineno, node.col_offset, node.end_col_offset or 0, text)
        elif _can_be_left_out(node) and node.lineno == node.end_lineno:  # type: ignore[attr-defined]
            yield Place(path, node.lineno, node.col_offset, node.end_col_offset or 0, "pass")  # type: ignore[attr-defined]


def _turned(path: Path, lines: list[bytes], node: ast.Compare) -> Iterator[Place]:
    """Yield the operator of a comparison, if both sides are in one line."""
    left, right = node.left, node.comparators[0]
    if left.end_lineno == right.lineno:
        start, end = left.end_col_offset or 0, right.col_offset
        between = lines[right.lineno - 1][start:end].decode()
        if between.strip(" ()") == between.strip():  # no parenthesis that belongs to a side
            yield Place(path, right.lineno, start, end, f" {TURNED[type(node.ops[0])]} ")


def _other(value: object) -> str:
    """Return the text of another constant, or "" for one that is only a text."""
    if isinstance(value, bool):
        return str(not value)
    return repr(value + 1) if isinstance(value, int | float) else ""


def _can_be_left_out(node: ast.AST) -> bool:
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return isinstance(node, ast.Expr | ast.AugAssign | ast.Raise | ast.Delete) and not is_text


def room_of(path: Path) -> str:
    """Return the name of the room that a file belongs to."""
    name, folder = next(one for one in PRODUCT.items() if path.is_relative_to(one[1]))
    return "sim" if name == "sim" else path.relative_to(folder).parts[0].removesuffix(".py")


def tests_of(path: Path, *, with_processes: bool) -> list[str]:
    """Return the files of tests of a module: those that name it, and the rest of its room."""
    room = room_of(path)
    folders = [f"tests/unit/{room}", f"tests/unit/test_{room}.py", *FOLDERS.get(room, [])]
    found = [folder for folder in folders if (ROOT / folder).exists()]
    package = path.parent.relative_to(ROOT / "sim" if room == "sim" else ROOT)
    names = (".".join((*package.parts, path.stem)), f"{'.'.join(package.parts)} import {path.stem}")
    folders = ["tests/unit", "tests/files", *(["tests/process"] if with_processes else [])]
    files = (file for folder in folders for file in (ROOT / folder).rglob("test_*.py"))
    near = [file for file in files if any(name in file.read_text() for name in names)]
    return [*(str(file.relative_to(ROOT)) for file in near), *found]


def is_noticed(place: Place, copy: Path, tests: list[str]) -> bool:
    """Return whether the tests fail with the change."""
    file = copy / place.path.relative_to(ROOT)
    before = file.read_bytes()
    file.write_text(place.changed())
    paths = os.pathsep.join((str(copy), str(copy / "sim")))
    words = ["-x", "-q", "-p", "no:cacheprovider", "-m", "not timing", *tests]
    try:
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *words],
            cwd=copy,
            env={**os.environ, "PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"},
            capture_output=True,
            timeout=SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return True
    finally:
        file.write_bytes(before)
    return done.returncode != 0


def main() -> None:
    """Try the places, and print each with what became of it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--count", type=int, default=200, help="number of places (200)")
    parser.add_argument("--seed", type=int, default=1, help="other places for another number (1)")
    parser.add_argument("--room", action="append", help="only this room; may be repeated")
    parser.add_argument(
        "--process", action="store_true", help="also the tests with a bus that name it"
    )
    options = parser.parse_args()
    files = (file for folder in PRODUCT.values() for file in sorted(folder.rglob("*.py")))
    found = [
        place
        for file in files
        if not GENERATED & set(file.parts) and (not options.room or room_of(file) in options.room)
        for place in places(file)
    ]
    chosen = random.Random(options.seed).sample(found, min(options.count, len(found)))  # noqa: S311
    noticed = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        left_out = shutil.ignore_patterns(".git", ".venv", "build", "__pycache__", ".*_cache")
        shutil.copytree(ROOT, copy, ignore=left_out, symlinks=True)
        for number, place in enumerate(chosen, 1):
            tests = tests_of(place.path, with_processes=options.process)
            is_killed = bool(tests) and is_noticed(place, copy, tests)
            noticed += is_killed
            fate = "noticed " if is_killed else "SURVIVED"
            print(f"{noticed:3} of {number:3}  {fate}  {place}", flush=True)
    print(f"{noticed} of {len(chosen)} changes noticed, of {len(found)} places")


if __name__ == "__main__":
    main()
