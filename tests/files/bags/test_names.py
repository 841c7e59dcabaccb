"""Fields with names that lcm-gen's Python needs, or that arrays' lengths have."""

import numpy as np
import pytest
from fixtures.ros_bags import TARGETS, Topic, own_types, version_of, write_bag

from lcmtools.bag.ros_definitions import renamed_fields
from lcmtools.bag.ros_import import RosImport


@pytest.mark.parametrize(
    ("names", "renamed"),
    [
        (["x", "data[]"], {}),
        (["from", "encode", "decode", "get_hash"], {}),
        (["encoder[]", "encoder_length"], {"encoder_length": "encoder_length_"}),
        (["a_length", "a_length_", "a[]"], {"a_length": "a_length__"}),
        (["encoder", "encoder_length"], {}),
        (["a_length[]", "a[]"], {"a_length": "a_length_"}),
        (["a_length", "a[]", "a_length_[]"], {"a_length": "a_length__"}),
    ],
)
def test_fields_get_names_that_are_free(names, renamed):
    text = "".join(f"int32{'[]' * ('[]' in name)} {name.strip('[]')}\n" for name in names)
    types = own_types(1, Item=text)
    assert renamed_fields(types.fielddefs["own_msgs/msg/Item"][1]) == renamed


@pytest.mark.parametrize("target", TARGETS)
def test_values_are_right_under_other_names(target, tmp_path):
    text = "string from\nint32 encode\nint32 encoder_length\nfloat32[] encoder\nfloat32[2] pair\n"
    text += "int32 pair_length\nstring[] a_length\nint16[] a\n"
    path = tmp_path / target
    values = {
        "from_": "base",
        "encode": 5,
        "encoder_length": 77,
        "encoder": np.array([0.5, 1.5], "float32"),
        "pair": np.array([1, 2], "float32"),
        "pair_length": 8,
        "a_length": ["x", "y", "z"],
        "a": np.array([4], "int16"),
    }
    store = own_types(version_of(path), Item=text)
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [values]))
    reading = RosImport()
    ((_, message, _),) = reading.read(path)
    found = {name: getattr(message, name) for name in message.__slots__}
    assert found == {
        "from_": "base",
        "encode_": 5,
        "encoder_length_": 77,
        "encoder": [0.5, 1.5],
        "pair": [1, 2],
        "pair_length": 8,
        "a_length_": ["x", "y", "z"],
        "a": [4],
        "encoder_length": 0,
        "a_length": 0,
        "a_length__length": 0,
    }
    assert reading.report.renamed == {
        "own_msgs/Item.encoder_length": "encoder_length_",
        "own_msgs/Item.a_length": "a_length_",
    }
    assert reading.report.is_complete
    assert len(reading.report.to_lines()) == 2


def test_constants_that_lcm_lacks_cost_only_themselves(tmp_path):
    text = "uint64 MOST=18446744073709551615\nuint8 FEW=3\nbyte LARGE=200\nint32 x\n"
    path, store = tmp_path / "a.bag", own_types(1, Item=text)
    write_bag(path, store, Topic("/item", "own_msgs/msg/Item", [{"x": 4}]))
    reading = RosImport()
    ((_, message, _),) = reading.read(path)
    assert (message.x, type(message).FEW) == (4, 3)
    assert not hasattr(message, "MOST")
    assert reading.report.to_lines() == []
