"""Errors for what users type that does not fit the message."""

import contextlib

import pytest
from fixtures.says import assert_says, raises_saying
from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.messages.documents import parse_values
from lcmtools.messages.message_template import draft_from_values, drafts_from_lines
from lcmtools.messages.registry import message_class
from lcmtools.types import std_msgs


def quote(start):
    return f"put text that begins with '{start}' in quotes"


TWIST, VECTOR = "geometry_msgs/Twist", "geometry_msgs/Vector3"


@pytest.mark.parametrize(
    ("name", "texts", "line"),
    [
        (TWIST, ["linear: {x: fast}"], "linear.x: expected a number, got 'fast'"),
        (TWIST, ["linear: {x: 1_000}"], "linear.x: expected a number, got '1_000'"),
        (TWIST, ["linear: {x: true}"], "linear.x: expected a number, got 'true'"),
        (TWIST, ["linear: {x: }"], "linear.x: expected a number, got nothing"),
        (TWIST, ["linear: {x: ''}"], "linear.x: expected a number, got ''"),
        (TWIST, ["linear: {x: [1]}"], "linear.x: expected a number, got a list"),
        (TWIST, ["linear: {x: !!binary aGk=}"], "linear.x: expected a number, got binary data"),
        (TWIST, ["linear: {x: 1e999}"], "linear.x: 1e999 does not fit float64"),
        (TWIST, ["linear: {x: ٣}"], "linear.x: expected a number, got '٣'"),
        (
            TWIST,
            ["lineal: {x: 1}"],
            (
                "lineal: geometry_msgs/Twist has no field 'lineal' (fields: linear, angular); "
                "did you mean 'linear'?"
            ),
        ),
        (
            TWIST,
            ["linear:\n  x:1"],
            "linear: expected fields (x, y, z), got 'x:1'; put a space after the colon: 'x: 1'",
        ),
        (TWIST, ["fast"], "geometry_msgs/Twist: expected fields (linear, angular), got 'fast'"),
        (TWIST, ["linear: 5"], "linear: expected fields (x, y, z), got '5'"),
        (TWIST, ["[1, 2, 3]"], "geometry_msgs/Twist: expected 2 values (linear, angular), got 3"),
        (TWIST, ["1", "2", "3"], "geometry_msgs/Twist: expected 2 values (linear, angular), got 3"),
        (VECTOR, ["1", "2"], "geometry_msgs/Vector3: expected 3 values (x, y, z), got 2"),
        (
            "std_msgs/Empty",
            ["x: 1"],
            "x: std_msgs/Empty has no field 'x' (it has no fields)",
        ),
        (
            TWIST,
            ["x: 1"],
            (
                "x: geometry_msgs/Twist has no field 'x' (fields: linear, angular);"
                " write {linear: {x: ...}}"
            ),
        ),
        (
            TWIST,
            ["linear.x: 1"],
            (
                "linear.x: geometry_msgs/Twist has no field 'linear.x' (fields: linear, angular);"
                " write {linear: {x: ...}}"
            ),
        ),
        (
            TWIST,
            ["{angular: {z: 0,5}}"],
            (
                "angular.5: geometry_msgs/Vector3 has no field '5' (fields: x, y, z);"
                " numbers have a decimal point, no comma: 0.5"
            ),
        ),
        ("std_msgs/Empty", ["1"], "std_msgs/Empty: expected no fields, got '1'"),
        ("std_msgs/Empty", ["1", "2"], "std_msgs/Empty: expected no fields, got 2"),
        ("std_msgs/Int8", ["3e2"], "data: 3e2 does not fit int8 (-128..127)"),
        ("std_msgs/Int8", ["1e999999999"], "data: 1e999999999 does not fit int8 (-128..127)"),
        ("std_msgs/Int8", ["0x80"], "data: 0x80 does not fit int8 (-128..127)"),
        ("std_msgs/Int8", ["1e-1"], "data: expected an integer, got '1e-1'"),
        ("std_msgs/Int8", ["five"], "data: expected an integer, got 'five'"),
        ("std_msgs/Int8", ["1_0"], "data: expected an integer, got '1_0'"),
        (
            "std_msgs/Int64",
            ["1" * 5000],
            f"data: expected an integer, got '{'1' * 35}...'",
        ),
        ("std_msgs/Float64", [f"0x{'f' * 300}"], f"data: 0x{'f' * 300} does not fit float64"),
        ("std_msgs/Bool", ["2"], "data: expected true or false, got '2'"),
        ("std_msgs/String", ["data: {a: b}"], "data: expected text, got a mapping"),
        (
            "sensor_msgs/LaserScan",
            ["ranges: 5"],
            "ranges: expected a list of numbers, got '5'",
        ),
        (
            "sensor_msgs/LaserScan",
            ["ranges:"],
            "ranges: expected a list of numbers, got nothing",
        ),
        ("sensor_msgs/LaserScan", ["ranges: [1, x]"], "ranges[1]: expected a number, got 'x'"),
        (
            "nav_msgs/Path",
            ["poses: [{}, {pose: {position: [1, 2, z]}}]"],
            "poses[1].pose.position.z: expected a number, got 'z'",
        ),
        ("nav_msgs/Path", ["poses: [5]"], "poses[0]: expected fields (header, pose), got '5'"),
        (
            "sensor_msgs/CompressedImage",
            ["data: [1, 256]"],
            "data[1]: 256 does not fit uint8 (0..255)",
        ),
        (
            "std_msgs/Time",
            ["{sec: 1, secs: 2}"],
            "std_msgs/Time: 'sec' is given twice, once as 'secs'",
        ),
    ],
)
def test_what_does_not_fit_is_named_with_its_path(name, texts, line):
    with pytest.raises(ValueMismatch) as caught:
        draft_from_values(message_class(name), texts)
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "x: 1\ny: 2\nx: 3",
            "bad YAML at line 3, column 1: 'x' is given twice; leave one of them out",
        ),
        ("a: {x: [1, 2", "bad YAML at line 1, column 8: this '[' is not closed"),
        ("{x: {y:", "bad YAML from line 1 on: a bracket is not closed"),
        ("]", "bad YAML at line 1, column 1: did not find expected node content"),
        ("x: 'a", "bad YAML at line 1, column 4: this quote is not closed"),
        ('x: "a', "bad YAML at line 1, column 4: this quote is not closed"),
        (
            "{x: {}; y: 2}",
            (
                "bad YAML at line 1, column 7: did not find expected ',' or '}'; "
                "put a comma between fields"
            ),
        ),
        (
            "x: 1\n  y: 2",
            (
                "bad YAML at line 2, column 4: mapping values are not allowed in this context; "
                "indent the keys of an entry equally"
            ),
        ),
        *(
            (
                f"x: {mark}a",
                f"bad YAML at line 1, column 4: text cannot begin with '{mark}'; put it in quotes",
            )
            for mark in "@`%"
        ),
        ("x:\n\ty: 1", "bad YAML at line 2, column 1: a tab cannot indent; indent with spaces"),
        (
            "x:1\ny: 2",
            (
                "bad YAML at line 2, column 2: mapping values are not allowed in this context; "
                "put a space after the colon: 'x: 1'"
            ),
        ),
        ("\t- x", "bad YAML at line 1, column 1: a tab cannot indent; indent with spaces"),
        ("x: *b", f"bad YAML at line 1, column 4: unknown alias '*b'; {quote('*')}"),
        ("&a [*a]", f"bad YAML at line 1, column 5: unknown alias '*a'; {quote('*')}"),
        ("x: !!binary =", "bad YAML at line 1, column 4: !!binary is not followed by base64"),
        (
            "x: !!set {a}",
            f"bad YAML at line 1, column 4: the tag !!set is not supported here; {quote('!')}",
        ),
        (
            "!!python/object:os.system ls",
            (
                "bad YAML at line 1, column 1: the tag !!python/object:os.system is not supported"
                f" here; {quote('!')}"
            ),
        ),
        (
            "? [a]\n: b",
            f"bad YAML at line 1, column 3: a key must be a word; {quote('{{')}",
        ),
        (
            "{&a [b]: c}",
            f"bad YAML at line 1, column 2: a key must be a word; {quote('{{')}",
        ),
        ("[&a [b], {*a : c}]", "bad YAML at line 1, column 11: a key must be a word"),
        ("x: a\ny: \x07", "bad YAML at line 2, column 4: the character U+0007 is not allowed"),
        ("x: \udcff", "bad YAML at line 1, column 4: the character U+DCFF is not allowed"),
        ("[" * 101, "bad YAML at line 1, column 101: nested more than 100 levels deep"),
        ("{a: " * 50_000, "bad YAML at line 1, column 401: nested more than 100 levels deep"),
        ("a\n---\nb", "2 YAML documents where one value is expected"),
    ],
)
def test_bad_yaml_is_named_with_its_place(text, line):
    with pytest.raises(ValueMismatch) as caught:
        parse_values([text])
    assert str(caught.value) == line


