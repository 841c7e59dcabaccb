"""Types with the same name in several folders: each is known by its fingerprint."""

import json

import pytest

from lcmtools import message_class, to_dict
from lcmtools.bag.index_notes import recorded_types
from lcmtools.errors import UnknownType
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import (
    candidates,
    fingerprint,
    type_name,
    versioned,
    versions,
)
from lcmtools.messages.supply import set_supply
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.packages import provide_recorded_types, provide_user_types
from lcmtools.wire.log_index import LogIndex, index_line, parse_index, type_line
from lcmtools.wire.packet import Packet

OLD = ("rover/state_t", "rover/pose_t", "rover/mode_t")


def old(name):
    return message_class(f"{name}@old/{name.rpartition('/')[2]}.lcm")


def test_every_struct_is_known_by_its_fingerprint(family):
    family("versions")
    for name in OLD:
        new = message_class(name)
        assert fingerprint(new) != fingerprint(old(name))
        for cls in (new, old(name)):
            number = fingerprint(cls)
            assert candidates(number) == [name]
            assert message_class(name, number) is cls
            assert message_class(versioned(name, number)) is cls
            assert type(decode(cls, encode(cls()))) is cls


def test_a_version_is_made_of_the_types_beside_it(family):
    family("versions")
    assert fields(old("rover/state_t"))[0].message_class is old("rover/pose_t")
    trail = message_class("rover/trail_t")  # which only the old folder has
    assert fields(trail)[1].message_class is old("rover/pose_t")


@pytest.mark.parametrize(
    ("version", "slots"),
    [
        ("old/state_t.lcm", 2),
        ("new/state_t.lcm", 3),
        ("./versions/old/state_t.lcm", 2),
        ("0xe77dcbf86d862546", 2),
    ],
)
def test_the_choice_is_written_behind_the_name(family, version, slots):
    family("versions")
    for name in ("rover/state_t", "rover.state_t", "state_t"):
        assert len(message_class(f"{name}@{version}").__slots__) == slots


@pytest.mark.parametrize("version", ["state_t.lcm", "older/state_t.lcm", "0x1", "lcmtools"])
def test_a_version_that_is_unknown_or_not_the_only_one_names_the_choice(family, version):
    family("versions")
    names = "rover/state_t@new/state_t.lcm or rover/state_t@old/state_t.lcm"
    with pytest.raises(
        UnknownType, match=f"unknown version '{version}' of rover/state_t; write {names}"
    ):
        message_class(f"rover/state_t@{version}")


def test_the_name_alone_means_the_first_and_a_line_says_so(family, caplog):
    family("versions")
    message_class("rover/state_t", fingerprint(old("rover/state_t")))
    assert not caplog.messages, "nothing was left open"
    assert len(message_class("rover/state_t").__slots__) == 3
    assert caplog.messages[0].endswith(
        "; the first is used, the other is rover/state_t@old/state_t.lcm"
    )


def test_lcmtools_own_type_is_a_version_too(monkeypatch, family, tmp_path):
    family("versions")
    shipped = message_class("std_msgs/String")
    (tmp_path / "s.lcm").write_text("package std_msgs;\nstruct String { string text; }\n")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    provide_user_types()
    assert message_class("std_msgs/String").__slots__ == ["text"]
    assert message_class("std_msgs/String@lcmtools") is shipped
    assert versioned("std_msgs/String", fingerprint(shipped)) == "std_msgs/String@lcmtools"


def test_a_broken_file_does_not_hide_a_type_with_another_fingerprint(monkeypatch, family, tmp_path):
    family("versions")
    number = fingerprint(message_class("std_msgs/String"))
    (tmp_path / "std_msgs").mkdir()
    (tmp_path / "std_msgs/String.lcm").write_text("package std_msgs;\nstruct String {")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    provide_user_types()
    assert message_class("std_msgs/String", number).__slots__ == ["data"]


def test_a_log_with_both_decodes(family, cli, log_of):
    family("versions")
    log = log_of("STATE", encode(message_class("rover/state_t")()), encode(old("rover/state_t")()))
    shown = cli("echo", "-b", log, "STATE", "--flow-style").ok().splitlines()[::2]
    assert shown == [
        "{pose: {x: 0.0, y: 0.0}, mode: 0, note: ''}",
        "{pose: {x: 0.0, y: 0.0}, mode: 0}",
    ]
    assert (
        cli("echo", "-b", log, "STATE", "rover/state_t", "--flow-style").ok().split("\n---\n")[:2]
        == shown
    )
    only = cli("echo", "-b", log, "STATE", "rover/state_t@old/state_t.lcm", "--flow-style").out
    assert "the type is not rover/state_t@old/state_t.lcm but rover/state_t\n" in only
    assert shown[1] in only
    assert cli("list", "-b", log, "-t").ok() == (
        "STATE [rover/state_t, rover/state_t@old/state_t.lcm]\n"
    )


