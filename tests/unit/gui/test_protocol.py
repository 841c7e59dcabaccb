"""Frames, and what a page may send."""

import itertools
import json
import math
from typing import Annotated

import pytest

from lcmtools.formats.typed import Within
from lcmtools.gui.page import ACTIONS, ASKS, answer
from lcmtools.gui.protocol import (
    Json,
    MalformedRequest,
    binary_frame,
    json_arguments,
    read_request,
    text_frame,
)
from lcmtools.gui.streams import STREAMS, stream_class
from lcmtools.gui.streams.base import PageStream


@pytest.mark.parametrize(
    "data",
    [
        *(b"{}", "", "{", "[]", "7", "null", '"open"', "{}", '{"op": 7}', "\ud800"),
        '{"op": "open", "id": NaN}',
        "[" * 5000,
        "[" * 200_000,
    ],
    ids=itertools.count(),
)
def test_rubbish_is_refused(data):
    with pytest.raises(MalformedRequest):
        read_request(data)


@pytest.mark.parametrize("number", [-1, 2**40, "7", True, None, [], 1e400, 10**400])
def test_a_requests_number_is_a_small_one(number):
    with pytest.raises(MalformedRequest):
        read_request(json.dumps({"op": "close", "id": number}, allow_nan=True)).id  # noqa: B018


def asked(
    *,
    fields: tuple[str, ...],
    width: Annotated[float, Within(1, 500)] = 320,
    raw: bool = False,
    values: Json = None,
):
    """A request's function."""


def test_a_request_has_its_parameters():
    request = read_request('{"op": "open", "id": 7, "stream": "plot", "fields": ["/a/x", "/b"]}')
    assert (request.op, request.id, request.stream) == ("open", 7, "plot")
    assert request.arguments(asked) == {"fields": ("/a/x", "/b")}
    values = {"fields": [], "width": 9, "raw": True, "values": {"a": [1]}}
    assert json_arguments(asked, values) == {**values, "fields": ()}


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({}, "'request' lacks the key 'fields'"),
        ({"fields": None}, "'request' lacks the key 'fields'"),
        ({"fields": 5}, "'fields' must be a list, not a single value"),
        ({"fields": ["x", 7]}, "'fields[1]' is not a short text"),
        ({"fields": ["x" * 2000]}, "'fields[0]' is not a short text"),
        ({"fields": [], "width": True}, "'width' must be a number"),
        ({"fields": [], "width": 501}, "'width' must be between 1 and 500, not 501"),
        ({"fields": [], "raw": "yes"}, "'raw' is neither true nor false"),
        ({"fields": [], "widht": 7}, "unknown key 'widht' in 'request'; did you mean width?"),
    ],
)
def test_parameters_are_checked(values, reason):
    with pytest.raises(MalformedRequest) as caught:
        json_arguments(asked, values)
    assert str(caught.value) == reason


def test_numbers_that_json_lacks_are_texts_and_null_is_a_missing_value():
    data = {"a": [math.inf, 1.5, (math.nan,)], "b": -math.inf, "c": None}
    text = text_frame({"id": 1, "data": data})
    assert json.loads(text)["data"] == {"a": ["inf", 1.5, ["nan"]], "b": "-inf", "c": None}


@pytest.mark.parametrize("name", ["", "x", "xy", "xyz", "ä" * 9])
def test_a_payload_begins_at_a_multiple_of_eight(name):
    frame = binary_frame({"id": 7, "name": name}, b"\1\2\3")
    length = int.from_bytes(frame[:4], "little")
    assert (4 + length) % 8 == 0
    assert json.loads(frame[4 : 4 + length]) == {"id": 7, "name": name}
    assert frame[4 + length :] == b"\1\2\3"


@pytest.mark.parametrize("table", [ASKS, ACTIONS])
def test_each_request_has_its_function(table):
    for name in table:
        with pytest.raises(MalformedRequest, match="unknown key 'none of its'"):
            json_arguments(answer(name, table), {"none of its": 7})
    with pytest.raises(MalformedRequest, match="there is no request 'x'"):
        answer("x", table)


@pytest.mark.parametrize("name", STREAMS)
def test_each_stream_has_its_class(name):
    assert issubclass(stream_class(name), PageStream)
    with pytest.raises(MalformedRequest, match="unknown key 'none of its'"):
        json_arguments(stream_class(name), {"none of its": 7})
