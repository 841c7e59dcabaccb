"""The output of lcm-gen for files, read without importing it.

Belongs here: a module's tables, and the problems of its types. Must not know caches or the types
of other files.
"""

import ast
import marshal
import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, cast

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.python_names import base_hash, python_name
from lcmtools.messages.type_source import Problem
from lcmtools.names import closest
from lcmtools.packages.comments import COMMENT, without_comments
from lcmtools.packages.lcm_gen import run_lcm_gen
from lcmtools.packages.python_code import as_values
from lcmtools.packages.ros_files import LcmSource, to_lcm
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.unit import TREE, Generated, Output, Tables

_BASE = "lcmtools.packages.own_message.OwnMessage"
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

_NEARLY_THE_SAME = 0.8  # similarity of two letters exchanged; point_t and int8_t have less
_MOST_PROBLEMS = 20  # of a file that are told
# Each pattern passes over a text once, whatever is in it: one that looks for an end which may be
# missing, or begins within a word, would do so again from every place.
_WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_HASH = re.compile(r"tmphash = \(0x[0-9a-f]+")
_PACKAGE = re.compile(r"\bpackage\s+([\w.]+)")
_PACKAGES = re.compile(r"\{[^}]*\}?|\bpackage\s+")  # outside of structs
_STRUCT = re.compile(r"\bstruct\s+(\w+)\s*\{([^{}]*)\}")
_CONSTANTS = re.compile(r"\bconst\s+(\w+)\s([^;]*)")
_CONSTANT = re.compile(r"\b(\w+)\s*=")
_DECLARATION = re.compile(r"\bpackage\s+([\w.]+)|\b(?:struct|enum)\s+(\w+)\s*\{")
_IMPORT = re.compile(rf"^import {TREE}.*\n", re.MULTILINE)
_NUMBER = re.compile(r"(?:tmphash = \(|return )(0x[0-9a-f]+)")  # in ``_get_hash_recursive``
_VALUE = re.compile(r"^    (\w+) = (-?\d+)$", re.MULTILINE)  # of an enum
_STRANGE = re.compile(r"[^\w\s;{}\[\].,=+\-/*]", re.ASCII)


class _Copy(NamedTuple):
    """A file for lcm-gen, in which the words that Python cannot spell are renamed."""

    source: LcmFile
    read: LcmSource
    renamed: Mapping[str, str]

    @property
    def own(self) -> dict[str, str]:
        """The words in the file, by their names in Python."""
        return {spelled: word for word, spelled in self.renamed.items()}

    def text(self, package: str) -> str:
        """Return the content, its packages and its types without one put into a package."""
        text, start = _with_words(self.read.text, self.renamed), f"{package}."
        whole = _PACKAGES.sub(lambda one: one[0] if one[0][0] == "{" else one[0] + start, text)
        return f"package {package}; {whole}"


def generate(sources: Sequence[LcmFile]) -> list[Output]:
    """Generate the types of each file by one run of lcm-gen, which refuses files one by one.

    Each file's packages are put into one of its own for that run, so that files with equal names
    do not overwrite each other.
    """
    with TemporaryDirectory(prefix="lcmtools-") as name:
        folder = Path(name)
        copies = {folder / f"file{n}.lcm": _copy(source) for n, source in enumerate(sources)}
        for path, copy in copies.items():
            path.write_text(copy.text(f"{path.stem}_"), "utf-8")
        usable = [path for path, copy in copies.items() if not copy.read.problems]
        refused = _refused(usable, folder)
        return [
            _output(copy, folder / TREE / f"{path.stem}_", refused.get(path))
            for path, copy in copies.items()
        ]


def _copy(source: LcmFile) -> _Copy:
    read = _as_lcm(source)
    return _Copy(source, read, _renamed(read.text, *read.texts.values()))


