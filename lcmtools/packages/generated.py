"""The output of lcm-gen for one file, read without importing it.

Belongs here: a module's tables, and the problems of its types. Must not know caches or
fingerprints.
"""

import ast
import re
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from lcmtools.messages.type_source import Problem
from lcmtools.names import closest
from lcmtools.packages.lcm_gen import run_lcm_gen
from lcmtools.packages.ros_files import SUFFIXES, to_lcm
from lcmtools.packages.type_files import LcmFile

Tables = tuple[list[str], list[str], list[list[int | str] | None]]
"""lcm-gen's tables of a type's fields, as in the class: names, types, and the arrays' sizes."""

_TABLES = ("__slots__", "__typenames__", "__dimensions__")
_LCM_NAMES = {
    "bool": "boolean",
    "str": "string",
    "int": "int32_t",
    "uint": "int32_t",
    **dict.fromkeys(("char", "uint8", "uint8_t"), "byte"),
    **dict.fromkeys(("float32", "float32_t"), "float"),
    **dict.fromkeys(("float64", "float64_t"), "double"),
    **{f"int{bits}": f"int{bits}_t" for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": f"int{bits}_t" for bits in (16, 32, 64)},
    **{f"uint{bits}_t": f"int{bits}_t" for bits in (16, 32, 64)},
}
"""Type names of C, Python and ROS, and LCM's names for them."""

_COMMENT = re.compile(rb"//[^\n]*|/\*.*?\*/", re.DOTALL)
_STRANGE = re.compile(rb"[^\w\s;{}\[\].,=+\-/*]", re.ASCII)


@dataclass(frozen=True, slots=True)
class Generated:
    """A module that lcm-gen has made."""

    name: str  # its type's name: "geometry_msgs/Twist", or "pose_t" outside of any package
    file: Path  # the file that it is made of
    module: Path
    tables: Tables | None  # its fields; None for an enum

    def nested(self) -> Iterator[str]:
        """The module paths of the types that its fields have: "PREFIX.geometry_msgs.Twist"."""
        return (name for name in (self.tables[1] if self.tables else ()) if "." in name)


def generate(source: LcmFile, prefix: str, folder: Path) -> tuple[list[Generated], list[Problem]]:
    """Write the Python modules of one .lcm file into an empty folder with lcm-gen.

    It gets the file without its comments: it would copy them into Python's, and quotation marks in
    one would end that, so that the rest would be run. Of a file of ROS it gets a translation.
    """
    file = source.path
    texts: Mapping[str, Mapping[str, str]] = {}
    if source.package:
        translated = to_lcm(file, source.content, source.package)
        if translated.problems:
            return [], translated.problems
        text, texts = translated.text.encode(), translated.texts
    else:
        text = _COMMENT.sub(lambda one: b" " + b"\n" * one[0].count(b"\n"), source.content)
    if strange := _STRANGE.search(text):
        line = text[: strange.start()].count(b"\n") + 1
        character = text[strange.start() : strange.start() + 4].decode("utf-8", "replace")[:1]
        what = f"unexpected {character!r}"
        return [], [Problem(str(file), line, what, "a .lcm file has words, numbers and ;{}[].=-")]
    copy = folder / "file.lcm"
    copy.write_bytes(text)
    problem = run_lcm_gen(copy, ["--python", "--ppath", str(folder), "--package-prefix", prefix])
    if problem:
        return [], [problem._replace(file=str(file))]
    found: list[Generated] = []
    problems: list[Problem] = []
    root = folder / prefix
    for module in sorted(root.rglob("*.py")):
        if module.name == "__init__.py":  # lcmtools writes its own: see build
            continue
        *packages, short = module.relative_to(root).with_suffix("").parts
        one = _read_tables(module, f"{'.'.join(packages)}/{short}".lstrip("/"), file)
        if isinstance(one, Problem):
            problems.append(one)
        else:
            found.append(one)
            with module.open("a") as end:
                end.writelines(f"{short}.{n} = {v!r}\n" for n, v in texts.get(one.name, {}).items())
    return found, problems


def move(one: Generated, old_root: Path, new_root: Path) -> Generated:
    """Move a module into another tree."""
    target = new_root / one.module.relative_to(old_root)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.move(one.module, target)
    return replace(one, module=target)


def unknown_type(one: Generated, missing: str, known: set[str]) -> Problem:
    """The problem of a type with a field of an unknown type."""
    short = missing.rpartition("/")[2]
    line = _line_of(one.file, missing.replace("/", "."), short)
    near = _LCM_NAMES.get(short) or _like(missing, one, known)
    hint = f"did you mean {near}?" if near else "name the folder of its .lcm file too"
    same = missing.rpartition("/")[0] == one.name.rpartition("/")[0]
    written = short if same else missing.replace("/", ".")
    if one.file.suffix in SUFFIXES:
        written, hint = written.replace(".", "/"), hint.replace(".", "/")
    return Problem(str(one.file), line, f"{one.name}: unknown type '{written}'", hint, one.name)


def _like(missing: str, one: Generated, known: set[str]) -> str:
    """The type that was meant, as a .lcm file writes it; "" where nothing is like it."""
    package, _, short = missing.rpartition("/")
    shorts = {name.rpartition("/")[2]: name for name in sorted(known) if "/" in name or not package}
    inside = {name.rpartition("/")[2]: name for name in known if name.rpartition("/")[0] == package}
    if near := closest(short, inside):
        found = inside[near[0]]
    elif package == one.name.rpartition("/")[0]:  # written without a package
        found = next((shorts[name] for name in closest(short, shorts)), "")
    else:
        found = shorts.get(short) or next(iter(closest(missing, known)), "")
    return found.replace("/", ".")


def _read_tables(module: Path, name: str, file: Path) -> Generated | Problem:
    """Return a module with its tables, or the problem for which Python cannot import it."""
    try:
        body = ast.parse(module.read_bytes()).body
    except (SyntaxError, ValueError) as error:
        return _not_python(file, name, error)
    members = [node for one in body if isinstance(one, ast.ClassDef) for node in one.body]
    values = {
        node.targets[0].id: node.value
        for node in members
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    if not all(table in values for table in _TABLES):
        return Generated(name, file, module, None)  # an enum
    tables = cast("Tables", tuple(ast.literal_eval(values[table]) for table in _TABLES))
    taken = {node.name for node in members if isinstance(node, ast.FunctionDef)} | set(values)
    for field in tables[0]:
        if field in taken:
            what = f"{name}: a field cannot be called '{field}': lcm-gen's Python needs that name"
            return Problem(str(file), _line_of(file, field), what, "use another name", name)
    return Generated(name, file, module, tables)


def _not_python(file: Path, name: str, error: Exception) -> Problem:
    word = re.search(r"self\.(\w+)", getattr(error, "text", None) or "")
    if word is None:
        what = f"{name}: lcm-gen does not make valid Python of it: {getattr(error, 'msg', error)}"
        return Problem(str(file), 0, what, "", name)
    line = _line_of(file, word[1])
    what = f"{name}: '{word[1]}' is a keyword of Python and cannot be a field"
    return Problem(str(file), line, what, f"for example {word[1]}_", name)


def _line_of(file: Path, *words: str) -> int:
    """The first line that has one of the words, 0 for none."""
    comment = "#" if file.suffix in SUFFIXES else "//"
    try:
        text = file.read_text("utf-8", "replace")
    except OSError:  # of a log, whose types have no files here
        return 0
    lines = [line.partition(comment)[0] for line in text.splitlines()]
    for word in words:
        alone = rf"(?<![\w.]){re.escape(word)}(?![\w.])"
        for pattern in (rf"{alone}\s+\w+\s*[\[;]", alone):  # the type of a field, or any
            for number, line in enumerate(lines, 1):
                if re.search(pattern, line):
                    return number
    return 0
