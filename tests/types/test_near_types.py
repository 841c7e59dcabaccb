"""Unknown versions of the user's own types, as wtf recognizes them."""

import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from fixtures.judging import findings

from lcmtools import message_class
from lcmtools.doctor.findings import Severity
from lcmtools.graph.model import Endpoint, Node, Role, Traffic
from lcmtools.messages.fields import Field, fields
from lcmtools.messages.near_types import (
    NearType,
    fingerprint_of,
    grown_type,
    nearest_type,
    own_types_like,
)
from lcmtools.wire.packet import Sender

Family = Callable[[str], Path]


def field(name: str, kind: str = "float64") -> Field:
    return Field(name, kind, None, (), is_length=False)


def seen(parts: Sequence[Field], channel: str = "A") -> Traffic:
    return Traffic(channel, Sender("10.0.0.1", 4000), (fingerprint_of(parts),), 5, 500, 0, 1)


@pytest.mark.parametrize(
    ("channel", "edit", "difference"),
    [
        ("A", lambda own: own[:2], "without the field z"),
        ("A", lambda own: [*own, field("utime", "int64")], "with utime"),
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


@pytest.mark.parametrize(
    ("channel", "payload", "grown"),
    [
        ("STATUS", struct.pack(">8x3dq", 1, 2, 3, 4), "near/status_t"),
        ("OTHER", struct.pack(">8x3dq", 1, 2, 3, 4), ""),
        ("STATUS", struct.pack(">8x3d", 1, 2, 3), ""),
        ("STATUS", struct.pack(">8x4q", 1, 2, 3, 4), ""),
        ("STATUS", struct.pack(">8x2d", 1, 2), ""),
    ],
)
def test_fields_of_unknown_names_at_the_end_are_recognised_by_what_comes_before(
    family: Family, channel: str, payload: bytes, grown: str
) -> None:
    family("near")
    assert grown_type(payload, own_types_like(channel)) == grown


def test_a_type_that_grew_is_named_by_wtf(
    family: Family, cli: Callable[..., Any], log_of: Callable[..., str]
) -> None:
    family("near")
    number = fingerprint_of([*fields(message_class("near/status_t")), field("wheel_speed")])
    payload = number.to_bytes(8, "big") + struct.pack(">4d", 1, 2, 3, 4)
    told = cli("wtf", "--bag", log_of("STATUS", payload, payload))
    assert "like near/status_t, but with more bytes at the end, as if fields" in told.out
    assert told.code == 1


def test_of_many_own_types_not_all_are_compared(family: Family, tmp_path: Path) -> None:
    for number in range(300):
        struct_ = f"struct part_{number:03} {{ double a_{number}; double b; }}"
        (tmp_path / f"part_{number:03}.lcm").write_text(f"package many; {struct_}")
    family(str(tmp_path))
    first, last = ([field(f"a_{number}"), field("b", "float32")] for number in (0, 299))
    near = NearType("many/part_000", "b is float32, not float64")
    assert nearest_type(fingerprint_of(first)) == near
    assert nearest_type(fingerprint_of(last)) is None
    near = NearType("many/part_299", "b is float32, not float64")
    assert nearest_type(fingerprint_of(last), own_types_like("PART_299")) == near
