"""Unknown versions of the user's own types, as wtf recognizes them."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from fixtures.judging import findings

from lcmtools import message_class
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.near_types import fingerprint_of
from lcmtools.graph.model import Endpoint, Node, Role, Traffic
from lcmtools.messages.fields import Field, fields
from lcmtools.wire.packet import Sender

Family = Callable[[str], Path]


def seen(parts: Sequence[Field], channel: str = "A") -> Traffic:
    return Traffic(channel, Sender("10.0.0.1", 4000), (fingerprint_of(parts),), 5, 500, 0, 1)


@pytest.mark.parametrize(
    ("channel", "edit", "difference"),
    [
        ("A", lambda own: own[:2], "without the field z"),
        ("A", lambda own: [*own, Field("utime", "int64", None, (), is_length=False)], "with utime"),
        (
            "STATUS",
            lambda own: [*own, own[0]._replace(name="battery")],
            "with battery (float64) at",
        ),
    ],
)
def test_a_lost_or_added_field_of_an_own_type_is_a_warning(
    family: Family,
    channel: str,
    edit: Callable[[tuple[Field, ...]], Sequence[Field]],
    difference: str,
) -> None:
    family("near")
    parts = edit(fields(message_class("near/status_t")))
    found = findings(traffic=[seen(parts, channel)])["unknown-type"]
    assert found.severity is Severity.WARNING
    assert f"like near/status_t, but {difference}" in found.items[0], "not geometry_msgs/Vector3"


def test_several_fields_less_are_recognised_of_any_type() -> None:
    parts = fields(message_class("sensor_msgs/LaserScan"))[:-2]
    found = findings(traffic=[seen(parts)])["unknown-type"]
    assert found.severity is Severity.NOTE, "a shipped type is like many"
    assert "sensor_msgs/LaserScan, but without the fields ranges, intensities" in found.items[0]


def test_a_channel_that_is_named_in_the_code_is_not_remapped() -> None:
    string = message_class("std_msgs/String")
    number = fingerprint_of(fields(string))
    end = Endpoint("POSE", Role.PUBLISHER, ("std_msgs/String",), (number,))
    node = Node("/pub", "p", "h", 1, endpoints=(end,), tool=True)
    twist = seen(fields(message_class("geometry_msgs/Twist")), "POSE")
    found = findings(node, traffic=[twist])["type-mismatch"]
    assert not any(":=" in remedy for remedy in found.remedies), found.remedies


def test_lcms_own_channel_needs_no_type() -> None:
    test = Traffic("LCM_SELF_TEST", Sender("10.0.0.1", 4000), (0x6C636D2073656C66,), 1, 13, 0, 0)
    other = test._replace(sender=Sender("10.0.0.1", 4001), fingerprints=(5,))
    assert not {"unknown-type", "type-mismatch"} & findings(traffic=[test, other]).keys()
