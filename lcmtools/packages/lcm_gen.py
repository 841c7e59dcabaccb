"""lcm-gen, which comes with the lcm package: run on type files, for any of its languages.

Belongs here: finding it, running it, the meaning of its errors. Must not know which types exist.
"""

import os
import re
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from itertools import pairwise
from keyword import kwlist
from pathlib import Path

from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.folders import write_whole
from lcmtools.messages.type_source import Problem
from lcmtools.packages.cpp_enums import enum_header
from lcmtools.packages.lcm_parser import without_comments
from lcmtools.packages.python_code import as_portable_values
from lcmtools.packages.ros_files import SUFFIXES, package_of, to_lcm

_OPTIONS = {
    "c": ("--c", "--c-cpath", "{}", "--c-hpath", "{}"),
    "cpp": ("--cpp", "--cpp-std", "c++11", "--cpp-hpath", "{}"),
    "java": ("--java", "--jpath", "{}"),
    "python": ("--python", "--ppath", "{}"),
}
LANGUAGES = tuple(_OPTIONS)

_FUNCTION = re.compile(r"(?:(?<=fp->v == )|(?<== \{ p, ))(\w+::getHash)")
_CAST = r"reinterpret_cast<decltype(__lcm_hash_ptr::v)>(\1)"  # v is a void* in liblcm 1.3.1

_C = """
    auto break case char continue default do else extern for goto if inline int long register
    restrict return short signed sizeof static switch typedef union unsigned void volatile while
"""
_CPP = f"""
    {_C} alignas alignof and and_eq asm bitand bitor bool catch class compl constexpr const_cast
    decltype delete dynamic_cast explicit export false friend mutable namespace new noexcept not
    not_eq nullptr operator or or_eq private protected public reinterpret_cast static_assert
    static_cast template this thread_local throw true try typeid typename using virtual wchar_t xor
    xor_eq
"""
_JAVA = """
    abstract assert break case catch char class continue default do else extends false final finally
    for goto if implements import instanceof int interface long native new null private protected
    public return short static strictfp super switch synchronized this throw throws transient true
    try void volatile while
"""
_KEYWORDS = {
    "c": ("C", _C.split()),
    "cpp": ("C++", _CPP.replace("restrict", "").split()),
    "java": ("Java", _JAVA.split()),
    "python": ("Python", kwlist),
}
"""The words that no compiler takes as a name, without those of .lcm files themselves."""

_ROOM = 1 << 16  # [B]; if this much is free, no file was truncated
_LONGEST = 30.0  # [s] for one file; usually it takes milliseconds
_HINTS = {
    "expected token {": "lcm-gen wants a space or a new line before '{'",
    "expected token ;": "a ';' is missing before this",
    "expected token }": "a '}' is missing, or lacks a space before it",
    "missing struct token.": "a file is  package name;  and then  struct Name { ... }",
}
_ARRAY = re.compile(r"([A-Za-z_][\w.]*)\s+([A-Za-z_]\w*)\s*\[\s*\]", re.ASCII)
_LENGTH = re.compile(
    r"(?:Unknown variable array index|Array dimension) '(\w+)'(?:\. Index| must be an integer)"
)


def find_lcm_gen() -> str:
    """Return the path of lcm-gen; MissingExtra if there is none."""
    spec = find_spec("lcm")
    if spec and spec.origin:  # the program itself: the one on the PATH starts a Python first
        program = Path(spec.origin).parent.parent / "bin" / "lcm-gen"
        if os.access(program, os.X_OK):
            return str(program)
    import shutil

    program_on_path = shutil.which("lcm-gen")
    if program_on_path is None:
        raise MissingExtra("lcm-gen is not installed", "type: pip install lcm")
    return program_on_path


def run_lcm_gen(files: Sequence[Path], options: Sequence[str]) -> Problem | None:
    """Run lcm-gen on files; return the first problem, None if all are correct.

    Each of several files must name its package: lcm-gen applies it to the next file if not. The
    problem's file is "" if lcm-gen does not say which one it is.
    """
    import subprocess

    command, only = (
        [find_lcm_gen(), *options, *map(str, files)],
        files[0] if len(files) == 1 else "",
    )
    try:
        done = subprocess.run(  # noqa: S603 - lcm-gen, with paths as arguments
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=_LONGEST,
            text=True,
            errors="replace",
            check=False,
        )
    except (subprocess.TimeoutExpired, OSError, ValueError) as error:
        return Problem(str(only), 0, f"lcm-gen cannot read this: {error}")
    return _problem(files, done.stdout) if done.returncode else None


