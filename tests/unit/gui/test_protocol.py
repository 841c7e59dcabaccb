"""Frames, and what a page may send."""

import itertools
import json
import math

import pytest

from lcmtools.gui.protocol import (
    MalformedRequest,
    Parameters,
    binary_frame,
    read_request,
    text_frame,
)
from lcmtools.gui.requests import ACTIONS, ASKS, answer
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


def test_a_request_has_its_parameters():
    request = read_request('{"op": "open", "id": 7, "stream": "plot", "fields": ["/a/x", "/b"]}')
    assert (request.op, request.id, request.text("stream")) == ("open", 7, "plot")
    parameters = request.without("op", "id", "stream")
    assert parameters.texts("fields") == ("/a/x", "/b")
    assert parameters.key == '{"fields": ["/a/x", "/b"]}'
    assert parameters.number("width", 320) == 320
    assert parameters.flag("raw") is False
    assert parameters.value("none") is None


def test_parameters_are_checked():
    values = Parameters({"a": "x" * 2000, "b": True, "c": ["x", 7], "d": 5, "e": ["x"] * 2000})
    for read in (
        *(lambda: values.text("a"), lambda: values.text("missing"), lambda: values.number("b")),
        *(lambda: values.texts("c"), lambda: values.texts("d"), lambda: values.texts("e")),
        *(lambda: values.number("d", highest=4), lambda: values.flag("d")),
    ):
        with pytest.raises(MalformedRequest):
            read()


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
        assert callable(answer(name, table))
    with pytest.raises(MalformedRequest, match="there is no request 'x'"):
        answer("x", table)


@pytest.mark.parametrize("name", STREAMS)
def test_each_stream_has_its_class(name):
    assert issubclass(stream_class(name), PageStream)