def _as_lcm(source: LcmFile) -> LcmSource:
    """Return a file as lcm-gen reads it: without comments, which it would copy into docstrings.

    Quotes in a comment could end one, so that the rest would be executed. A ROS file is translated.
    """
    if source.package:
        read = to_lcm(source.path, source.content, source.package)
        if read.problems:
            return read
    else:
        text = without_comments(source.content).decode("utf-8", "replace")
        read = LcmSource(text, _unclosed_comment(source), {}, _constant_types(text))
    if strange := _STRANGE.search(read.text):
        line = read.text[: strange.start()].count("\n") + 1
        hint = "a .lcm file has words, numbers and ;{}[].=-"
        read.problems.append(Problem(str(source.path), line, f"unexpected {strange[0]!r}", hint))
    return read


def _constant_types(text: str) -> dict[str, dict[str, str]]:
    """Return the declared type of each constant, by type; lcm-gen does not keep it."""
    package = _PACKAGE.search(text)
    start = f"{package[1]}/" if package else ""
    return {
        f"{start}{struct[1]}": {
            name: kind
            for kind, rest in _CONSTANTS.findall(struct[2])
            for name in _CONSTANT.findall(rest)
        }
        for struct in _STRUCT.finditer(text)
    }


def _unclosed_comment(source: LcmFile) -> list[Problem]:
    for comment in COMMENT.finditer(source.content):
        if comment["unclosed"] is not None:
            line = source.content.count(b"\n", 0, comment.start()) + 1
            return [Problem(str(source.path), line, "this comment is not closed", "write */")]
    return []


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


def _output(copy: _Copy, root: Path, refused: Problem | None) -> Output:
    """Read the modules that lcm-gen has written below a folder for one file."""
    source, read, own = copy.source, copy.read, copy.own
    if faults := [*read.problems[:_MOST_PROBLEMS], *([refused] if refused else [])]:
        named = [f"{source.package}/{source.path.stem}"] if source.package else []
        lost = [*named, *_declared(read.text)]
        return Output([], [_fault(one, copy, lost) for one in faults])
    found: list[Generated] = []
    problems: list[Problem] = []
    for module in sorted(root.rglob("*.py")):
        *packages, short = module.relative_to(root).with_suffix("").parts
        package = ".".join(own.get(part, part) for part in packages)
        name = f"{package}/{own.get(short, short)}".lstrip("/")
        python = module.read_text("utf-8").replace(f"{TREE}.{root.name}.", f"{TREE}.")
        python = _IMPORT.sub("", python)  # ``loading`` provides what it imports
        python = as_values(python, _BASE)
        for member, value in _members(copy, name).items():
            python += f"{short}.{member} = {value!r}\n"
        one = _read_module(python, name, copy)
        if isinstance(one, Problem):
            problems.append(one)
        else:
            found.append(one)
    return Output(found, problems)


def _fault(problem: Problem, copy: _Copy, lost: Sequence[str]) -> Problem:
    what = _with_words(problem.what, copy.own)
    return problem._replace(file=str(copy.source.path), what=what, lost=lost)


def _members(copy: _Copy, name: str) -> dict[str, object]:
    """Return the members that a class needs beside those of lcm-gen."""
    texts = copy.read.texts.get(name, {}).items()
    members: dict[str, object] = {copy.renamed.get(n, n): text for n, text in texts}
    if kinds := copy.read.kinds.get(name):
        members["__constant_types__"] = kinds
    if copy.renamed:
        members |= {"__lcm_name__": name, "__renamed__": copy.own}
    return members


def _declared(text: str) -> list[str]:
    """Return the types in a .lcm file that lcm-gen refuses, as far as they can be made out."""
    found, package = [], ""
    for match in _DECLARATION.finditer(text):
        if match[1]:
            package = f"{match[1]}/"
        else:
            found.append(package + match[2])
    return found


def declared_packages(source: LcmFile) -> list[str]:
    """Return the packages in a file that may be wrong."""
    if source.package:
        return [source.package]
    return _PACKAGE.findall(without_comments(source.content).decode("utf-8", "replace"))


