"""The .pyi stubs: a type checker knows the fields of every message."""

import ast
from pathlib import Path

import pytest

from lcmtools.types.fingerprints import FINGERPRINTS

ROOT = Path(__file__).resolve().parents[3]


def annotations(name):
    """Return what the stub of a type says of each field."""
    module = ast.parse((ROOT / "lcmtools" / "types" / f"{name}.pyi").read_text())
    struct = next(node for node in module.body if isinstance(node, ast.ClassDef))
    return {
        ast.unparse(node.target): ast.unparse(node.annotation)
        for node in struct.body
        if isinstance(node, ast.AnnAssign)
    }


def test_stubs_name_the_fields_of_the_classes(subtests):
    for name in FINGERPRINTS:
        with subtests.test(name):
            check_fields(name)


def check_fields(name):
    source = ast.parse((ROOT / "lcmtools" / "types" / f"{name}.py").read_text())
    struct = next(node for node in source.body if isinstance(node, ast.ClassDef))
    slots = next(node for node in struct.body if isinstance(node, ast.Assign))
    fields = [
        field
        for field, kind in annotations(name).items()
        if not field.startswith("__") and kind != "Final"
    ]
    assert fields == ast.literal_eval(slots.value)


@pytest.mark.parametrize(
    ("name", "field", "expected"),
    [
        ("nav_msgs/Odometry", "header", "Header"),
        ("nav_msgs/Odometry", "child_frame_id", "str"),
        ("nav_msgs/Path", "poses", "list[PoseStamped]"),
        ("geometry_msgs/PoseWithCovariance", "covariance", "Sequence[float]"),
        ("sensor_msgs/JointState", "name", "list[str]"),
        ("sensor_msgs/Joy", "buttons", "Sequence[int]"),
        ("sensor_msgs/Image", "data", "bytes"),
        ("sensor_msgs/Image", "is_bigendian", "int"),
        ("nav_msgs/OccupancyGrid", "data", "Sequence[int]"),
        ("std_msgs/Bool", "data", "bool"),
        ("lcmtools_msgs/Endpoint", "bytes", "int"),
        ("lcmtools_msgs/ServiceReply", "OK", "Final"),
    ],
)
def test_field_has_its_python_type(name, field, expected):
    assert annotations(name)[field] == expected
