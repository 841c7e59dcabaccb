"""Types that grow exponentially, and files for which a careless scanner needs hours."""

import struct
from collections.abc import Callable

import pytest
from fixtures.limits import cpu_limit

from lcmtools.messages.registry import Registry, fingerprint
from lcmtools.packages.expansion import DEEPEST, MOST_FIELDS, Expansion, TooManyFields
from lcmtools.packages.placed_type import comments
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.user_types import UserTypes

Types = Callable[..., UserTypes]

LARGE = 300_000  # bytes of a file, which may have a million


def near(types):
    found = types.workspace()
    assert found is not None
    return found


def doubled(depth, field="T{0} a; T{0} b;"):
    rows = (f"struct T{n + 1} {{ {field.format(n)} }}\n" for n in range(depth))
    return "package boom;\nstruct T0 { int8_t x; }\n" + "".join(rows)


def test_a_type_that_doubles_is_refused_from_where_it_is_too_large(write, types_of):
    with cpu_limit():
        source = near(types_of(write({"boom.lcm": doubled(40)})))
    usable = {f"boom/T{n}" for n in range(13)}  # T12 has 2^12 of the first, and 2^13 - 2 of others
    assert set(source.fingerprints) == usable
    problem = next(one for one in source.problems if one.type == "boom/T13")
    assert problem.what == "boom/T13 has more than 20000 fields, with those of their types"
    assert len(source.problems) == 28


@pytest.mark.parametrize(
    "field",
    [
        "int32_t n; T{0} a[n]; T{0} b[n];",
        "int32_t n; T{0} a[n]; T{0} b[n]; T40 c[n];",
        "int32_t n; T{0} a[n]; T{0} b[n]; T39 c[n]; T40 d[n];",
    ],
    ids=["arrays", "arrays of the last", "arrays of the last two"],
)
def test_types_that_double_in_arrays_are_refused_too(field, write, types_of):
    with cpu_limit():
        source = near(types_of(write({"boom.lcm": doubled(40, field)})))
    assert "boom/T40" not in source.fingerprints


def test_types_nested_too_deeply_are_refused(write, types_of):
    with cpu_limit():
        source = near(types_of(write({"boom.lcm": doubled(300, "T{0} a;")})))
    assert len(source.fingerprints) == DEEPEST
    assert "contains types more than 100 levels deep" in source.problems[0].what


@pytest.mark.parametrize("depth", [0, 1, 5, 12])
def test_fingerprints_are_those_of_lcm_gen(depth, write, types_of):
    types = types_of(write({"boom.lcm": doubled(12)}))
    kind = Registry([], lambda: types).message_class(f"boom/T{depth}")
    recursive = kind._get_hash_recursive([])
    assert fingerprint(kind) == recursive == near(types).fingerprints[f"boom/T{depth}"]
    assert kind().encode()[:8] == struct.pack(">Q", recursive)


def test_a_type_with_too_many_elements_is_refused(write, types_of):
    source = near(types_of(write({"a.lcm": "struct T { double x[20000000]; }"})))
    assert source.problems[0].what == "T has 20000000 elements, more than 10000000"


def test_fields_are_counted_with_those_of_their_types():
    expansion = Expansion({1: [0, 0], 2: [2, 1]}, {0: 2, 1: 3, 2: 2})  # 2 contains itself
    assert [expansion.fields(place) for place in range(3)] == [2, 7, 9]
    with pytest.raises(TooManyFields):
        Expansion({}, {0: MOST_FIELDS + 1}).fields(0)


SCANNED = {
    "comments that are not closed": "/*",
    "structs that are not closed": "struct A {",
    "braces that are not closed": "{",
    "a long name": "a",
    "a constant's long name": "const a",
    "packages": "package ",
    "blanks": " ",
    "lines of comments": "//\n",
    "quotes": '"',
    "brackets": "a[1]",
}
"""Parts of which a large file may consist."""


@pytest.mark.parametrize("part", SCANNED.values(), ids=SCANNED)
@pytest.mark.parametrize("start", ["", "struct T { const int32_t ", "struct T { int32_t a;\n"])
def test_a_large_file_is_scanned_once(part, start, write, types_of):
    text = start + part * (LARGE // len(part))
    folder = write({"own/T.lcm": text, "own/msg/T.msg": text})
    with cpu_limit():
        near(types_of(folder))
        comments(LcmFile("T.lcm", text.encode()), "T")


def test_a_comment_that_is_not_closed_is_named(write, types_of):
    source = near(types_of(write({"a.lcm": "struct T { byte a; }\n/* the end\n"})))
    assert (source.problems[0].line, source.problems[0].what) == (2, "this comment is not closed")
