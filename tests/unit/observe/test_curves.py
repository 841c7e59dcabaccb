"""Fields over time as curves."""

import json
import math
from pathlib import Path
from typing import Any, ClassVar

import pytest
from fixtures.says import assert_says, raises_saying
from PIL import Image as Picture

from lcmtools.bus.url import parse_url
from lcmtools.errors import LcmtoolsError, UsageError, ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.observe.measuring.curves import (
    Curve,
    Curves,
    draw_curves,
    draw_picture,
    draw_text,
    empty_figure,
    value_limits,
)
from lcmtools.observe.reading.find import GLOBAL
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import Bool, Empty, String
from lcmtools.wire.packet import Packet

_SECOND = 10**9
_LIMITS = json.loads((Path(__file__).parents[2] / "fixtures" / "value_limits.json").read_text())


class _Log:
    """A source of some messages."""

    port, is_live, is_log, is_awaiting, has_strangers = 0, False, True, False, False
    numbered: ClassVar[dict[Any, Any]] = {}

    def __init__(self, packets):
        self._packets = list(packets)

    def receive(self, timeout):  # noqa: ARG002 - as sources have it
        """Return all at once, then end."""
        if not self._packets:
            raise EOFError
        packets, self._packets = self._packets, []
        return packets

    def send(self, channel, payload):
        """Send nothing."""

    def close(self):
        """Close nothing."""


def _of(packets, path, window=None):
    monitor = BusMonitor(parse_url("file://a"), "test", {}, _Log(packets))
    curves = Curves(monitor, [f"/a/{path}"], GLOBAL, _told.append, window)
    _told.clear()
    assert not list(curves.follow())
    return {curve.label: curve for curve in curves}


_told = []


def _curves(messages, path, window=None):
    packets = [Packet("/a", encode(one), (n + 1) * _SECOND) for n, one in enumerate(messages)]
    return _of(packets, path, window)


def _twists(count):
    twists = [Twist() for _ in range(count)]
    for number, twist in enumerate(twists):
        twist.linear.x = number / 2
    return twists


def test_a_field_is_a_curve_over_seconds():
    found = _curves(_twists(4), "linear.x")
    assert found == {
        "/a/linear.x": Curve("/a/linear.x", [1.0, 2.0, 3.0, 4.0], [0.0, 0.5, 1.0, 1.5])
    }


def test_an_array_is_a_curve_for_each_element():
    scan = LaserScan()
    scan.ranges = [1.0, 2.0, 4.0]
    found = _curves([scan], "ranges")
    assert {label: curve.values for label, curve in found.items()} == {
        "/a/ranges[0]": [1.0],
        "/a/ranges[1]": [2.0],
        "/a/ranges[2]": [4.0],
    }
    assert list(_curves([scan], "ranges[1]")) == ["/a/ranges[1]"]


def test_a_message_is_a_curve_for_each_of_its_numbers():
    assert list(_curves([Twist()], "")) == [
        f"/a/{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"
    ]
    assert list(_curves([Odometry()], "pose.pose.position")) == [
        f"/a/pose.pose.position.{axis}" for axis in "xyz"
    ]
    assert list(_curves([Twist()], "linear")) == [f"/a/linear.{axis}" for axis in "xyz"]


def test_booleans_and_times_are_numbers():
    flag, odometry = Bool(), Odometry()
    flag.data = True
    odometry.header.stamp.sec, odometry.header.stamp.nsec = 12, 500_000_000
    assert _curves([flag], "data")["/a/data"].values == [1.0]
    assert _curves([odometry], "header.stamp")["/a/header.stamp"].values == [12.5]


def test_only_the_window_is_kept():
    assert _curves(_twists(6), "linear.x", 2.0)["/a/linear.x"].times == [4.0, 5.0, 6.0]


def test_what_is_no_number_is_refused():
    scan = LaserScan()
    scan.ranges = [0.0] * 21
    with raises_saying(UsageError, "data", "string", "number"):
        _curves([String()], "data")
    with raises_saying(UsageError, "no number"):
        _curves([Empty()], "")
    with raises_saying(UsageError, "ranges", "21 numbers", "; ", "ranges[0]"):
        _curves([scan], "ranges")
    with pytest.raises(ValueMismatch, match="no field 'lineer'"):
        _curves([Twist()], "lineer.x")


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_picture_is_written(suffix, tmp_path):
    path = tmp_path / f"a{suffix}"
    draw_picture([Curve("/a/x", [0.0, 1.0], [1.0, math.nan]), Curve("/b", [5.0], [1.0])], path)
    if suffix == ".png":
        with Picture.open(path) as picture:
            assert len(picture.convert("RGB").getcolors(1 << 24) or ()) > 3
    assert path.stat().st_size > 1000


def test_a_picture_of_another_kind_or_place_is_refused(tmp_path):
    with raises_saying(UsageError, "a.txt", "not a picture", "; ", ".png"):
        draw_picture([], tmp_path / "a.txt")
    with raises_saying(LcmtoolsError, "cannot write", "a.png: No such file"):
        draw_picture([Curve("/a")], tmp_path / "gone" / "a.png")


def test_text_has_the_size_and_the_names_of_curves():
    curves = [Curve("/a/x", [10.0, 11.0, 12.0], [0.0, math.inf, 2.0]), Curve("/b/y")]
    text = draw_text(curves, 60, 12, colored=False)
    rows = text.splitlines()
    assert len(rows) == 12
    assert max(map(len, rows)) == 60
    assert "/a/x" in text
    assert "time [s]" in text
    assert "\x1b" not in text
    assert "\x1b" in draw_text(curves, 60, 12, colored=True)


def test_a_message_that_cannot_be_decoded_is_left_out():
    twist = Packet("/a", encode(Twist()), 5)
    bad = Packet("/a", b"no LCM", 5)
    assert _of([bad, twist, bad], "linear.x")["/a/linear.x"].values == [0.0]
    (note,) = _told
    assert_says(note, "/a", "left out", "too short")


def test_curves_begin_again_where_time_goes_back():
    packets = [Packet("/a", encode(Twist()), time * _SECOND) for time in (100, 101, 2)]
    assert _of(packets, "linear.x", 10.0)["/a/linear.x"].times == [2.0]


@pytest.mark.parametrize(("least", "most", "low", "high"), _LIMITS)
def test_the_value_axis_does_not_zoom_into_noise(least, most, low, high):
    ends = (math.inf, -math.inf) if least is None or most is None else (least, most)
    assert value_limits(*ends) == pytest.approx((low, high), rel=1e-7)


def test_noise_is_flat_in_the_picture_and_in_the_terminal():
    noise = Curve("/a", [0.0, 1.0, 2.0], [5.0, math.nan, 5.0000004])
    axes = empty_figure(4, 3).add_subplot()
    draw_curves(axes, [noise])
    assert axes.get_ylim() == pytest.approx((4.5, 5.5), abs=1e-6)
    text = draw_text([noise], 60, 12, colored=False)
    assert "4.5" in text
    assert "5.5" in text
