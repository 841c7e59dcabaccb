"""Errors for fields that a message lacks, and for imports of what lcmtools has elsewhere."""

import importlib
import traceback

import pytest

import lcmtools
from lcmtools.message_value import name_fields
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import Empty

EFFORT = (
    "JointState has no field 'efort' (fields: header, name, position, velocity, effort); "
    "did you mean 'effort'?"
)
INNER = (
    "TwistWithCovariance has no field 'linear' (fields: twist, covariance); "
    "did you mean 'twist.linear'?"
)


@pytest.mark.parametrize(
    ("message", "name", "error"),
    [
        (JointState(), "efort", EFFORT),
        (
            Odometry().twist,
            "linear",
            INNER,
        ),
        (Empty(), "data", "Empty has no field 'data' (it has no fields)"),
    ],
)
def test_a_field_that_a_message_lacks(message, name, error):
    with pytest.raises(AttributeError) as caught:
        getattr(message, name)
    assert traceback.format_exception_only(caught.value) == [f"AttributeError: {error}\n"]
    assert not hasattr(message, name)


def test_setting_one_is_explained_where_errors_are_shown():
    message = JointState()
    with pytest.raises(AttributeError) as caught:
        message.efort = [1.0]
    name_fields(caught.value)
    assert str(caught.value) == EFFORT


def test_other_errors_stay_as_they_are():
    for error in (AttributeError("'Gripper' object has no attribute 'x'"), ValueError("x")):
        before = str(error)
        name_fields(error)
        assert str(error) == before


GEOMETRY = "lcmtools.types.geometry_msgs"


@pytest.mark.parametrize(
    ("module", "hint"),
    [
        (f"{GEOMETRY}.msg", f"here it is {GEOMETRY}"),
        (f"{GEOMETRY}.Twst", f"write: from {GEOMETRY} import Twist"),
        (f"{GEOMETRY}.Laser", "it has Accel, AccelStamped"),
        ("lcmtools.types.std_srvs.Triger", "write: from lcmtools.types.std_srvs import Trigger"),
        ("lcmtools.types.geomtry_msgs", "write: from lcmtools.types import geometry_msgs"),
        ("lcmtools.geometry_msgs", "write: from lcmtools.types import geometry_msgs"),
        ("lcmtools.geometry_msgs.msg", "write: from lcmtools.types import geometry_msgs"),
    ],
)
def test_the_import_that_was_meant_is_named(module, hint):
    with pytest.raises(ImportError) as caught:
        importlib.import_module(module)
    assert hint in str(caught.value)


def test_a_name_of_lcmtools_itself_too():
    with pytest.raises(AttributeError, match=r"write: from lcmtools.types import sensor_msgs"):
        _ = lcmtools.sensor_msgs
    with pytest.raises(AttributeError, match=r"has no attribute 'zebra'$"):
        _ = lcmtools.zebra
    with pytest.raises(ModuleNotFoundError, match=r"No module named 'lcmtools.zebra'"):
        importlib.import_module("lcmtools.zebra")