def test_a_log_keeps_both_for_a_computer_without_their_files(family):
    family("versions")
    classes = [message_class("rover/state_t"), old("rover/state_t"), message_class("rover/trail_t")]
    packets = [Packet("A", encode(cls()), 0) for cls in classes]
    lines = [index_line(), *map(type_line, recorded_types(packets, Decoder(lambda _: ())))]
    index = parse_index(line.rstrip("\n") for line in lines)
    assert isinstance(index, LogIndex)
    set_supply(None)
    family("near")
    assert candidates(fingerprint(classes[1])) == []
    provide_recorded_types(index.types.values())
    for packet, cls in zip(packets, classes, strict=True):
        found = Decoder(lambda _: ()).decode(packet)
        assert (type_name(found), fingerprint(type(found))) == (type_name(cls), fingerprint(cls))


def test_wtf_says_how_versions_differ(family):
    from fixtures.judging import findings

    from lcmtools.graph.model import Traffic
    from lcmtools.wire.packet import Sender

    family("versions")
    for name, words in (
        ("rover/mode_t", "rover/mode_t is rover/mode_t@old/mode_t.lcm with note added at the end"),
        (
            "rover/state_t",
            "rover/state_t and rover/state_t@old/state_t.lcm differ in pose.x and pose.y and note",
        ),
    ):
        numbers = fingerprint(message_class(name)), fingerprint(old(name))
        seen = [
            Traffic("CHANNEL", Sender("10.0.0.1", 4000 + n), (number,), 1, 8, 0, 0)
            for n, number in enumerate(numbers)
        ]
        found = findings(traffic=seen)["type-mismatch"]
        assert any(words in item for item in found.items), found.items
        assert found.remedies == (
            "generate the code of both sides from the same .lcm files: lcm-gen",
        )


POSES = {
    "a/pose_t.lcm": "struct pose_t { double x; }",
    "b/pose_t.lcm": "struct pose_t { float x; }",
    "b/deep/pose_t.lcm": "struct pose_t { int8_t x; }",
    "c.lcm": "struct pose_t { int16_t x; } struct state_t { pose_t pose; }",
}
STATE = "struct state_t { pose_t pose; }"


@pytest.mark.parametrize(
    ("file", "kind"),
    [
        ("a/state_t.lcm", "float64"),
        ("b/state_t.lcm", "float32"),
        ("b/other/state_t.lcm", "float32"),
        ("b/deep/state_t.lcm", "int8"),
        ("c.lcm", "int16"),
    ],
)
def test_a_field_has_the_version_nearest_to_its_file(monkeypatch, tmp_path, file, kind):
    for name, text in ({file: STATE} | POSES).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"package rover;\n{text}\n")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    provide_user_types()
    known = versions("rover/state_t")
    number = next(one for one, path in known.items() if path == str(tmp_path / file))
    state = message_class("rover/state_t", number)
    pose = fields(state)[0].message_class
    assert pose is not None
    assert fields(pose)[0].type == kind


def test_equal_types_of_several_files_are_one(monkeypatch, tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.lcm").write_text(f"package rover;\n{POSES['c.lcm']}\n")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    provide_user_types()
    assert list(versions("rover/state_t").values()) == [str(tmp_path / "a/x.lcm")]
    state = message_class("rover/state_t")
    assert fields(state)[0].message_class is message_class("rover/pose_t")


def test_json_of_both_names_both(family, cli, log_of):
    family("versions")
    log = log_of("STATE", encode(old("rover/state_t")()))
    (row,) = json.loads(cli("list", "-b", log, "--json").ok())
    assert row["types"] == ["rover/state_t@old/state_t.lcm"]
    assert row["other_senders"] == [None]


def test_a_log_keeps_enums_that_have_files_of_their_own(tmp_path, monkeypatch, family):
    for name, text in (
        ("mode_t.lcm", "enum mode_t { IDLE=0, RUN=1 }"),
        ("state_t.lcm", "struct state_t { mode_t mode; }"),
    ):
        (tmp_path / name).write_text(f"package lander;\n{text}\n")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    provide_user_types()
    packet = Packet("A", encode(message_class("lander/state_t")(mode="RUN")), 0)
    kept = recorded_types([packet], Decoder(lambda _: ()))
    assert [one.path for one in kept] == ["lander/state_t.lcm", "lander/mode_t.lcm"]
    family("near")
    provide_recorded_types(kept)
    assert to_dict(Decoder(lambda _: ()).decode(packet)) == {"mode": "RUN"}
