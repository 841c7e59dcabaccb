"""The output of lcm-gen for files, read without importing it.

Belongs here: a module's tables, and the problems of its types. Must not know caches or the types
of other files.
"""

import ast
import marshal
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import NamedTuple, cast

from lcmtools.messages.type_source import Problem
from lcmtools.names import closest
from lcmtools.packages.lcm_gen import run_lcm_gen
from lcmtools.packages.ros_files import to_lcm
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.unit import TREE, Generated, Output, Tables

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
_PACKAGE = re.compile(rb"\{[^}]*\}|\bpackage\s+")  # outside of structs
_DECLARATION = re.compile(r"\bpackage\s+([\w.]+)|\b(?:struct|enum)\s+(\w+)\s*\{")
_IMPORT = re.compile(rf"^import {TREE}.*\n", re.MULTILINE)
_NUMBER = re.compile(r"(?:tmphash = \(|return )(0x[0-9a-f]+)")  # in ``_get_hash_recursive``
_VALUE = re.compile(r"^    (\w+) = (-?\d+)$", re.MULTILINE)  # of an enum
_STRANGE = re.compile(rb"[^\w\s;{}\[\].,=+\-/*]", re.ASCII)


class _Text(NamedTuple):
    """A file as lcm-gen gets it, and the string constants that LCM does not have, by type."""

    lcm: bytes
    problems: Sequence[Problem] = ()
    constants: Mapping[str, Mapping[str, str]] = MappingProxyType({})


def generate(sources: Sequence[LcmFile]) -> list[Output]:
    """Generate the types of each file by one run of lcm-gen, which refuses files one by one.

    Each file's packages are put into one of its own for that run, so that files with equal names
    do not overwrite each other.
    """
    texts = list(map(_lcm_text, sources))
    with TemporaryDirectory(prefix="lcmtools-") as name:
        folder = Path(name)
        copies = {folder / f"file{n}.lcm": text for n, text in enumerate(texts)}
        for copy, text in copies.items():
            copy.write_bytes(_inside(f"{copy.stem}_", text.lcm))
        refused = _refused([copy for copy, text in copies.items() if not text.problems], folder)
        return [
            _output(source, text, folder / TREE / f"{copy.stem}_", refused.get(copy))
            for source, (copy, text) in zip(sources, copies.items(), strict=True)
        ]


def _lcm_text(source: LcmFile) -> _Text:
    """Return a file without its comments, for lcm-gen would copy them into Python docstrings.

    Quotes in a comment could end one, so that the rest would be executed. A ROS file is translated.
    """
    if source.package:
        translated = to_lcm(source.path, source.content, source.package)
        text = _Text(translated.text.encode(), translated.problems, translated.texts)
    else:
        text = _Text(_without_comments(source.content))
    if not text.problems and (strange := _STRANGE.search(text.lcm)):
        line = text.lcm[: strange.start()].count(b"\n") + 1
        character = text.lcm[strange.start() : strange.start() + 4].decode("utf-8", "replace")[:1]
        hint = "a .lcm file has words, numbers and ;{}[].=-"
        problem = Problem(str(source.path), line, f"unexpected {character!r}", hint)
        return text._replace(problems=[problem])
    return text


def _without_comments(content: bytes) -> bytes:
    return _COMMENT.sub(lambda one: b" " + b"\n" * one[0].count(b"\n"), content)


def _inside(package: str, text: bytes) -> bytes:
    """Put the packages in a .lcm file, and its types without one, into a package."""
    inner = b"%s." % package.encode()
    whole = _PACKAGE.sub(lambda one: one[0] if one[0][:1] == b"{" else one[0] + inner, text)
    return b"package %s; %s" % (package.encode(), whole)


def _refused(files: Sequence[Path], folder: Path) -> dict[Path, Problem]:
    """Write the Python modules of files into a folder; return the problems of those refused."""
    options = ["--python", "--python-no-init", "--ppath", str(folder), "--package-prefix", TREE]
    refused: dict[Path, Problem] = {}
    while left := [file for file in files if file not in refused]:
        problem = run_lcm_gen(left, options)
        if problem is None:
            break
        if not problem.file:  # lcm-gen does not say which
            tried = ((file, run_lcm_gen([file], options)) for file in left)
            return refused | {file: found for file, found in tried if found}
        refused[Path(problem.file)] = problem
    return refused


