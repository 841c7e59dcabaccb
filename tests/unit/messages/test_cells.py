"""The columns of a table, as rostopic echo -p names them, and what stands in them."""

import pytest

from lcmtools.messages.plain import Cell, Plain, cells


@pytest.mark.parametrize(
    ("plain", "columns"),
    [
        (
            {"a": 1, "points": [{"x": 2.0}, {"x": 3.0}], "empty": [], "s": "t"},
            {"field.a": 1, "field.points0.x": 2.0, "field.points1.x": 3.0, "field.s": "t"},
        ),
        (5, {"field": 5}),
        ([0.5, 1.5], {"field0": 0.5, "field1": 1.5}),
        ([[1, 2], [3]], {"field00": 1, "field01": 2, "field10": 3}),
        ({"ok": True, "bad": [False]}, {"field.ok": 1, "field.bad0": 0}),
        ({"stamp": {"sec": 3, "nsec": 5}}, {"field.stamp": 3_000_000_005}),
        ({"stamp": {"sec": -1, "nanosec": 500_000_000}}, {"field.stamp": -500_000_000}),
        ({"sec": 1, "nsec": 2}, {"field": 1_000_000_002}),
        ({}, {}),
    ],
)
def test_columns_have_rostopics_names(plain: Plain, columns: dict[str, Cell]) -> None:
    assert cells(plain) == columns
