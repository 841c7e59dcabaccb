"""Documents of YAML and JSON come out of a text as soon as they are whole."""

import json
import time

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import ValueMismatch
from lcmtools.messages import documents as module
from lcmtools.messages.documents import Document, Documents


def steps(*lines):
    """The values that come out at each line, and at the end."""
    documents = Documents()
    found = [[document.value for document in documents.add_line(line)] for line in lines]
    return [*found, [document.value for document in documents.end()]]


def test_a_document_is_whole_at_the_dashes_behind_it():
    assert steps("data: a", "---", "data: b", "---") == [
        [],
        [{"data": "a"}],
        [],
        [{"data": "b"}],
        [],
    ]


def test_empty_documents_are_kept_where_each_is_a_message_without_fields():
    documents = Documents(keeps_empty=True)
    lines = ["", "---", "# /start", "", "---", "---", "{}", "---", ""]
    found = [document.value for line in lines for document in documents.add_line(line)]
    assert [*found, *documents.end()] == [{}, {}, {}]


def test_a_document_is_whole_at_three_dots():
    assert steps("data: a", "...", "...", "b") == [[], [{"data": "a"}], [], [], ["b"]]


def test_the_end_of_the_text_makes_the_last_document_whole():
    assert steps("---", "linear:", "  x: 1") == [[], [], [], [{"linear": {"x": "1"}}]]


def test_a_line_of_json_is_whole_at_once():
    assert steps('{"a": 1}', "[1, 2]", "{a: b}\r") == [[{"a": "1"}], [["1", "2"]], [{"a": "b"}], []]


def test_json_over_several_lines_is_whole_where_its_bracket_closes():
    text = json.dumps({"a": {"b": [1, {"c": 2}]}}, indent=2)
    found = steps(*text.split("\n"), "{", '"x": "}"', "}")
    assert [value for values in found for value in values] == [
        {"a": {"b": ["1", {"c": "2"}]}},
        {"x": "}"},
    ]
    assert found[-2] == [{"x": "}"}]


def test_brackets_may_be_open_at_the_end_of_a_line_that_looks_whole():
    lines = ["{linear: {x: 1}", ", angular: {z: 2}}"]
    assert steps(*lines) == [[], [{"linear": {"x": "1"}, "angular": {"z": "2"}}], []]


def test_dashes_within_a_line_or_indented_end_nothing():
    assert steps("data: |", "  ---", "  a") == [[], [], [], [{"data": "---\na"}]]


def test_a_document_may_begin_behind_its_dashes():
    assert steps("--- {a: b}", "--- c") == [[], [{"a": "b"}], ["c"]]


def test_directives_belong_to_the_document_behind_them():
    assert steps("%YAML 1.1", "---", "a: b", "---") == [[], [], [], [{"a": "b"}], []]


def test_documents_know_their_line_and_empty_ones_are_left_out():
    documents = Documents()
    lines = ["\ufeff", "# a comment", "data: a", "---", "---", "~", "---", "# c", "data: b"]
    found = [document for line in lines for document in documents.add_line(line)]
    assert [*found, *documents.end()] == [Document({"data": "a"}, 3), Document({"data": "b"}, 9)]


def test_blank_lines_without_end_take_no_memory():
    documents = Documents()
    for _ in range(1000):
        assert not list(documents.add_line("# nothing"))
    assert not documents._lines


def test_a_document_without_end_is_refused(monkeypatch):
    monkeypatch.setattr(module, "LONGEST", 100)
    with raises_saying(ValueMismatch, "line 34: ", "does not end"):
        steps(*["ab"] * 100)


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ('{"a": "\\ud83d\\ude00"}', {"a": "\U0001f600"}),
        ('{"a": true, "b": [false, null]}', {"a": "true", "b": ["false", None]}),
        ('{"a": 1e-3, "b": -0.0, "c": "1"}', {"a": "1e-3", "b": "-0.0", "c": "1"}),
        ('{"a": NaN, "b": -Infinity}', {"a": "NaN", "b": "-Infinity"}),
    ],
)
def test_json_is_read_by_its_own_rules_and_scalars_stay_text(line, value):
    assert steps(line)[0] == [value]


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (
            '{"a": 1, "a": 2}',
            "bad YAML at line 1, column 10: 'a' is given twice; leave one of them out",
        ),
        ("[" * 200_000 + "]" * 200_000, "nested more than 100 levels deep"),
        ('{"a": 1,, }', "bad YAML at line 1, column 9: "),
    ],
)
def test_what_is_no_json_is_named_with_its_place(line, error):
    with pytest.raises(ValueMismatch, match=error):
        steps(line)


def test_a_large_line_of_json_is_read_at_once():
    line = json.dumps({"data": list(range(300_000))})
    start = time.process_time()
    assert len(steps(line)[0]) == 1
    assert time.process_time() - start < 2.0  # seconds; as YAML it takes several
