"""The rows of ``echo --csv``: columns that stay where they are."""

import pytest

from lcmtools.cli.topic.shown import Table


def test_a_row_has_the_columns_of_the_first_one() -> None:
    table = Table()
    assert table.rows(1, {"a": [1, 2], "b": "x"}) == "%time,field.a0,field.a1,field.b\n1,1,2,x"
    assert table.rows(2, {"a": [3, 4], "b": "y"}) == "2,3,4,y"
    assert table.rows(3, {"a": [5], "b": "z"}) == "3,5,,z"


def test_values_without_a_column_are_left_out_and_that_is_said_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    table = Table()
    table.rows(1, {"a": [1]})
    assert table.rows(2, {"a": [2, 3]}) == "2,2"
    assert table.rows(3, {"a": [4, 5]}) == "3,4"
    assert capsys.readouterr().err == (
        "lcmtools echo: no column for 1 more in an array that was shorter in the first message;"
        " --field with a slice gives all rows the same columns\n"
    )


def test_text_is_quoted_where_it_must_be() -> None:
    table = Table()
    assert table.rows(1, 'a, "b"\nc').splitlines() == ["%time,field", '1,"a, ""b""', 'c"']
