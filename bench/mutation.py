"""Change places of the product at random, and print the share that the tests notice.

    .venv/bin/pip install coverage
    .venv/bin/python bench/mutation.py --record                          # once
    .venv/bin/python bench/mutation.py --record --tests tests/unit/wire  # of some tests only
    .venv/bin/python bench/mutation.py --count 200 --seed 1
    .venv/bin/python bench/mutation.py --room messages --room wire --count 20

A place is a comparison that is turned, a constant that is changed, or a line that is left out. It
is changed in a copy of the repository, where the tests run that touch the line, the fastest first,
until one fails: in pytest's process or in one that they start, as recorded before (``build/``). For
a line that runs when its module is imported, they are the tests that touch the module. What
survives needs a test, unless it only documents or saves time; so does what no test reaches.
"""

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "mutation"
DATA, SECONDS = BUILD / "coverage", BUILD / "seconds.json"
PRODUCT = {"lcmtools": ROOT / "lcmtools", "sim": ROOT / "sim" / "lcmtools_sim"}
GENERATED = {"types", "vendor"}
TESTS = [
    f"tests/{name}"
    for name in ["unit", "doctor", "files", "types", "house", "cli", "process", "physics"]
]
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
# a process that a test starts is recorded as that test's; coverage.py expands the variable
CONFIGURATION = f"""[run]
disable_warnings = module-not-imported, no-data-collected
context = ${{PYTEST_CURRENT_TEST-}}
data_file = {DATA}
parallel = true
patch = _exit
relative_files = true
sigterm = true
source = lcmtools, lcmtools_sim
"""


class Place(NamedTuple):
    """A piece of a file's text, the text that takes its place, and the lines of its statement."""

    path: Path
    line: int
    start: int  # offset in the line's UTF-8
    end: int
    text: str
    statement: range

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
    lines, tree = source.splitlines(), ast.parse(source)
    statements = [node for node in ast.walk(tree) if isinstance(node, ast.stmt)]

    def place(node: Any, start: int, end: int, text: str) -> Place:  # noqa: ANN401 - a node with lines
        around = [one for one in statements if one.lineno <= node.lineno <= (one.end_lineno or 0)]
        own = max(around, key=lambda one: one.lineno, default=node)  # else a decorator's
        body = getattr(own, "body", None)  # of an if or for its head counts
        last = body[0].lineno - 1 if body else own.end_lineno or own.lineno
        return Place(path, node.lineno, start, end, text, range(own.lineno, last + 1))

    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            left, right = node.left, node.comparators[0]
            start, end = left.end_col_offset or 0, right.col_offset
            between = lines[right.lineno - 1][start:end].decode(errors="replace")
            # in one line, and no parenthesis that belongs to a side
            if left.end_lineno == right.lineno and between.strip(" ()") == between.strip():
                yield place(right, start, end, f" {TURNED[type(node.ops[0])]} ")
        elif isinstance(node, ast.Constant) and (text := _other(node.value)):
            yield place(node, node.col_offset, node.end_col_offset or 0, text)
        elif _can_be_left_out(node) and node.lineno == node.end_lineno:  # type: ignore[attr-defined]
            yield place(node, node.col_offset, node.end_col_offset, "pass")  # type: ignore[attr-defined]


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


def run_tests(root: Path, words: list[str], **options: Any) -> int:  # noqa: ANN401 - of subprocess
    """Run pytest in a copy of the repository, with this plugin; return its exit code."""
    folders = os.pathsep.join(map(str, (root, root / "sim", root / "bench")))
    environment = {"PYTHONPATH": folders, "PYTHONDONTWRITEBYTECODE": "1"}
    words = ["-m", "pytest", "-q", "-p", "mutation", "-p", "no:cacheprovider", *words]
    environment |= options.pop("env", {})
    return subprocess.run(
        [sys.executable, *words],
        cwd=root,
        env={**os.environ, **environment},
        check=False,
        **options,
    ).returncode


def record(tests: list[str], workers: int) -> None:
    """Run the tests, and keep which lines each touches and how long it takes."""
    shutil.rmtree(BUILD, ignore_errors=True)
    BUILD.mkdir(parents=True)
    file = BUILD / "coveragerc"
    file.write_text(CONFIGURATION)
    words = ["-m", "not timing", "-n", f"{workers}", "--dist", "worksteal", *tests]
    start = {"MUTATION": "record", "COVERAGE_PROCESS_START": str(file)}
    run_tests(ROOT, words, env=start)
    combine = [sys.executable, "-m", "coverage", "combine", "-q", f"--rcfile={file}"]
    subprocess.run(combine, cwd=ROOT, check=True)


def pytest_runtest_protocol(item: Any) -> None:  # noqa: ANN401 - pytest's
    """Record what runs from now on, its fixtures too, as this test's."""
    if os.environ.get("MUTATION") == "record":
        import coverage

        if (current := coverage.Coverage.current()) is not None:
            current.switch_context(item.nodeid)


