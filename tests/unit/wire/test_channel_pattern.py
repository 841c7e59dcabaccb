"""Regular expressions of channels, beside Python's own."""

import re

import pytest

from lcmtools.wire.channel_pattern import PatternError, compile_pattern


@pytest.mark.parametrize(
    ("pattern", "matching", "other"),
    [
        (re.escape("/a b#c.d"), "/a b#c.d", "/a b#cxd"),
        (r"\QA.*\E.*", "A.*B", "AB"),
        ("(?i)pose", "POSE", "POST"),
        ("CAMERA_[0-9]+", "CAMERA_12", "CAMERA_"),
        ("(?!CAMERA).*", "LIDAR", "CAMERA_1"),
        (r"\x41\d", "A1", "B1"),
        (r"[]a]+\z", "a]", "[a"),
        ("(?<name>a|b)*", "ab", "c"),
        ("(LIDAR|CAMERA(_[0-9]{1,3})?)_.*", "CAMERA_1_LEFT", "CAMERA"),
        (".*a.*a.*", "bab a", "bab"),
        (r"\\QE", "\\QE", "E"),
        ("é*", "éé", "e"),
        ("A|AB", "AB", "B"),
    ],
)
def test_a_pattern_is_read_as_servers_of_lcm_read_it(pattern, matching, other):
    read = compile_pattern(pattern)
    assert read.fullmatch(matching)
    assert not read.fullmatch(other)


@pytest.mark.parametrize(
    "pattern",
    [
        "(a*)*b",
        "(a|aa)*b",
        "(?:(a)?)+b",
        "((a)|a)*b",
        "(?P<n>a+)+b",
        "(a{,5}){9}",
        "(a?){50}b",
        30 * "a?" + "b",
        "((a{1,9}){1,9}){1,9}b",
        "(?=(a+)+b)a",
        ".*.*.*.*b",
        r"(a)\1",
    ],
)
def test_what_could_take_too_long_is_refused(pattern):
    with pytest.raises(PatternError, match="could take too long to match"):
        compile_pattern(pattern)


@pytest.mark.parametrize(
    ("pattern", "place"),
    [
        ("(a", 1),
        ("a)", 2),
        ("a**", 3),
        ("b[a", 2),
        ("(?u)a", ""),
        ("(" * 9999, ""),
        ("[a&&b]", ""),
        (r"\p{L}", 1),
    ],
)
def test_what_is_no_regular_expression_is_refused(pattern, place):
    text = f"is not supported from character {place}" if place else "is not supported"
    with pytest.raises(PatternError, match=text):
        compile_pattern(pattern)
