"""Values outside of messages: what is written is read back, by kind and not by YAML 1.1."""

import math

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import ValueMismatch
from lcmtools.messages.setting import (
    check_setting,
    kind_of,
    read_setting,
    text_of,
    write_setting,
)

TEXTS = [
    "",
    "hello world",
    "true",
    "No",
    "2.5",
    "-5",
    "it's",
    'say "hi"',
    "'quoted'",
    '"',
    "a: b",
    "a, b",
    "[1, 2",
    "{x}",
    "# no comment",
    "tab\tand\nline",
    "null",
    "~",
    "été",
    " blank ",
    "/husky0/odometry",
    "1e-3",
    "- item",
    "\U0001f916",
]


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_that_is_written_is_read_back_alone_in_lists_and_as_anything(text):
    assert read_setting(write_setting(text), "string", "p") == text
    assert read_setting(write_setting([text, "b"]), "string[]", "p") == [text, "b"]
    assert read_setting(write_setting(text), "any", "p") == text


@pytest.mark.parametrize(
    "value",
    [True, False, 0, -(2**63), 2**63 - 1, 0.1, -1e-300, 1e300, math.inf, -math.inf, [], [1], [0.5]],
)
def test_a_value_that_is_written_is_read_back_with_its_type(value):
    read = read_setting(write_setting(value), kind_of(value), "p")
    assert read == value
    assert type(read) is type(value)
    assert "\n" not in write_setting(value)


def test_what_is_not_a_number_is_read_back_too():
    assert math.isnan(read_setting(write_setting(math.nan), "float", "p"))


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (True, "bool"),
        (1, "int"),
        (1.0, "float"),
        ("a", "string"),
        ([1, 2], "int[]"),
        ((True,), "bool[]"),
        ([1, 2.0], "list"),
        ([], "list"),
        (None, "any"),
    ],
)
def test_the_kind_is_that_of_the_value(value, kind):
    assert kind_of(value) == kind


@pytest.mark.parametrize("value", [{"a": 1}, object(), b"bytes"])
def test_what_no_parameter_can_be_is_refused(value):
    with raises_saying(ValueMismatch, "not a value", "parameter"):
        kind_of(value)


@pytest.mark.parametrize(
    ("text", "kind", "line"),
    [
        ("fast", "float", "p: expected a number, got 'fast'"),
        ("[1, x]", "float[]", "p[1]: expected a number, got 'x'"),
        ("1", "int[]", "p: expected a list, got '1'"),
        ("", "int", "p: expected an integer, got nothing"),
        ("{a: 1}", "bool", "p: expected true or false, got a mapping"),
        ("{a: 1}", "any", "p: expected a number, true, false or text, got a mapping"),
        ("[[1]]", "any", "p[0]: expected a number, true, false or text, got a list"),
        ("9223372036854775808", "int", "p: 9223372036854775808 does not fit int64"),
    ],
)
def test_a_text_of_another_kind_is_refused(text, kind, line):
    with pytest.raises(ValueMismatch) as caught:
        read_setting(text, kind, "p")
    assert str(caught.value).startswith(line)


def test_a_list_of_mappings_is_refused_and_shown_whole():
    text = text_of([{"name": "a", "gains": ["1", "on"]}], "any")
    assert text == '[{name: a, gains: [1, "on"]}]'
    with pytest.raises(ValueMismatch, match=r"p\[0\]: expected a number, true, false or text"):
        read_setting(text, "any", "p")
    with pytest.raises(ValueMismatch, match="binary data"):
        text_of([b"\0"], "any")


def test_a_python_value_is_not_read_as_text():
    assert check_setting(2, "float", "p") == 2.0
    with pytest.raises(ValueMismatch, match=r"p: expected a number, got '2\.5'"):
        check_setting("2.5", "float", "p")
    with pytest.raises(ValueMismatch, match="p: expected text, got 2"):
        check_setting(2, "string", "p")


@pytest.mark.parametrize(
    ("value", "kind", "expected"),
    [
        ("2.5", "float", 2.5),
        ("2.5", "string", "2.5"),
        ("2.5", "any", 2.5),
        (["1", "a"], "any", [1, "a"]),
        (["1", "2"], "string[]", ["1", "2"]),
        (None, "string", ""),
        ("'a'", "string", "'a'"),
    ],
)
def test_a_value_of_a_document_becomes_a_text_for_its_kind(value, kind, expected):
    assert read_setting(text_of(value, kind), kind, "p") == expected