def unknown_type(one: Generated, missing: str, known: set[str]) -> Problem:
    """Return the problem for a type with a field of an unknown type."""
    short = missing.rpartition("/")[2]
    line = line_of(one.file, missing.replace("/", "."), short)
    near = _LCM_NAMES.get(short) or _like_primitive(short) or _like(missing, one, known)
    same = missing.rpartition("/")[0] == one.name.rpartition("/")[0]
    written = short if same else missing.replace("/", ".")
    if one.file.package:
        written, near = written.replace(".", "/"), near.replace(".", "/")
    suffix = ".msg" if one.file.package else ".lcm"
    hint = f"did you mean {near}?" if near else f"name the folder of its {suffix} file too"
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


def _like_primitive(name: str) -> str:
    """Return the primitive type of LCM that is misspelled; "" if none is."""
    from difflib import get_close_matches

    names = [*PRIMITIVES, *_LCM_NAMES] if name.islower() else []
    near = get_close_matches(name, names, 1, _NEARLY_THE_SAME)
    return _LCM_NAMES.get(near[0], near[0]) if near else ""


def _renamed(text: str, *more: Iterable[str]) -> dict[str, str]:
    """Return the words of a file that Python cannot spell, and their names in Python."""
    words = {*_WORD.findall(text), *chain.from_iterable(more)}
    spelled = {word: python_name(word, words) for word in words}
    return {word: name for word, name in spelled.items() if name != word}


def _with_words(text: str, others: Mapping[str, str]) -> str:
    return _WORD.sub(lambda word: others.get(word[0], word[0]), text)


def _base_hash(tables: Tables) -> int:
    parts = zip(*tables, strict=True)
    return base_hash(
        (name, kind if kind in PRIMITIVES else "", tuple(sizes or ()))
        for name, kind, sizes in parts
    )


def _read_module(python: str, name: str, copy: _Copy) -> Generated | Problem:
    """Return the type in a module, or the problem if Python cannot import it."""
    own, source = copy.own, copy.source
    match = _NUMBER.search(python)
    number = int(match[1], 16) if match else 0
    if "__typenames__" not in python:  # an enum
        named = {own.get(word, word): int(digits) for word, digits in _VALUE.findall(python)}
        return Generated(name, source, number, None, named, b"")
    try:
        tree: ast.Module | str = ast.parse(python)
    except (SyntaxError, ValueError) as error:
        what = f"{name}: lcm-gen does not make valid Python of it: {getattr(error, 'msg', error)}"
        return Problem(str(source.path), 0, what, "", name, (name,))
    tables = _respelled(_tables(cast("ast.Module", tree)), own)
    if own:  # lcm-gen has seen other names
        number = _base_hash(tables)
        tree = _HASH.sub(f"tmphash = ({number:#x}", python, count=1)
    code = marshal.dumps(compile(tree, f"<{name}>", "exec"))
    return Generated(name, source, number, tables, {}, code)


def _tables(tree: ast.Module) -> Tables:
    members = [node for one in tree.body if isinstance(one, ast.ClassDef) for node in one.body]
    values = {
        node.targets[0].id: node.value
        for node in members
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    return cast("Tables", tuple(ast.literal_eval(values[table]) for table in _TABLES))


def _respelled(tables: Tables, own: Mapping[str, str]) -> Tables:
    """Return tables with the names in the file."""
    names, kinds, dimensions = tables
    return (
        [own.get(name, name) for name in names],
        [".".join(own.get(part, part) for part in kind.split(".")) for kind in kinds],
        [sizes and [own.get(size, size) for size in sizes] for sizes in dimensions],  # type: ignore[arg-type] # numbers
    )


def line_of(source: LcmFile, *words: str) -> int:
    """Return the first line with one of the words outside of comments; 0 for none."""
    if source.package:
        lines = [line.partition(b"#")[0] for line in source.content.splitlines()]
    else:
        lines = without_comments(source.content).split(b"\n")
    for word in map(re.escape, map(str.encode, words)):
        alone = rb"(?<![\w.])%s(?![\w.])" % word
        for pattern in (rb"%s\s+\w+\s*[\[;]" % alone, alone):  # the type of a field, or any
            for number, line in enumerate(lines, 1):
                if re.search(pattern, line):
                    return number
    return 0
