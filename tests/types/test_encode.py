"""A class's own ``encode``, which lcm-gen wrote: it drops no array and writes none too short."""

import numpy as np
import pytest

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.messages.dicts import from_dict
from lcmtools.messages.registry import message_class
from lcmtools.types.geometry_msgs import Point32, Polygon, PolygonStamped
from lcmtools.types.sensor_msgs import CameraInfo, Image, JointState, LaserScan
from lcmtools.types.std_msgs import Float64MultiArray, MultiArrayDimension, MultiArrayLayout

POLYGON = Polygon([Point32(1.0), Point32(2.0)])
LAYOUT = MultiArrayLayout([MultiArrayDimension("x", 3)])
WHOLE = [
    LaserScan(ranges=[1.0, 2.0]),
    LaserScan(ranges=np.array([1.0, 2.0], "float32"), intensities=(1.0,)),
    LaserScan(ranges=[1.0, 2.0], ranges_length=1),
    LaserScan(ranges=[1.0, 2.0], ranges_length=7),
    JointState(name=["a", "b"], position=[0.5]),
    Image(data=b"abc"),
    POLYGON,
    PolygonStamped(polygon=POLYGON),
    Float64MultiArray(LAYOUT, [1.0]),
    CameraInfo(K=[1.0] * 9, D=[0.5]),
]


@pytest.mark.parametrize("message", WHOLE)
def test_length_fields_are_set_from_the_arrays(message):
    assert message.encode() == encode(message)
    assert type(message).decode(message.encode()) == message


@pytest.mark.parametrize(
    ("name", "fields", "fault"),
    [
        ("sensor_msgs/CameraInfo", {"K": [1.0]}, "K: expected 9 elements, got 1"),
        ("rows_t", {"cells": [[1, 2], [3]]}, "cells: its rows differ in length: 2 and 1"),
        ("rows_t", {"id": b"abc"}, "id: expected 16 numbers, got 3"),
        ("rows_t", {"names": ["a", "b", "c"]}, "names: expected 2 strings, got 3"),
        ("rows_t", {"a": [1, 2], "b": [1.0]}, "b: has 1 elements where a has 2"),
    ],
)
def test_sizes_that_contradict_are_refused(name, fields, fault, family):
    family("rows")
    with pytest.raises(ValueMismatch, match=fault):
        message_class(name)(**fields).encode()


def test_new_messages_are_whole(family):
    family("rows")
    message = message_class("rows_t")()
    assert message.encode() == encode(message)


@pytest.mark.parametrize("given", [0, 1, 3])
def test_a_length_in_a_dict_must_be_that_of_the_array(given):
    with pytest.raises(ValueMismatch, match=f"is {given}, and the length of ranges is 2"):
        from_dict(LaserScan, {"ranges": [1.0, 2.0], "ranges_length": given})
    assert from_dict(LaserScan, {"ranges": [1.0, 2.0]}).ranges_length == 2
