"""JSON: every reader can read it, and tells a number that JSON lacks from a missing value."""

import json
import math
from pathlib import Path
from typing import NamedTuple

import pytest

import lcmtools
from lcmtools.formats.strict_json import write_json

NAN, INF = math.nan, math.inf


class _Pair(NamedTuple):
    first: float
    second: float


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (NAN, '"nan"'),
        (INF, '"inf"'),
        (-INF, '"-inf"'),
        (None, "null"),
        (1.5, "1.5"),
        ([NAN, None, 0.1], '["nan",null,0.1]'),
        ((INF, (1, NAN)), '["inf",[1,"nan"]]'),
        (_Pair(NAN, 1.0), '["nan",1.0]'),
        ({"a": {"b": [{"c": -INF}]}}, '{"a":{"b":[{"c":"-inf"}]}}'),
        ({"a": "NaN", "b": True, "c": 7}, '{"a":"NaN","b":true,"c":7}'),
        ("é\n\x7f\x9b\u2028\u202e\udc80\ufeff", r'"é\n\u007f\u009b\u2028\u202e\udc80\ufeff"'),
        ([], "[]"),
    ],
)
def test_values_as_json(value, text):
    assert write_json(value) == text
    json.loads(text, parse_constant=pytest.fail)


def test_indented_json_has_a_line_for_each_value():
    assert write_json({"a": [NAN], "b": 1}, indent=2) == '{\n  "a": [\n    "nan"\n  ],\n  "b": 1\n}'


# Files that lcmtools itself reads again, keys, and quoted texts: no reader sees a number of theirs.
PRIVATE = {
    "cli/completion/recent_channels.py",
    "bag/tables.py",  # rows of a table in a temporary file
    "bus/records.py",
    "bus/zenoh/opening.py",
    "cli/completion/from_click.py",
    "cli/completion/tree.py",
    "doctor/saved.py",
    "foxglove/schemas.py",
    "gui/protocol.py",
    "gui/dead_man.py",  # between two processes
    "gui/steering_process.py",  # likewise
    "launch/plan_report.py",
    "packages/cache.py",
    "wire/log_index.py",
}


def test_all_json_for_readers_is_written_in_one_place():
    folder = Path(lcmtools.__file__).parent
    writers = {
        str(path.relative_to(folder))
        for path in folder.rglob("*.py")
        if "json.dump" in path.read_text()
    }
    assert writers - PRIVATE == {"formats/strict_json.py"}
