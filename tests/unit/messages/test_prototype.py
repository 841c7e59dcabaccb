"""Messages to fill in, and that they are what ``pub`` takes."""

from types import ModuleType

import pytest

from lcmtools.messages.codec import encode
from lcmtools.messages.definition import prototype
from lcmtools.messages.registry import message_class, type_names
from lcmtools.messages.yaml_input import message_from_values


def test_a_prototype_is_a_block_of_yaml_with_all_defaults() -> None:
    assert prototype(message_class("geometry_msgs/TwistStamped")) == (
        "header:\n"
        "  seq: 0\n"
        "  stamp:\n"
        "    sec: 0\n"
        "    nsec: 0\n"
        "  frame_id: ''\n"
        "twist:\n"
        "  linear:\n"
        "    x: 0.0\n"
        "    y: 0.0\n"
        "    z: 0.0\n"
        "  angular:\n"
        "    x: 0.0\n"
        "    y: 0.0\n"
        "    z: 0.0"
    )


def test_arrays_are_in_one_line_and_their_lengths_are_left_out() -> None:
    rows = prototype(message_class("sensor_msgs/Joy")).splitlines()
    assert rows[-2:] == ["axes: []", "buttons: []"]
    covariance = prototype(message_class("geometry_msgs/PoseWithCovariance")).splitlines()[-1]
    assert covariance == f"covariance: [{', '.join(['0.0'] * 36)}]"


def test_booleans_are_yamls() -> None:
    assert prototype(message_class("std_msgs/Bool")) == "data: false"


def test_a_type_without_fields_is_an_empty_mapping() -> None:
    assert prototype(message_class("std_msgs/Empty")) == "{}"


@pytest.mark.parametrize("name", type_names())
def test_pub_takes_every_prototype_as_the_default_message(name: str) -> None:
    kind = message_class(name)
    assert encode(message_from_values(kind, [prototype(kind)])) == encode(kind())


@pytest.mark.parametrize("name", ["Nothing", "Shapes", "Shared", "Tree", "Limits", "Many", "Flat"])
def test_pub_takes_prototypes_of_odd_types_too(name: str, odd: ModuleType) -> None:
    kind = getattr(odd, name)
    assert encode(message_from_values(kind, [prototype(kind)])) == encode(kind())
