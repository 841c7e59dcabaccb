"""Keys of Zenoh: one for each channel, whatever its name."""

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.bus.zenoh.keys import Keys, Named, is_legal_prefix

LCM, DIMOS = Keys("lcm"), Keys("dimos")
_CHARACTERS = st.one_of(
    st.sampled_from("/#?$*@% .a_\udc80"), st.characters(exclude_characters="\0")
)
_CHANNELS = st.text(_CHARACTERS, min_size=1, max_size=20).filter(
    lambda name: "\0" not in name and _is_bytes(name)
)
_TYPES = st.sampled_from(["", "geometry_msgs/Twist", "a/B", "no package", "a.b/C"])


def _is_bytes(name):
    """A channel's name is bytes, read as UTF-8 where it can be."""
    try:
        data = name.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        return False
    return data.decode("utf-8", "surrogateescape") == name


@pytest.mark.parametrize(
    ("channel", "key"),
    [
        ("EXAMPLE", "lcm/EXAMPLE"),
        ("/husky0/odometry", "lcm/%2Fhusky0/odometry"),
        ("odom#nav_msgs.Odometry", "lcm/odom%23nav_msgs.Odometry"),
        ("a b", "lcm/a%20b"),
        ("@hidden", "lcm/%40hidden"),
        ("a//b/", "lcm/a/%2Fb%2F"),
        ("/", "lcm/%2F"),
        ("\udcff", "lcm/%FF"),
    ],
)
def test_key_of_a_channel(channel, key):
    assert LCM.key(channel) == key
    assert LCM.named(key) == Named(channel)


@pytest.mark.parametrize(
    ("channel", "type_name", "key"),
    [
        ("/cmd_vel", "geometry_msgs/Twist", "dimos/cmd_vel/geometry_msgs.Twist"),
        ("/robot/data", "", "dimos/robot/data"),
        ("EXAMPLE", "exlcm/example_t", "dimos/%/EXAMPLE/exlcm.example_t"),
        ("/a/geometry_msgs.Twist", "", "dimos/a/geometry_msgs%2ETwist"),
        ("/", "", "dimos/%/%2F"),
    ],
)
def test_dimos_key_names_the_type(channel, type_name, key):
    assert DIMOS.key(channel, type_name) == key
    assert DIMOS.named(key) == Named(channel, type_name)


@given(_CHANNELS)
def test_every_channel_has_a_key_of_its_own(channel):
    key = LCM.key(channel)
    assert LCM.named(key) == Named(channel)
    assert zenoh.KeyExpr(LCM.all).includes(zenoh.KeyExpr(key))


@given(_CHANNELS, _TYPES)
def test_every_channel_has_a_dimos_key_of_its_own(channel, type_name):
    key = DIMOS.key(channel, type_name)
    named = DIMOS.named(key)
    assert named is not None
    assert named.channel == channel
    assert named.type_name in ("", type_name)
    assert zenoh.KeyExpr(DIMOS.all).includes(zenoh.KeyExpr(key))
    patterns = [zenoh.KeyExpr(pattern) for pattern in DIMOS.patterns(channel)]
    assert sum(pattern.intersects(zenoh.KeyExpr(key)) for pattern in patterns) == 1


def test_key_below_another_prefix_is_no_channel():
    assert LCM.named("lcmx/a") is None
    assert LCM.named("lcm") is None


def test_prefix_is_letters_digits_and_parts():
    assert is_legal_prefix("lab/robot-7")
    for text in ("", "/a", "a/", "a//b", "a*", "@a", "a b"):
        assert not is_legal_prefix(text)