def _output(source: LcmFile, text: _Text, root: Path, refused: Problem | None) -> Output:
    """Read the modules that lcm-gen has written below a folder for one file."""
    file = str(source.path)
    if faults := [*text.problems, *([refused] if refused else [])]:
        named = [f"{source.package}/{source.path.stem}"] if source.package else []
        lost = [*named, *_declared(text.lcm)]
        return Output([], [one._replace(file=file, lost=lost) for one in faults])
    found: list[Generated] = []
    problems: list[Problem] = []
    for module in sorted(root.rglob("*.py")):
        *packages, short = module.relative_to(root).with_suffix("").parts
        name = f"{'.'.join(packages)}/{short}".lstrip("/")
        python = module.read_text("utf-8").replace(f"{TREE}.{root.name}.", f"{TREE}.")
        python = _IMPORT.sub("", python)  # ``loading`` provides what it imports
        for constant, value in text.constants.get(name, {}).items():
            python += f"{short}.{constant} = {value!r}\n"
        one = _read_module(python, name, source)
        if isinstance(one, Problem):
            problems.append(one)
        else:
            found.append(one)
    return Output(found, problems)


def _declared(text: bytes) -> list[str]:
    """Return the types in a .lcm file that lcm-gen refuses, as far as they can be made out."""
    found, package = [], ""
    for match in _DECLARATION.finditer(text.decode("ascii", "replace")):
        if match[1]:
            package = f"{match[1]}/"
        else:
            found.append(package + match[2])
    return found


def unknown_type(one: Generated, missing: str, known: set[str]) -> Problem:
    """Return the problem for a type with a field of an unknown type."""
    short = missing.rpartition("/")[2]
    line = line_of(one.file, missing.replace("/", "."), short)
    near = _LCM_NAMES.get(short) or _like(missing, one, known)
    hint = f"did you mean {near}?" if near else "name the folder of its .lcm file too"
    same = missing.rpartition("/")[0] == one.name.rpartition("/")[0]
    written = short if same else missing.replace("/", ".")
    if one.file.package:
        written, hint = written.replace(".", "/"), hint.replace(".", "/")
    what = f"{one.name}: unknown type '{written}'"
    return Problem(str(one.file.path), line, what, hint, one.name, (one.name,))


def _like(missing: str, one: Generated, known: set[str]) -> str:
    """Return the type that was probably meant, in .lcm notation; "" if none is similar."""
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


def _read_module(python: str, name: str, source: LcmFile) -> Generated | Problem:
    """Return the type in a module, or the problem if Python cannot import it."""
    number = _NUMBER.search(python)
    if "__typenames__" not in python:  # an enum
        named = {word: int(digits) for word, digits in _VALUE.findall(python)}
        return Generated(name, source, int(number[1], 16) if number else 0, None, named, b"")
    try:
        tree = ast.parse(python)
    except (SyntaxError, ValueError) as error:
        return _not_python(source, name, error)
    members = [node for one in tree.body if isinstance(one, ast.ClassDef) for node in one.body]
    values = {
        node.targets[0].id: node.value
        for node in members
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    tables = cast("Tables", tuple(ast.literal_eval(values[table]) for table in _TABLES))
    taken = {node.name for node in members if isinstance(node, ast.FunctionDef)} | set(values)
    for field in tables[0]:
        if field in taken:
            what = f"{name}: a field cannot be called '{field}': lcm-gen's Python needs that name"
            line = line_of(source, field)
            return Problem(str(source.path), line, what, "use another name", name, (name,))
    code = marshal.dumps(compile(tree, f"<{name}>", "exec"))
    return Generated(name, source, int(number[1], 16) if number else 0, tables, {}, code)


def _not_python(source: LcmFile, name: str, error: Exception) -> Problem:
    word = re.search(r"self\.(\w+)", getattr(error, "text", None) or "")
    if word is None:
        what = f"{name}: lcm-gen does not make valid Python of it: {getattr(error, 'msg', error)}"
        return Problem(str(source.path), 0, what, "", name, (name,))
    line = line_of(source, word[1])
    what = f"{name}: '{word[1]}' is a keyword of Python and cannot be a field"
    return Problem(str(source.path), line, what, f"for example {word[1]}_", name, (name,))


def line_of(source: LcmFile, *words: str) -> int:
    """Return the first line with one of the words outside of comments; 0 for none."""
    if source.package:
        lines = [line.partition(b"#")[0] for line in source.content.splitlines()]
    else:
        lines = _without_comments(source.content).split(b"\n")
    for word in map(re.escape, map(str.encode, words)):
        alone = rb"(?<![\w.])%s(?![\w.])" % word
        for pattern in (rb"%s\s+\w+\s*[\[;]" % alone, alone):  # the type of a field, or any
            for number, line in enumerate(lines, 1):
                if re.search(pattern, line):
                    return number
    return 0