def generate_code(files: Iterable[Path], language: str, folder: Path) -> list[Path]:
    """Write code for type files into a folder; return the written files, sorted.

    Other files in the folder are kept; files with the same names are overwritten. C++ compiles with
    every liblcm from 1.3.1 on.

    Raises:
        InvalidFile: lcm-gen refuses a file, or a name in it is a keyword of the language; then
            nothing is written.
        LcmtoolsError: The folder cannot be written.
        MissingExtra: There is no lcm-gen.
    """
    import tempfile

    try:
        with tempfile.TemporaryDirectory(prefix="lcmtools-generate-") as name:
            scratch, translated = Path(name, "made"), Path(name, "file.lcm")
            scratch.mkdir()
            options = [word.format(scratch) for word in _OPTIONS[language]]
            for file in files:
                if is_ros := file.suffix in SUFFIXES:
                    translated.write_text(to_lcm(file, file.read_bytes(), package_of(file)).text)
                problem = run_lcm_gen([translated if is_ros else file], options)
                problem = problem or _keyword(file, translated if is_ros else file, language)
                if problem:
                    raise problem.error()
                if language == "cpp" and b"enum" in file.read_bytes():
                    _write_enums(file, Path(name), scratch)
            translated.write_bytes(bytes(_ROOM))  # lcm-gen does not report a full disk
            made = sorted(one.relative_to(scratch) for one in scratch.rglob("*") if one.is_file())
            for path in made:
                _copy(scratch / path, folder / path)
    except OSError as error:
        where = error.filename or folder
        raise LcmtoolsError(f"cannot write {where}: {error.strerror}") from error
    return [folder / path for path in made]


def _keyword(file: Path, lcm: Path, language: str) -> Problem | None:
    """Return the first keyword of a language among the names in a file, whose text is ``lcm``."""
    name, words = _KEYWORDS[language]
    pattern = re.compile(rf"\b({'|'.join(words)})\b")
    text = without_comments(lcm.read_bytes().decode("utf-8", "replace"))
    if not (found := pattern.search(text)):
        return None
    line = text.count("\n", 0, found.start()) + 1
    return Problem(str(file), line, f"'{found[0]}' is a keyword of {name}", "use another name")


def _write_enums(file: Path, root: Path, folder: Path) -> None:
    """Write the C++ of a file's enums into a folder, beside that of lcm-gen."""
    run_lcm_gen([file], ["--python", "--python-no-init", "--ppath", str(root / "python")])
    for module in (root / "python").rglob("*.py"):
        path = module.relative_to(root / "python").with_suffix(".hpp")
        if text := enum_header([*path.parent.parts], path.stem, module.read_text("utf-8")):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text, "utf-8")


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.name == "__init__.py" and target.exists():
        _write(target, _joined(source, target))
    elif source.suffix == ".py":
        _write(target, as_portable_values(source.read_text("utf-8")))
    elif source.suffix == ".hpp":
        text = source.read_text("utf-8")
        _write(target, _FUNCTION.sub(_CAST, text))
    else:
        _write(target, source.read_bytes())


def _write(target: Path, content: str | bytes) -> None:
    """Write a file; one that has this content keeps its time, so that nothing is compiled again."""
    new = content.encode() if isinstance(content, str) else content
    if not target.is_file() or target.read_bytes() != new:
        write_whole(target, new)


def _problem(files: Sequence[Path], output: str) -> Problem:
    """Parse lcm-gen's error: a sentence, ``FILE : LINE``, and the line itself."""
    known = set(map(str, files))
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    for number, (before, line) in enumerate(pairwise(lines), 2):
        if (place := re.fullmatch(r"(.+) : (\d+)", line)) and place[1] in known:
            hint = _hint(before, "".join(lines[number : number + 1]))
            return Problem(place[1], int(place[2]), before.rstrip("."), hint)
    what = lines[0] if lines else "lcm-gen rejects it without a reason"
    return Problem(str(files[0]) if len(files) == 1 else "", 0, what)


def _hint(fault: str, line: str) -> str:
    """Return the remedy for an error of lcm-gen in a line of a file."""
    if unknown := _LENGTH.match(fault):
        return f"declare  int32_t {unknown[1]};  above the array"
    if array := _ARRAY.search(line):
        kind, name = array.groups()
        length = f"{name}_length"
        return f"declare its length:  int32_t {length};  {kind} {name}[{length}];"
    return next((hint for start, hint in _HINTS.items() if fault.lower().startswith(start)), "")


def _joined(new: Path, old: Path) -> str:
    """Keep the imports of an earlier run in a package, as lcm-gen itself does."""
    known = old.read_text("utf-8").splitlines()
    more = [line for line in new.read_text("utf-8").splitlines() if line.startswith("from ")]
    return "\n".join([*known, *(line for line in more if line not in known), ""])
