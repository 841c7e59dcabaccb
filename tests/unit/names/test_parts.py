"""Parts of names, hidden names, the spellings of a topic that is read, and near misses."""

import pytest

from lcmtools import names


@pytest.mark.parametrize(
    ("name", "hidden"),
    [
        ("/_lcmtools/node", True),
        ("/a/_b", True),
        ("/trigger/_request", True),
        ("_x", True),
        ("LCM_SELF_TEST", True),
        ("#!mpudpm_CH2PRT_UPD", True),
        ("/a_b", False),
        ("/a/b_", False),
        ("EXAMPLE", False),
        ("", False),
        ("/", False),
    ],
)
def test_a_part_that_starts_with_an_underscore_hides_a_name(name, *, hidden):
    assert names.is_hidden(name) is hidden


@pytest.mark.parametrize(
    ("name", "namespace", "base"),
    [
        ("/husky0/odometry", "/husky0", "odometry"),
        ("/odometry", "/", "odometry"),
        ("/a/b/c", "/a/b", "c"),
        ("EXAMPLE", "/", "EXAMPLE"),
    ],
)
def test_a_full_name_has_a_namespace_and_a_base(name, namespace, base):
    assert names.namespace_of(name) == namespace
    assert names.base_name_of(name) == base


@pytest.mark.parametrize(
    ("name", "namespace", "expected"),
    [
        ("EXAMPLE", "/", ["EXAMPLE", "/EXAMPLE"]),
        ("chatter", "/ns", ["chatter", "/ns/chatter"]),
        ("/chatter", "/ns", ["/chatter"]),
        ("/chatter/", "/", ["/chatter/", "/chatter"]),
        ("//a//b", "/", ["//a//b", "/a/b"]),
        ("a/b", "/", ["a/b", "/a/b"]),
        ("BODY.STATE", "/", ["BODY.STATE"]),
        ("12345", "/", ["12345"]),
        ("été", "/", ["été"]),
        ("~a", "/", ["~a"]),
        ("", "/", [""]),
    ],
)
def test_a_topic_that_is_read_is_the_channel_or_the_topic(name, namespace, expected):
    assert list(names.spellings(name, namespace)) == expected


def test_a_near_miss_is_suggested():
    assert names.did_you_mean("udmp", ["udpm", "tcpq"]) == "did you mean udpm?"
    assert names.did_you_mean("CHATER", ["/chatter", "/scan"]) == "did you mean /chatter?"
    assert names.did_you_mean("position", ["friction", "size"]) == ""
    assert names.did_you_mean("zzz", ["udpm", "tcpq"]) == ""
    assert names.did_you_mean("anything", []) == ""
    assert names.did_you_mean("memq", ["memq", "mema"]) == "did you mean mema?"


def test_a_shared_namespace_makes_no_name_nearer():
    assert names.did_you_mean("/husky0/evaluation_stat", ["/husky0/ground_truth"]) == ""
    near = names.did_you_mean("/husky0/odom", ["/husky0/ground_truth", "/husky0/odometry"])
    assert near == "did you mean /husky0/odometry?"
    assert names.did_you_mean("/cmd_vel", ["/husky0/cmd_vel"]) == "did you mean /husky0/cmd_vel?"


def test_the_closest_names_come_best_first():
    assert names.closest("/chatter", ["/chatter2", "/chatters_x", "/scan"], 2) == [
        "/chatter2",
        "/chatters_x",
    ]
