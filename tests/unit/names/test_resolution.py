"""Resolution of names to topics: rule by rule, as in https://wiki.ros.org/Names."""

import pytest
from fixtures.says import assert_says
from hypothesis import given
from hypothesis import strategies as st

from lcmtools import names
from lcmtools.errors import InvalidName, UsageError
from lcmtools.names import Resolver

_NODE = "/husky0/driver"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("/scan", "/scan"),
        ("/a/b", "/a/b"),
        ("scan", "/husky0/scan"),
        ("front/scan", "/husky0/front/scan"),
        ("~gain", "/husky0/driver/gain"),
        ("~/gain", "/husky0/driver/gain"),
        ("~", "/husky0/driver"),
        ("", "/husky0"),
        ("/", "/"),
        ("//a", "/a"),
        ("/a//b", "/a/b"),
        ("/a////b//", "/a/b"),
        ("a//b", "/husky0/a/b"),
        ("/a/", "/a"),
        ("a/", "/husky0/a"),
        ("A_1", "/husky0/A_1"),
        ("/_hidden", "/_hidden"),
        ("/1", "/1"),
    ],
)
def test_a_name_resolves_by_the_ros_rules(name, expected):
    assert names.resolve(name, "/husky0", _NODE) == expected


@pytest.mark.parametrize(
    ("namespace", "expected"),
    [("/", "/a"), ("", "/a"), ("/x", "/x/a"), ("/x/", "/x/a"), ("/x/y", "/x/y/a"), ("//x", "/x/a")],
)
def test_a_relative_name_stands_in_any_namespace(namespace, expected):
    assert names.resolve("a", namespace) == expected


@pytest.mark.parametrize(
    "name",
    [
        "1foo", "_foo", "a b", "a.b", "a-b", "a:b", "a#b", "a+", "été", "/été", "/a/~b", "a~",
        "~~a", "/a\n", "a\n", "\n", " ", "\t", "/a\0", "/a\udcff", "a,b", "*", ".*",
        "\u017f", "/\u0663",  # a long s, and a digit three: letter and digit to Unicode
    ],
)  # fmt: skip
def test_an_illegal_name_is_refused_with_the_rule(name):
    with pytest.raises(InvalidName) as caught:
        names.resolve(name, "/husky0", _NODE)
    assert f"'{name}'" in caught.value.what
    assert "letters, digits" in caught.value.hint


def test_a_private_name_without_a_node_is_refused():
    with pytest.raises(InvalidName, match="private, and there is no node"):
        names.resolve("~gain")


@pytest.mark.parametrize("name", ["”/camera/depth/image_raw”", "“a”"])
def test_quotation_marks_of_a_printed_text_are_named(name):
    with pytest.raises(InvalidName) as raised:
        names.resolve(name)
    assert_says(str(raised.value), name, "quotation marks as a printed text has them", "leave them")


@pytest.mark.parametrize(
    ("given_name", "expected"), [("", "/"), ("/", "/"), ("husky0", "/husky0"), ("/a//b/", "/a/b")]
)
def test_a_namespace_becomes_global(given_name, expected):
    assert names.resolve_namespace(given_name) == expected


@pytest.mark.parametrize("given_name", ["~a", "1a", "a b", "é"])
def test_an_illegal_namespace_is_refused(given_name):
    with pytest.raises(InvalidName):
        names.resolve_namespace(given_name)