def test_aliases_may_not_fill_the_memory():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 10)]
    with raises_saying(ValueMismatch, "aliases", "100000"):
        parse_values(["\n".join(lines)])


def test_a_wrong_document_is_named_with_its_line_after_those_before_it():
    lines = ["data: 1", "---", "# more", "data: x", "---", "data: 3"]
    drafts = drafts_from_lines(std_msgs.Int8, lines)
    assert next(drafts)
    with pytest.raises(ValueMismatch) as caught:
        next(drafts)
    assert_says(str(caught.value), "document 2, line 4: data: ", "integer", "'x'")


@pytest.mark.parametrize(
    ("lines", "error"),
    [
        (["data: [1"], "document 2: bad YAML at line 3, column 7: this '\\[' is not closed"),
        (["", '{"data": ', "---"], "document 2: bad YAML from line 4 on: a bracket is not closed"),
        (['{"data": 2', '{"data": 3}'], "document 2: bad YAML at line 4, column 1: did not find"),
    ],
)
def test_bad_yaml_in_a_text_is_named_with_its_place(lines, error):
    drafts = drafts_from_lines(std_msgs.Int8, ["data: 1", "---", *lines])
    assert next(drafts)
    with pytest.raises(ValueMismatch, match=error):
        next(drafts)


@pytest.mark.parametrize(
    ("name", "texts", "hint"),
    [
        (
            VECTOR,
            ["x:1", "y:2", "z:3"],
            "write all fields into one argument: '{name: value, name: value}'",
        ),
        (TWIST, ["{x: fast}", "{}"], ""),
        (VECTOR, ["1", "2"], ""),
    ],
)
def test_what_the_shell_has_taken_apart_is_recognised(name, texts, hint):
    with pytest.raises(ValueMismatch) as caught:
        draft_from_values(message_class(name), texts)
    assert caught.value.hint == hint


@settings(deadline=None, derandomize=True)
@given(
    st.sampled_from(["std_msgs/String", "sensor_msgs/Image", "nav_msgs/Path", "std_msgs/Int64"]),
    st.lists(
        st.text() | st.text("{}[],:&*!|>-?#'\"\n xy1e.~") | st.from_regex(r"(data|poses): .*"),
        max_size=2,
    ),
)
def test_whatever_is_typed_gives_a_message_or_a_value_mismatch(name, texts):
    with contextlib.suppress(ValueMismatch):
        encode(draft_from_values(message_class(name), texts).message)
