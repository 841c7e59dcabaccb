"""lcm-gen is the judge of our parser: the same types, or a text is refused, and says why."""

import importlib
import re
import subprocess
import sys
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fields import fields, visible_fields
from lcmtools.messages.registry import Registry, fingerprint
from lcmtools.packages.lcm_gen import find_lcm_gen
from lcmtools.packages.lcm_parser import SyntaxFault, parse
from lcmtools.packages.user_types import UserTypes
from lcmtools.types.fingerprints import FINGERPRINTS

HERE = Path(__file__).parent
FILES = sorted((*HERE.rglob("*.lcm"), *HERE.parents[1].glob("lcm_types/*/*.lcm")))
PRIMITIVES = ("boolean", "byte", "int8_t", "int16_t", "int32_t", "int64_t", "float", "double")
INTEGERS = ("int8_t", "int16_t", "int32_t", "int64_t")
NAMES = ("a", "b1", "_c", "Size", "utime", "values", "x_y")


def lcm_gen(folder, text, *options):
    """Run lcm-gen on a text; return its error, "" for none."""
    (folder / "text.lcm").write_text(text)
    command = [find_lcm_gen(), "--python", "--ppath", str(folder), *options, "text.lcm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr if done.returncode else ""


def fault(text):
    """What our parser says against a text; "" for nothing."""
    try:
        parse(text)
    except SyntaxFault as found:
        return found.what
    return ""


BOTH_REFUSE = """\
struct A{ int8_t x; }
struct A {}
struct A { int8_t x }
struct A { int8_t x y; }
struct A { int8_t x; };
struct A { int8_t x;; }
struct A { int8_t x,; }
struct A { ; }
struct A { int8_t x; }}
struct A { int8_t x[]; }
struct A { int8_t x[0]; }
struct A { int8_t x[-1]; }
struct A { int8_t x[n]; }
struct A { byte n; byte x[n]; }
struct A { int8_t n[2]; byte x[n]; }
struct A { int8_t n; byte x[n+1]; }
struct A { int8_t x[2; }
struct A { int8_t 1x; }
struct A { int8_t x = 3; }
struct A { const string X="a"; }
struct A { const byte X=3; }
struct A { const int8_t X=128; }
struct A { const int8_t X=0xff; }
struct A { const int32_t X=1.5; }
struct A { const int32_t X=; }
struct A { const int32_t X=+1; }
struct A { const int8_t X=1,; }
struct A { const float X=1e39; }
struct A { const double D=3; byte x[D]; }
struct A { const int32_t N=2; double N[N]; }
struct A { int8_t x; int16_t x; }
struct A { struct x; }
struct A { int8_t x; } struct A { int8_t y; }
struct A { int8_t x;
package a struct A { int8_t x; }
package ; struct A { int8_t x; }
enum E{ A }
enum E { A, A }
enum E { A=1, B=1 }
enum E { A=x }
int8_t x;
struct
"""
WE_REFUSE = """\
struct 1A { int8_t x; }
struct A { int8_t a.b; }
struct A { int8_t x-y; }
struct A { a..b x; }
struct A { byte x[010]; }
struct A { int8_t n; byte x[2n]; }
struct A { const int32_t X=-3; byte x[X]; }
struct A { const int64_t X=9223372036854775808; }
struct A { const double X=inf; }
struct a.A { int8_t x; }
package a.b.; struct A { int8_t x; }
enum E { A=99999999999 }
enum E { A(3) }
"""
"""Texts of which lcm-gen makes code that does not compile, or that other languages cannot read."""


@pytest.mark.parametrize("text", BOTH_REFUSE.splitlines())
def test_what_lcm_gen_refuses_is_refused(text, tmp_path):
    assert fault(text)
    if text != "enum E { A=x }":  # of which lcm-gen makes 0
        assert lcm_gen(tmp_path, text)


@pytest.mark.parametrize("text", WE_REFUSE.splitlines())
def test_what_only_we_refuse_has_a_reason(text, tmp_path):
    assert fault(text)
    assert not lcm_gen(tmp_path, text)


def loaded(folder, package):
    """Import the package that lcm-gen has written into a folder."""
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    try:
        return importlib.import_module(package)
    finally:
        sys.path.remove(str(folder))
        for name in [one for one in sys.modules if one.partition(".")[0] == package]:
            del sys.modules[name]


def assert_same(folder, text):
    """Compare our classes of a text with those of lcm-gen: tables, fingerprints and bytes."""
    assert lcm_gen(folder, text) == ""
    packages = {found[1] for found in re.finditer(r"^package (\w+);", text, re.MULTILINE)}
    theirs = {package: loaded(folder, package) for package in packages}
    environment = {"LCMTOOLS_TYPE_PATH": str(folder), "XDG_CACHE_HOME": str(folder / "cache")}
    types = UserTypes(environment, [], FINGERPRINTS)
    known = Registry([], lambda: types)
    assert not known.problems()
    for name in known.enum_names():
        package, _, short = name.rpartition("/")
        judge = getattr(theirs[package], short)
        ours = known.enum_class(name)
        assert ours.__hash_number__ == judge._get_hash_recursive([])
        members = {k: v for k, v in constants(judge).items() if type(v) is int}
        assert dict(ours.__members__) == members
        judge.__init__.__defaults__ = (0,)  # without one, lcm-gen's structs cannot create it
    for name in known.type_names():
        package, _, short = name.rpartition("/")
        compare(known.message_class(name), getattr(theirs[package], short), package)


def constants(cls):
    """Return a class's numbers, without those that Python 3.13 adds, as of its first line."""
    found = {name: value for name, value in vars(cls).items() if not name.startswith("__")}
    return {name: value for name, value in found.items() if isinstance(value, (int, float))}


def compare(ours, theirs, package):
    own = f"{ours.__module__.partition('.')[0]}.{package}."
    assert ours.__slots__ == theirs.__slots__
    assert ours.__dimensions__ == theirs.__dimensions__
    kinds = [kind.replace(own, f"{package}.") for kind in ours.__typenames__]
    assert kinds == theirs.__typenames__
    assert fingerprint(ours) == int.from_bytes(theirs._get_packed_fingerprint(), "big")
    for name, value in constants(theirs).items():
        assert getattr(ours, name) == value
    payload = encode(sample(ours))
    assert theirs.decode(payload).encode() == payload
    assert encode(decode(ours, payload)) == payload
    assert ours.decode(payload).encode() == payload


def sample(cls, depth=0):
    """A message with a value in each field."""
    message = cls()
    for number, field in enumerate(visible_fields(cls), 1):
        counts = [size if isinstance(size, int) else 2 * (depth < 3) for size in field.dimensions]
        value = {"bool": True, "string": "text"}.get(field.type, number)
        if field.message_class and 0 not in counts:  # a type holds itself in such arrays alone
            value = sample(field.message_class, depth + 1)
        for count in reversed(counts):
            value = [value] * count
        if field.is_bytes and field.depth == 1:
            value = bytes(value)
        setattr(message, field.attribute, value)
    assert len(fields(cls)) == len(cls.__slots__)
    return message


@st.composite
def texts(draw):
    """The text of a package with enums and structs, which hold those before and arrays of any."""
    lines, known = ["package judged; // a /* comment"], [*PRIMITIVES, "string"]
    for number in range(draw(st.integers(0, 2))):
        values = draw(st.lists(st.sampled_from(NAMES), unique=True, max_size=3))
        marks = [
            draw(st.sampled_from(["", f"={10 * at}", f" = -0x{at + 1}"]))
            for at, _ in enumerate(values)
        ]
        items = ", ".join(map("".join, zip(values, marks, strict=True)))
        lines.append(f"enum E{number} {{ {items} }} /* {{ */")
        known.append(f"E{number}")
    count = draw(st.integers(1, 3))
    for number in range(count):
        lines.append(draw(structs(number, tuple(known), count)))
        known += [f"S{number}", f"judged.S{number}"]
    return "\n".join(lines)


@st.composite
def structs(draw, number, known, count):
    names = draw(st.lists(st.sampled_from(NAMES), unique=True, min_size=1))
    sizes, lines = ["1", "3"], []
    if draw(st.booleans()):
        lines.append(
            f"const {draw(st.sampled_from(INTEGERS))} MOST = 2, HEX=0x1F; const double D=-.5e1;"
        )
        sizes.append("MOST")
    for name in names:
        dimensions = draw(st.lists(st.sampled_from(sizes), max_size=2))
        kind = draw(st.sampled_from(known))
        if any(size in NAMES for size in dimensions):
            kind = draw(st.sampled_from((*known, *(f"S{at}" for at in range(count)))))
        lines.append(f"  {kind} {name}{''.join(f'[ {size}]' for size in dimensions)};")
        if kind in INTEGERS and not dimensions:
            sizes.append(name)
    return "\n".join([f"struct S{number} {{ // {{", *lines, "}"])


@settings(max_examples=6, deadline=None)
@given(st.lists(texts(), min_size=4, max_size=4))  # for one start of lcm-gen
def test_generated_types_are_the_same(found):
    named = (text.replace("judged", f"judged{number}") for number, text in enumerate(found))
    with TemporaryDirectory() as folder:
        assert_same(Path(folder), "\n".join(named))


def test_types_that_hold_each_other_are_the_same(tmp_path):
    fields = "int8_t n; {0} one[n]; {0} two[2][n]; {0}"
    texts = [f"struct {a} {{ {fields.format(b)} three[n][n]; }}" for a, b in ("XY", "YZ", "ZX")]
    assert_same(tmp_path, " ".join(["package judged;", *texts]))


def test_a_size_that_is_not_decimal_is_hashed_as_it_is_written(tmp_path):
    text = "package judged; struct A { const int8_t N=0x03; byte x[0x10], y[N]; }"
    assert lcm_gen(tmp_path, text) == ""
    assert f"{parse(text)[0].number:#x}" in (tmp_path / "judged" / "A.py").read_text()
    assert [field.sizes for field in parse(text)[0].fields] == [(16,), (3,)]


def test_every_file_has_the_hashes_of_lcm_gens_c(tmp_path):
    """Also of types that lcm-gen's Python cannot spell."""
    for number, (_, found) in enumerate(groupby(FILES, lambda file: file.parent)):
        (folder := tmp_path / str(number)).mkdir()
        texts = {file: file.read_text() for file in found}
        files = sorted(texts, key=lambda file: "package " in texts[file])  # it stays for the next
        command = [find_lcm_gen(), "-c", "--c-cpath", folder, "--c-hpath", folder, *files]
        subprocess.run(command, check=True, capture_output=True)
        structs = (one for text in texts.values() for one in parse(text) if one.values is None)
        for one in structs:
            code = folder / f"{one.name.replace('/', '_').replace('.', '_')}.c"
            hashed = re.search(r"= (?:\(uint64_t\))?(0x\w+?)(?:LL)?\s", code.read_text())
            assert hashed, one.name
            assert int(hashed[1], 16) == one.number, one.name