@pytest.mark.parametrize(
    ("remaps", "name", "expected"),
    [
        # both sides are resolved in the node's namespace before they are compared
        ([("scan", "laser")], "scan", "/husky0/laser"),
        ([("scan", "laser")], "/husky0/scan", "/husky0/laser"),
        ([("/husky0/scan", "/laser")], "scan", "/laser"),
        ([("scan", "/laser")], "/scan", "/scan"),
        ([("~a", "b")], "~a", "/husky0/b"),
        ([("~a", "b")], "driver/a", "/husky0/b"),
        ([("a", "~b")], "a", "/husky0/driver/b"),
        ([("//scan//", "b//c/")], "/scan", "/husky0/b/c"),
        # matched once: no chain, no swap that comes back
        ([("a", "b"), ("b", "c")], "a", "/husky0/b"),
        ([("a", "b"), ("b", "a")], "a", "/husky0/b"),
        ([("a", "b"), ("b", "a")], "b", "/husky0/a"),
        # exactly: neither prefixes nor namespaces
        ([("a", "b")], "a/c", "/husky0/a/c"),
        ([("a", "b")], "aa", "/husky0/aa"),
        # the last duplicate wins, however it is spelt
        ([("a", "b"), ("a", "c")], "a", "/husky0/c"),
        ([("a", "b"), ("/husky0/a", "c")], "a", "/husky0/c"),
        ([("a", "a")], "a", "/husky0/a"),
    ],
)
def test_remaps_follow_the_ros_rules(remaps, name, expected):
    assert Resolver("/husky0", _NODE, tuple(remaps)).resolve(name) == expected


def test_an_illegal_remap_target_is_refused_when_it_is_used():
    resolver = Resolver("/", "/driver", (("a", "b c"),))
    assert resolver.resolve("other") == "/other"
    with pytest.raises(InvalidName, match="'b c'"):
        resolver.resolve("a")


@pytest.mark.parametrize("length", [1, 62, 63])
def test_a_topic_of_up_to_63_bytes_is_accepted(length):
    name = "/" + "a" * (length - 1) if length > 1 else "/"
    assert Resolver("/", "/n").resolve(name) == name


def test_a_topic_of_64_bytes_is_refused_with_what_was_written():
    resolver = Resolver("/husky0", _NODE)
    with pytest.raises(InvalidName) as caught:
        resolver.resolve("a" * 56)
    assert f"from '{'a' * 56}'" in caught.value.what
    assert "64 bytes" in caught.value.what
    assert "63" in caught.value.what
    assert "shorter" in caught.value.hint


def test_a_remapped_topic_is_measured_after_the_remap():
    resolver = Resolver("/", "/n", (("a" * 80, "b"), ("c", "d" * 80)))
    assert resolver.resolve("a" * 80) == "/b"
    with pytest.raises(InvalidName, match="81 bytes"):
        resolver.resolve("c")


@pytest.mark.parametrize(
    ("channel", "fits"),
    [
        ("é" * 31, True),  # 62 bytes
        ("é" * 31 + "a", True),
        ("é" * 32, False),  # 32 characters, 64 bytes
        ("\U0001f916" * 15, True),
        ("\U0001f916" * 16, False),
        ("\udcff" * 63, True),  # not UTF-8 on the wire: one byte each
        ("\udcff" * 64, False),
        ("a b*.", True),
        ("", False),
        ("a\0b", False),
        ("\ud800", False),
    ],
)
def test_a_literal_channel_is_limited_by_its_bytes_only(channel, *, fits):
    if fits:
        assert names.check_length(channel) == channel
    else:
        with pytest.raises(InvalidName):
            names.check_length(channel)


@pytest.mark.parametrize("name", ["a", "A1", "driver_2", "_hidden"])
def test_a_base_name_is_accepted(name):
    names.check_base_name(name)


@pytest.mark.parametrize("name", ["", "/a", "a/b", "1a", "a b", "~a", "é", "a\n", "a-b"])
def test_a_base_name_with_anything_else_is_refused(name):
    with pytest.raises(InvalidName, match="not a legal node name"):
        names.check_base_name(name)


def test_a_name_error_is_a_usage_error():
    assert issubclass(InvalidName, UsageError)
    assert InvalidName.exit_code == 2


@given(
    st.text("ab/~_1", max_size=20), st.text("ab/", max_size=8), st.text("ab/", max_size=8)
)  # fmt: skip
def test_what_resolves_is_canonical_and_stays_as_it_is(name, space, node):
    namespace = names.resolve_namespace(space)
    try:
        resolved = names.resolve(name, namespace, names.resolve(node))
    except InvalidName:
        return
    assert resolved.startswith("/")
    assert "//" not in resolved
    assert resolved == "/" or not resolved.endswith("/")
    assert names.resolve(resolved, namespace, "/n") == resolved
