"""Regular expressions of channels, and those that could block a server."""

import re

import pytest

from lcmtools.wire.channel_pattern import ChannelPattern, PatternError


@pytest.mark.parametrize(
    ("pattern", "matching", "other"),
    [
        (re.escape("/a b#c.d"), "/a b#c.d", "/a b#cxd"),
        (r"\QA.*\E.*", "A.*B", "AB"),
        ("(?i)pose", "POSE", "POST"),
        ("CAMERA_[0-9]+", "CAMERA_12", "CAMERA_"),
        ("(?!CAMERA).*", "LIDAR", "CAMERA_1"),
        (r"\x41\d", "A1", "B1"),
        ("[]a]+", "a]", "[a"),
        ("é*", "éé", "e"),
        ("(FRONT|REAR)_(LEFT)?.*", "REAR_LEFT_1", "SIDE_LEFT"),
        ("A|AB", "AB", "B"),
    ],
)
def test_a_pattern_is_read_as_servers_of_lcm_read_it(pattern, matching, other):
    read = ChannelPattern(pattern)
    assert (read.matches(matching), read.matches(other)) == (True, False)


@pytest.mark.parametrize(
    "pattern",
    [
        *("(a*)*b", "(a|a)*b", "((a{1,9}){1,9}){1,9}b", "(?:(a)?)+b", ".*.*.*.*b"),
        *("a?" * 7 + "b", "((a)|a)*b", "(?P<n>a+)+b", "(?=a+)+b", "(a{,5}){9}"),
    ],
)
def test_what_may_take_long_is_refused(pattern):
    with pytest.raises(PatternError, match="not supported: it repeats too much"):
        ChannelPattern(pattern)


@pytest.mark.timing
@pytest.mark.parametrize(
    "pattern", [".*.*.*b", "a?a?a?.*.*.*b", "(a?a?a?)[a-z]+a*a*b", "(ab)*a*a*b"]
)
def test_what_is_left_does_not(pattern, stopwatch):
    watch = stopwatch()
    assert not ChannelPattern(pattern).matches("a" * 63)
    assert watch.seconds() < 0.5


@pytest.mark.parametrize(
    "pattern", ["(", ")", "a**", "*", "[a", "[a&&b]", "(" * 99, "a{99999999999}", r"\p{L}"]
)
def test_what_is_not_supported_is_refused(pattern):
    with pytest.raises(PatternError, match="is not supported: "):
        ChannelPattern(pattern)