def pytest_runtest_logreport(report: Any) -> None:  # noqa: ANN401
    """Add up how long each test takes; one that fails as it is tells nothing of a change."""
    _SECONDS[report.nodeid] = _SECONDS.get(report.nodeid, 0.0) + report.duration
    if report.failed:
        _FAILED.add(report.nodeid)


def pytest_sessionfinish() -> None:
    """Keep the durations."""
    if os.environ.get("MUTATION") == "record":
        kept = {test: seconds for test, seconds in _SECONDS.items() if test not in _FAILED}
        SECONDS.write_text(json.dumps(kept))


_SECONDS: dict[str, float] = {}
_FAILED: set[str] = set()


class Recorded:
    """What was recorded of the tests."""

    def __init__(self) -> None:
        from coverage import CoverageData

        if not SECONDS.exists():
            raise SystemExit(
                "nothing is recorded; type: .venv/bin/python bench/mutation.py --record"
            )
        self.seconds: dict[str, float] = json.loads(SECONDS.read_text())
        self._data = CoverageData(str(DATA))
        self._data.read()

    def tests_of(self, place: Place) -> list[str]:
        """Return the tests that touch a place, and of one that is run at import the module's."""
        lines = self._data.contexts_by_lineno(str(place.path.relative_to(ROOT)))
        touched = {context for line in place.statement for context in lines.get(line, ())}
        found = self._fastest_first(touched)
        if "" in touched:  # before any test
            found += self._fastest_first({one for contexts in lines.values() for one in contexts})
        return list(dict.fromkeys(found))

    def _fastest_first(self, contexts: set[str]) -> list[str]:
        tests = {one.rpartition(" (")[0] if one.endswith(")") else one for one in contexts}
        return sorted(tests & self.seconds.keys(), key=self.seconds.__getitem__)


def fate(place: Place, copy: Path, recorded: Recorded, limit: float) -> str:
    """Return what becomes of a change: "killed", "survived" or "not reached"."""
    tests, chosen, seconds = recorded.tests_of(place), list[str](), 0.0
    for test in tests:
        seconds += recorded.seconds[test]
        if chosen and seconds > limit:
            break
        chosen.append(test)
    if not chosen:
        return "not reached"
    file = copy / place.path.relative_to(ROOT)
    before = file.read_bytes()
    file.write_text(place.changed())
    (copy / "chosen").write_text("\n".join(chosen))
    try:  # one that makes the tests endless is noticed
        code = run_tests(copy, ["-x", "@chosen"], capture_output=True, timeout=60 + 3 * limit)
    except subprocess.TimeoutExpired:
        return "killed"
    finally:
        file.write_bytes(before)
    return "killed" if code else "survived"


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[Any]) -> None:
    """Keep the order of the file with the chosen tests."""
    if os.environ.get("MUTATION") != "record" and Path("chosen").exists():
        order = {test: place for place, test in enumerate(Path("chosen").read_text().splitlines())}
        items.sort(key=lambda item: order[item.nodeid])


def main() -> None:
    """Try the places, and print each with what became of it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--record", action="store_true", help="record what each test touches")
    parser.add_argument("--tests", nargs="+", default=TESTS, help="that are recorded")
    parser.add_argument("--workers", type=int, default=3, help="that record side by side (3)")
    parser.add_argument("--count", type=int, default=200, help="number of places (200)")
    parser.add_argument("--seed", type=int, default=1, help="other places for another number (1)")
    parser.add_argument("--room", action="append", help="only this room; may be repeated")
    parser.add_argument("--limit", type=float, default=30, help="seconds of tests a place (30)")
    options = parser.parse_args()
    if options.record:
        record([test for test in options.tests if (ROOT / test).exists()], options.workers)
        return
    recorded, begin = Recorded(), time.monotonic()
    files = (file for folder in PRODUCT.values() for file in sorted(folder.rglob("*.py")))
    found = [
        place
        for file in files
        if not GENERATED & set(file.parts) and (not options.room or room_of(file) in options.room)
        for place in places(file)
    ]
    chosen = random.Random(options.seed).sample(found, min(options.count, len(found)))  # noqa: S311
    fates = {"killed": 0, "survived": 0, "not reached": 0}
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        left_out = shutil.ignore_patterns(".git", ".venv", "build", "__pycache__", ".*_cache")
        shutil.copytree(ROOT, copy, ignore=left_out, symlinks=True)
        for place in chosen:
            became = fate(place, copy, recorded, options.limit)
            fates[became] += 1
            print(f"{became:11}  {place}", flush=True)
    told = ", ".join(f"{number} {name}" for name, number in fates.items())
    share = fates["killed"] / max(1, len(chosen))
    print(f"{told} of {len(found)} places, in {time.monotonic() - begin:.0f} s: {share:.1%} killed")


if __name__ == "__main__":
    main()
