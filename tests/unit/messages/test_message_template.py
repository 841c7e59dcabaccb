"""Messages in which a time is the moment of sending."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import decode
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import message_class

NOW = 1_795_244_479_000_000_005


def stamps(value):
    """All times in a plain message."""
    if isinstance(value, dict):
        if "sec" in value:
            return [(value["sec"], value.get("nsec", value.get("nanosec")))]
        return [stamp for part in value.values() for stamp in stamps(part)]
    return [stamp for part in value for stamp in stamps(part)] if isinstance(value, list) else []


@pytest.mark.parametrize(
    ("name", "texts"),
    [
        ("std_msgs/Time", ["now"]),
        ("builtin_interfaces/Time", ["now"]),
        ("rosgraph_msgs/Clock", ["now"]),
        ("rosgraph_msgs/Clock", ["clock: now"]),
        ("rosgraph_msgs/Clock", ["[now]"]),
        ("std_msgs/Header", ["auto"]),
        ("std_msgs/Header", ["stamp: now"]),
        ("std_msgs/Header", ["0", "now", "map"]),
        ("geometry_msgs/PoseStamped", ["header: auto"]),
        ("geometry_msgs/PoseStamped", ["header: now"]),
        ("geometry_msgs/PoseStamped", ["header: {stamp: now, frame_id: map}"]),
        ("geometry_msgs/PoseStamped", ["header: {stamp: auto}"]),
        ("geometry_msgs/PoseStamped", ["auto", "{}"]),
        ("geometry_msgs/PoseStamped", ["{stamp: now}", "{}"]),
        ("geometry_msgs/PoseStamped", ['{"header": {"stamp": "now"}}']),
        ("tf2_msgs/TFMessage", ["transforms: [{header: auto}]"]),
        ("tf2_msgs/TFMessage", ["[{header: {stamp: now}}]"]),
        ("nav_msgs/Path", ["{header: auto, poses: []}"]),
    ],
)
def test_now_and_auto_are_the_moment_of_each_sending(name, texts):
    draft = draft_from_values(message_class(name), texts)
    for moment in (NOW, NOW + 1_500_000_000):
        sent = decode(message_class(name), draft.payload(moment))
        assert stamps(to_plain(sent)) == [divmod(moment, 1_000_000_000)]


def test_what_is_beside_a_word_for_the_time_is_kept():
    text = "{header: {stamp: now, frame_id: now, seq: 7}, poses: [{header: auto}, {}]}"
    message = draft_from_values(message_class("nav_msgs/Path"), [text]).at(NOW)
    plain = to_plain(message)
    assert plain["header"] == {
        "seq": 7,
        "stamp": {"sec": 1_795_244_479, "nsec": 5},
        "frame_id": "now",
    }
    assert stamps(plain["poses"]) == [(1_795_244_479, 5), (0, 0)]


class Pose:
    """A message with LCM's own time, as lcm-gen writes it."""

    __slots__ = ("utime", "x")
    __typenames__ = ("int64_t", "double")
    __dimensions__ = (None, None)

    def __init__(self):
        self.utime, self.x = 0, 0.0


