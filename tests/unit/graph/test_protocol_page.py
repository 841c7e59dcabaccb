"""docs/protocol.md describes every struct of the protocol, field by field."""

import re
from pathlib import Path

import pytest

from lcmtools.bus.step_bus import STEP_CHANNEL
from lcmtools.graph.model import VERSION
from lcmtools.graph.protocol import PROTOCOL_CHANNELS
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.types.fingerprints import FINGERPRINTS

_PAGE = (Path(__file__).parents[3] / "docs" / "protocol.md").read_text()
_STRUCTS = sorted(name for name in FINGERPRINTS if name.startswith("lcmtools_msgs/"))


def _section(name):
    found = re.search(rf"^### {name}\n(.*?)(?=^##|\Z)", _PAGE, re.MULTILINE | re.DOTALL)
    assert found, f"docs/protocol.md has no section {name}"
    return found[1]


def _lcm_type(field):
    name = field.type.rpartition("/")[2]
    name = {"uint8": "byte", "bool": "boolean", "float64": "double"}.get(name, name)
    return name + ("_t" if name.startswith("int") else "") + "[]" * len(field.dimensions)


@pytest.mark.parametrize("struct", _STRUCTS)
def test_the_page_has_each_field_of_a_struct(struct):
    cls = message_class(struct)
    rows = re.findall(r"^\| `(\w+)` \| ([^ |]+) \|", _section(struct.split("/")[1]), re.MULTILINE)
    assert rows == [(one.name, _lcm_type(one)) for one in fields(cls)]


@pytest.mark.parametrize("struct", _STRUCTS)
def test_the_page_says_how_a_struct_may_change(struct):
    text = _section(struct.split("/")[1]).lstrip()
    kind = re.match(r"(Frozen|Appendable)\.(?: Fingerprint (0x[0-9A-F]{16})\.)?", text)
    assert kind, text[:80]
    source = Path(__file__).parents[3] / "lcm_types" / f"{struct}.lcm"
    comment = " ".join(source.read_text().replace("//", "").split())
    assert {"Frozen": "this struct never", "Appendable": "new fields are"}[kind[1]] in comment
    if kind[2]:
        assert int(kind[2], 16) == fingerprint(message_class(struct))


def test_the_page_has_the_version_and_the_channels():
    assert f"The current version of the protocol is {VERSION}." in _PAGE
    assert set(re.findall(r"^\| `(/_lcmtools/\w+)`", _PAGE, re.MULTILINE)) == {
        *PROTOCOL_CHANNELS,
        STEP_CHANNEL,
    }
