"""Unknown versions of the user's own types, as wtf recognizes them."""

import pytest
from fixtures.judging import findings

from lcmtools import message_class
from lcmtools.doctor.findings import Severity
from lcmtools.graph.model import Endpoint, NodeInfo, Role, Traffic
from lcmtools.messages.fields import Field, fields
from lcmtools.messages.type_versions import added_and_missing, fingerprint_of
from lcmtools.wire.packet import Sender


def field(name, kind="float64"):
    return Field(name, kind, None, (), is_length=False)


def seen(parts, channel="A"):
    return Traffic(channel, Sender("10.0.0.1", 4000), (fingerprint_of(parts),), 5, 500, 0, 1)


@pytest.mark.parametrize(
    ("channel", "edit", "difference"),
    [
        ("STATUS", lambda own: own[:2], "without the field z"),
        ("near/status", lambda own: [*own, field("utime", "int64")], "with utime"),
    ],
)
def test_a_lost_or_added_field_of_an_own_type_is_a_warning(family, channel, edit, difference):
    family("near")
    parts = edit(fields(message_class("near/status_t")))
    found = findings(traffic=[seen(parts, channel)])["unknown-type"]
    assert found.severity is Severity.WARNING
    assert f"like near/status_t, but {difference}" in found.items[0], "not geometry_msgs/Vector3"


def test_a_channel_that_is_named_in_the_code_is_not_remapped():
    string = message_class("std_msgs/String")
    number = fingerprint_of(fields(string))
    end = Endpoint("POSE", Role.PUBLISHER, ("std_msgs/String",), (number,))
    node = NodeInfo("/pub", "p", "h", 1, endpoints=(end,), tool=True)
    twist = seen(fields(message_class("geometry_msgs/Twist")), "POSE")
    found = findings(node, traffic=[twist])["type-mismatch"]
    assert not any(":=" in remedy for remedy in found.remedies), found.remedies


def test_lcms_own_channel_needs_no_type():
    test = Traffic("LCM_SELF_TEST", Sender("10.0.0.1", 4000), (0x6C636D2073656C66,), 1, 13, 0, 0)
    other = test._replace(sender=Sender("10.0.0.1", 4001), fingerprints=(5,))
    assert not {"unknown-type", "type-mismatch"} & findings(traffic=[test, other]).keys()


@pytest.mark.parametrize(
    ("older", "newer", "differing"),
    [
        ("double a; double b;", "double a; double b; int8_t c;", (["c"], [])),
        ("double a; double b;", "double a;", ([], ["b"])),
        ("double a; double b;", "float a; double b;", (["a"], ["a"])),
        ("double a; double b;", "double b; double a;", (["b", "a"], ["b", "a"])),
        ("double a; inner_t in;", "double a; inner_t in; int8_t c;", (["c"], [])),
        ("int32_t n; double a[n];", "int32_t n; float a[n];", (["a"], ["a"])),
        ("double a[3];", "double a[4];", (["a"], ["a"])),
    ],
)
def test_the_fields_in_which_two_versions_differ_are_named(
    family, tmp_path, older, newer, differing
):
    inner = "struct inner_t { double x; }"
    for name, body in (("older", older), ("newer", newer)):
        (tmp_path / f"{name}.lcm").write_text(f"package v; struct {name}_t {{ {body} }}")
    (tmp_path / "inner.lcm").write_text(f"package v; {inner}")
    family(str(tmp_path))
    one, other = message_class("v/newer_t"), message_class("v/older_t")
    assert added_and_missing(one, other) == differing


def test_of_a_nested_type_the_field_within_is_named(family, tmp_path):
    for name, body in (("old", "double x;"), ("new", "double x; double y;")):
        structs = f"struct in_t {{ {body} }} struct out_t {{ int8_t id; in_t inner; }}"
        (tmp_path / f"{name}.lcm").write_text(f"package {name}; {structs}")
    family(str(tmp_path))
    one, other = (message_class(f"{name}/out_t") for name in ("new", "old"))
    assert added_and_missing(one, other) == (["inner.y"], [])
