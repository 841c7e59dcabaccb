"""Regular expressions of channels, beside Python's own."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire.channel_pattern import ChannelPattern, PatternError

_ATOMS = st.sampled_from(["a", "b", "/", ".", "[ab]", "[^a]", r"\.", r"\w", r"\/", "^", "$"])


def _larger(inner):
    return st.one_of(
        st.lists(inner, max_size=3).map("".join),
        st.lists(inner, min_size=2, max_size=3).map(lambda parts: f"({'|'.join(parts)})"),
        st.tuples(inner, st.sampled_from(["*", "+", "?", "*?", "{2}", "{0,2}", "{1,}"])).map(
            lambda pair: f"(?:{pair[0]}){pair[1]}"
        ),
        inner.map(lambda one: f"(?!{one})"),
        inner.map(lambda one: f"(?={one})"),
    )


@given(st.recursive(_ATOMS, _larger, max_leaves=6), st.text("ab/.", max_size=6))
def test_a_pattern_matches_what_python_matches(pattern, name):
    expected = re.fullmatch(f"(?:{pattern})", name, re.ASCII) is not None
    assert ChannelPattern(pattern).matches(name) == expected


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
    ],
)
def test_a_pattern_is_read_as_servers_of_lcm_read_it(pattern, matching, other):
    read = ChannelPattern(pattern)
    assert (read.matches(matching), read.matches(other)) == (True, False)


@pytest.mark.parametrize("pattern", ["(a*)*b", "(a|a)*b", "((a{1,9}){1,9}){1,9}b", ".*.*.*.*.*.*b"])
def test_no_pattern_takes_exponential_time(pattern):
    assert not ChannelPattern(pattern).matches("a" * 63)  # for ever, where every way is tried


@pytest.mark.parametrize(
    "pattern", ["(", ")", "a**", "*", "[a", "a{", r"(a)\1", "(?<=a)b", "a++", "[a&&b]", "(" * 99]
)
def test_what_is_not_supported_is_refused(pattern):
    with pytest.raises(PatternError, match="is not supported from character"):
        ChannelPattern(pattern)
