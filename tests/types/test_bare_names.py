"""Types without a package: their names in full mean them, whatever others end so."""

import pytest

from lcmtools import message_class
from lcmtools.errors import UnknownType
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import candidates, fingerprint, means_type, type_name, type_names
from lcmtools.messages.type_versions import other_version

OWN = ("Image", "Joy", "Log", "Path", "Pose", "Time")


@pytest.mark.parametrize("name", ["gain_t", *OWN])
def test_a_name_in_full_means_the_type_without_a_package(family, name):
    family("bare")
    cls = message_class(name)
    assert type_name(cls) == name
    assert candidates(fingerprint(cls)) == [name]


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("legacy/gain_t", "legacy/gain_t"),
        ("legacy.gain_t", "legacy/gain_t"),
        ("geometry_msgs/Pose", "geometry_msgs/Pose"),
        ("sensor_msgs.Image", "sensor_msgs/Image"),
        ("Twist", "geometry_msgs/Twist"),
    ],
)
def test_all_others_are_found_as_before(family, written, name):
    family("bare")
    assert type_name(message_class(written)) == name


def test_what_goes_through_all_types_does_not_end_at_them(family):
    family("bare")
    assert other_version(0x1234567812345678, type_names()) is None
    assert [type_name(message_class(name)) for name in type_names()] == type_names()


@pytest.mark.parametrize(
    ("word", "is_type"),
    [
        *(("gain_t", True), ("legacy.gain_t", True), ("legacy/gain_t", True), ("Twist", True)),
        *(("geometry_msgs.Twist", True), ("geometry_msgs/Twst", True), ("gain_t@x", True)),
        *(("GAINS", False), ("/gain_t", False), ("legacy.p", False), ("gain_t.p", False)),
    ],
)
def test_a_type_is_told_from_a_second_topic(family, word, is_type):
    family("bare")
    assert means_type(word) is is_type


def test_a_short_name_of_several_types_is_an_error(family):
    family("alike")
    with pytest.raises(UnknownType, match="several types are called 'Time'"):
        means_type("Time")


@pytest.mark.parametrize("word", ["gain_t", "Pose"])
def test_commands_take_the_name(family, cli, log_of, tmp_path, word):
    family("bare")
    log = log_of("A", encode(message_class(word)()))
    assert cli("type", "-b", log, "A").ok() == f"{word}\n"
    assert cli("find", "-b", log, word).ok() == "A\n"
    assert cli("echo", "-b", log, "A", word).ok() == cli("echo", "-b", log, "A").ok()
    assert cli("wtf", "--bag", log).code == 0
    assert cli("bag", "export", log, str(tmp_path / "a.jsonl")).code == 0
    assert f'"type":"{word}"' in (tmp_path / "a.jsonl").read_text()
