"""Length fields: read like all others, set from the arrays, and accepted if they fit these."""

import json

import numpy as np
import pytest

from lcmtools import message_class
from lcmtools.errors import ValueMismatch
from lcmtools.gui.choices import number_fields
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.filter import Filter
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.path import parse_path, select
from lcmtools.messages.plain import to_json, to_plain
from lcmtools.messages.text import format_message

STATUS = "{joint_position: [1, 2], joint_name: [a, b], gain: [[1, 2, 3]], inner: {cols: 5}}"


def drafted(text):
    cls = message_class("lengths/status_t")
    return decode(cls, encode(draft_from_values(cls, [text]).message))


@pytest.mark.parametrize(
    ("path", "value"),
    [("num_joints", 2), ("rows", 1), ("cols", 3), ("inner.cols", 5), ("inner.rows", 0)],
)
def test_a_length_is_read_by_its_path_and_filtered(family, path, value):
    family("lengths")
    message = drafted(STATUS)
    assert select(message, parse_path(path)).value == value
    assert Filter(f"m.{path} == {value}").matches(message)
    assert not Filter(f"{path} > {value}").matches(message)
    assert path in dict(number_fields(type(message)))


@pytest.mark.parametrize(
    ("text", "lengths"),
    [
        ("{joint_position: [1, 2], joint_name: [a, b]}", {"num_joints": 2}),
        ("{num_joints: 2, joint_position: [1, 2], joint_name: [a, b]}", {"num_joints": 2}),
        ("{joint_name: [a], joint_position: [1], num_joints: '0x1'}", {"num_joints": 1}),
        ("{num_joints: 0}", {"num_joints": 0}),
        ("{rows: 1, cols: 2, gain: [[1, 2]]}", {"rows": 1, "cols": 2}),
        ("{rows: 2, cols: 0, gain: [[], []]}", {"rows": 2, "cols": 0}),
        ("{rows: 0, cols: 4}", {"rows": 0, "cols": 4}),
        ("{cols: 4, gain: []}", {"rows": 0, "cols": 4}),
    ],
)
def test_lengths_that_fit_are_accepted(family, text, lengths):
    family("lengths")
    message = drafted(text)
    assert {name: getattr(message, name) for name in lengths} == lengths


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{num_joints: 7}", "num_joints: is 7, and the length of joint_position is 0"),
        (
            "{num_joints: 3, joint_position: [1, 2, 3], joint_name: [a]}",
            "num_joints: is 3, and the length of joint_name is 1",
        ),
        ("{rows: 2, gain: [[1]]}", "rows: is 2, and the length of gain is 1"),
        ("{cols: 2, gain: [[1, 2, 3]]}", "cols: is 2, and the length of a row of gain is 3"),
        ("{cols: -1}", "cols: is a length, which is never negative"),
        ("{num_joints: x}", "num_joints: expected an integer, got 'x'"),
        ("{inner: {rows: 1}}", "inner.rows: is 1, and the length of image is 0"),
        ("{inner: {depth: 1}}", "inner.depth: is 1, and the length of a row of cells is 0"),
    ],
)
def test_lengths_that_do_not_fit_are_refused_with_both_numbers(family, text, says):
    family("lengths")
    with pytest.raises(ValueMismatch) as caught:
        drafted(text)
    assert caught.value.what == says


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("{cols: 4}", {"cols": 4}),
        ("{inner: {cols: 640}}", {"inner": {"cols": 640, "image": [], "cells": [[], []]}}),
        (STATUS, {"gain": [[1.0, 2.0, 3.0]]}),
        ("{gain: [[], []]}", {"gain": [[], []]}),
        ("{}", {"gain": []}),
        ("{inner: {image: [[1, 2]], cells: [[{}], [{value: 3}]]}}", {}),
    ],
)
def test_nothing_is_lost_through_text_and_json(family, text, shown):
    family("lengths")
    message = drafted(text)
    plain = to_plain(message)
    assert {name: plain[name] for name in shown} == shown
    assert "num_joints" not in plain
    for written in (format_message(message), to_json(message)):
        assert encode(drafted(written)) == encode(message)


def test_the_careful_encoder_keeps_it_too(family):
    family("lengths")
    message = drafted("{cols: 4}")
    message.ready = np.array([True]).reshape(())  # the fast encoder takes Python's booleans only
    assert decode(type(message), encode(message)).cols == 4


def test_commands_read_lengths(family, cli, log_of):
    family("lengths")
    log = log_of("STATUS", *(encode(drafted(text)) for text in (STATUS, "{cols: 4}")))
    assert cli("echo", "-b", log, "STATUS/num_joints").out == "2\n---\n0\n---\n"
    lines = cli("echo", "-b", log, "STATUS", "--filter", "m.num_joints < 1", "--json").out
    assert json.loads(lines)["cols"] == 4
    found = cli("msg", "find-field", "num_joints").out
    assert found == "lengths/status_t: int32 num_joints\n"
