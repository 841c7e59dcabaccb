"""The rows of ``echo --csv``: columns that stay where they are."""

import pytest
from fixtures.says import assert_says

from lcmtools.messages.plain import cells
from lcmtools.observe.formatter import CsvTable


def row(table, time, plain, kind="a/B"):
    return table.row({"%time": time, **cells(plain)}, kind)


def test_a_row_has_the_columns_of_the_first_one():
    table = CsvTable(lambda *_: None)
    assert row(table, 1, {"a": [1, 2], "b": "x"}) == "%time,field.a0,field.a1,field.b\n1,1,2,x"
    assert row(table, 2, {"a": [3, 4], "b": "y"}) == "2,3,4,y"
    assert row(table, 3, {"a": [5], "b": "z"}) == "3,5,,z"


def test_values_without_a_column_are_left_out_and_that_is_said():
    said = []
    table = CsvTable(lambda *reason: said.append(reason))
    row(table, 1, {"a": [1]})
    assert row(table, 2, {"a": [2, 3]}) == "2,2"
    assert row(table, 3, {"a": [4, 5]}) == "3,4"
    ((reason, text),) = dict(said).items()
    assert reason == "more"
    assert_says(text, "no column for 1", "; ", "--field", "[0:5]")


def test_text_is_quoted_where_it_must_be():
    table = CsvTable(lambda *_: None)
    assert row(table, 1, 'a, "b"\nc') == '%time,field\n1,"a, ""b""\nc"'


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
def test_a_line_break_in_text_is_quoted_so_that_a_row_stays_a_row(end):
    table = CsvTable(lambda *_: None)
    assert row(table, 1, {"a": f"two{end}lines", "b": 3}) == (
        f'%time,field.a,field.b\n1,"two{end}lines",3'
    )


def test_messages_of_another_type_are_left_out_and_that_is_said():
    said = []
    table = CsvTable(lambda *reason: said.append(reason))
    row(table, 1, 5, "std_msgs/Int32")
    assert row(table, 2, "x", "std_msgs/String") is None
    assert row(table, 3, "y", "std_msgs/String") is None
    assert row(table, 4, 6, "std_msgs/Int32") == "4,6"
    ((reason, text),) = {*said}
    assert reason == "kind std_msgs/String"
    assert_says(text, "std_msgs/String", "left out", "std_msgs/Int32")
