"""lcm-gen, which comes with the lcm package: run on type files, for any of its languages.

Belongs here: finding it, running it, and what its code lacks. Must not know which types exist.
"""

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from keyword import kwlist
from pathlib import Path

from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.folders import write_whole
from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.type_source import Problem
from lcmtools.packages.lcm_parser import LcmField, LcmType, without_comments
from lcmtools.packages.placed_type import file_types, parse_file
from lcmtools.packages.python_code import as_portable_values
from lcmtools.packages.ros_files import SUFFIXES, package_of, to_lcm
from lcmtools.packages.type_files import LcmFile

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


def run_lcm_gen(file: Path, options: Sequence[str]) -> str:
    """Run lcm-gen on a file; return the first line that it says against it, "" for nothing."""
    import subprocess

    try:
        done = subprocess.run(  # noqa: S603 - lcm-gen, with paths as arguments
            [find_lcm_gen(), *options, str(file)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=_LONGEST,
            text=True,
            errors="replace",
            check=False,
        )
    except (subprocess.TimeoutExpired, OSError, ValueError) as error:
        return f"lcm-gen cannot read this: {error}"
    lines = [line.strip() for line in done.stdout.splitlines() if line.strip()]
    return (lines or ["lcm-gen rejects it without a reason"])[0] if done.returncode else ""


def generate_code(files: Iterable[Path], language: str, folder: Path) -> list[Path]:
    """Write code for type files into a folder; return the written files, sorted.

    Other files in the folder are kept; files with the same names are overwritten. C++ compiles with
    every liblcm from 1.3.1 on.

    Raises:
        InvalidFile: A file is wrong, or a name in it is a keyword of the language; then
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
                package = package_of(file) if file.suffix in SUFFIXES else ""
                source = LcmFile(str(file), file.read_bytes(), package)
                types = file_types(source, parse_file(source))
                if package:
                    translated.write_text(to_lcm(file, source.content, package).text)
                lcm = translated if package else file
                for problem in (*types.problems, *_keywords(file, lcm, language)):
                    raise problem.error()
                if fault := run_lcm_gen(lcm, options):
                    raise Problem(str(file), 0, fault).error()
                if language == "cpp":
                    _complete_cpp((one.type for one in types.types), scratch)
            translated.write_bytes(bytes(_ROOM))  # lcm-gen does not report a full disk
            made = sorted(one.relative_to(scratch) for one in scratch.rglob("*") if one.is_file())
            for path in made:
                _copy(scratch / path, folder / path)
    except OSError as error:
        where = error.filename or folder
        raise LcmtoolsError(f"cannot write {where}: {error.strerror}") from error
    return [folder / path for path in made]


def _keywords(file: Path, lcm: Path, language: str) -> Iterator[Problem]:
    """Yield the keywords of a language among the names in a file, whose text is ``lcm``."""
    name, words = _KEYWORDS[language]
    pattern = re.compile(rf"\b({'|'.join(words)})\b")
    text = without_comments(lcm.read_bytes().decode("utf-8", "replace"))
    for found in pattern.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        what = f"'{found[0]}' is a keyword of {name}"
        yield Problem(str(file), line, what, "use another name")


def _complete_cpp(types: Iterable[LcmType], folder: Path) -> None:
    """Write the C++ that lcm-gen's lacks in a folder."""
    for one in types:
        *package, name = one.name.replace("/", ".").split(".")
        path = folder.joinpath(*package, f"{name}.hpp")
        if one.values is None:
            path.write_text(with_lengths(path.read_text("utf-8"), one.fields), "utf-8")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(enum_header(package, name, one.values, one.number), "utf-8")


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


def _joined(new: Path, old: Path) -> str:
    """Keep the imports of an earlier run in a package, as lcm-gen itself does."""
    known = old.read_text("utf-8").splitlines()
    more = [line for line in new.read_text("utf-8").splitlines() if line.startswith("from ")]
    return "\n".join([*known, *(line for line in more if line not in known), ""])


_HEADER = """\
// Generated by lcmtools: lcm-gen writes no C++ for enums.
#pragma once

#include <lcm/lcm_coretypes.h>

{opening}class {name} {{
 public:
  enum Value : int32_t {{ {values} }};
  {name}(int32_t number = 0) : value(number) {{}}
  operator int32_t() const {{ return value; }}

  int32_t value;

  static uint64_t _computeHash(const __lcm_hash_ptr*) {{ return {number}; }}
  int _getEncodedSizeNoHash() const {{ return 4; }}
  int _encodeNoHash(void* buffer, int offset, int size) const {{
    return __int32_t_encode_array(buffer, offset, size, &value, 1);
  }}
  int _decodeNoHash(const void* buffer, int offset, int size) {{
    return __int32_t_decode_array(buffer, offset, size, &value, 1);
  }}
}};
{closing}"""

_SUPPORT = "        // LCM support functions."
_LENGTHS = """\
        // For lcmtools, which refuses to publish a length that is not that of its array.
        template <class Check>
        void _checkLengths(const Check& check) const
        {{
{calls}
        }}

"""


def enum_header(package: Sequence[str], name: str, values: Mapping[str, int], number: int) -> str:
    """Return the header of an enum; ``number`` is its hash."""
    return _HEADER.format(
        opening="".join(f"namespace {part} {{\n" for part in package),
        name=name,
        values=", ".join(f"{value} = {digits}" for value, digits in values.items()),
        number=f"{number:#x}",
        closing="}\n" * len(package),
    )


def with_lengths(header: str, fields: Sequence[LcmField]) -> str:
    """Return a struct's header with a function that names its arrays, their lengths and structs."""
    calls = [_call(one) for one in fields if not (one.is_fixed and one.type in PRIMITIVES)]
    lengths = _LENGTHS.format(calls="\n".join(f"            {call}" for call in calls))
    return header.replace(_SUPPORT, lengths + _SUPPORT, 1) if calls else header


def _call(field: LcmField) -> str:
    sizes = () if field.is_fixed else field.sizes
    lengths = [str(size) if isinstance(size, int) else f"this->{size}" for size in sizes]
    words = ", ".join((f'"{field.name}"', f"this->{field.name}", *lengths))
    return f"check({words});"