@pytest.mark.parametrize("texts", [["{utime: now, x: 1}"], ["now", "1"]])
def test_a_utime_may_be_now_in_microseconds(texts):
    draft = draft_from_values(Pose, texts)
    for moment in (NOW, NOW + 1_500_000_000):
        message = draft.at(moment)
        assert (message.utime, message.x) == (moment // 1000, 1.0)


def reading(name, lcm_type):
    """Return a class with one field, as lcm-gen writes it."""
    tables = {
        "__slots__": (name,),
        "__typenames__": (lcm_type,),
        "__dimensions__": (None,),
        "__init__": lambda self: setattr(self, name, 0),
    }
    return type("Reading", (), tables)


@pytest.mark.parametrize(
    ("name", "lcm_type", "value"),
    [
        ("timestamp", "int64_t", NOW // 1000),
        ("t", "int64_t", NOW // 1000),
        ("gps_utime", "int64_t", NOW // 1000),
        ("time_us", "int64_t", NOW // 1000),
        ("timestamp_micros", "int64_t", NOW // 1000),
        ("time_ms", "int64_t", NOW // 10**6),
        ("timestamp_millis", "int64_t", NOW // 10**6),
        ("t_msec", "int64_t", NOW // 10**6),
        ("time_ns", "int64_t", NOW),
        ("time_nsecs", "int64_t", NOW),
        ("stamp_nanos", "int64_t", NOW),
        ("timestamp", "double", NOW / 10**9),
        ("time_ms", "double", NOW / 10**6),
    ],
)
def test_a_number_whose_name_is_of_a_time_may_be_now(name, lcm_type, value):
    cls = reading(name, lcm_type)
    draft = draft_from_values(cls, [f"{name}: now"])
    assert getattr(draft.at(NOW), name) == value


@pytest.mark.parametrize(
    ("name", "lcm_type"), [("timestamp", "int32_t"), ("seq", "int64_t"), ("timeout", "int64_t")]
)
def test_a_number_that_holds_no_time_may_not_be_now(name, lcm_type):
    cls = reading(name, lcm_type)
    with raises_saying(ValueMismatch, f"{name}: expected an integer", "'now'"):
        draft_from_values(cls, [f"{name}: now"])


def test_another_number_is_no_time():
    with raises_saying(ValueMismatch, "seq: expected an integer", "'now'"):
        draft_from_values(message_class("std_msgs/Header"), ["seq: now"])


@pytest.mark.parametrize(
    ("name", "text", "stamp"),
    [
        ("std_msgs/Time", "10000000020", (10, 20)),
        ("std_msgs/Time", "{sec: 1, nsec: 2}", (1, 2)),
        ("std_msgs/Duration", "1500000000", (1, 500_000_000)),
        ("std_msgs/Duration", "-500000000", (-1, 500_000_000)),
        ("rosgraph_msgs/Clock", "5", (0, 5)),
        ("std_msgs/Header", "stamp: 1000000001", (1, 1)),
    ],
)
def test_a_time_may_be_a_number_of_nanoseconds(name, text, stamp):
    draft = draft_from_values(message_class(name), [text])
    assert not draft.times
    assert stamps(to_plain(draft.message)) == [stamp]


def test_what_does_not_change_is_encoded_once():
    draft = draft_from_values(message_class("std_msgs/String"), ["now"])
    assert draft.message.data == "now"
    assert draft.payload(NOW) is draft.payload(NOW + 1)


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("std_msgs/Duration", "now", "std_msgs/Duration: expected fields (sec, nsec), got 'now'"),
        ("std_msgs/Time", "{sec: now}", "sec: expected an integer, got 'now'"),
        (
            "std_msgs/Header",
            "later",
            "std_msgs/Header: expected fields (seq, stamp, frame_id), got 'later'",
        ),
        ("geometry_msgs/Twist", "linear: auto", "linear: expected fields (x, y, z), got 'auto'"),
        (
            "nav_msgs/Path",
            "poses: auto",
            "poses: expected a list of messages, got 'auto'",
        ),
        ("nav_msgs/Path", "poses: [[auto]]", "poses[0]: expected 2 values (header, pose), got 1"),
        (
            "std_msgs/Time",
            "99999999999999999999",
            "std_msgs/Time: expected fields (sec, nsec), got '99999999999999999999'",
        ),
        (
            "std_msgs/Time",
            "9223372036854775807",
            "sec: 9223372036 does not fit int32 (-2147483648..2147483647)",
        ),
    ],
)
def test_other_places_have_no_words_for_the_time(name, text, line):
    with pytest.raises(ValueMismatch) as caught:
        draft_from_values(message_class(name), [text])
    assert str(caught.value) == line
