"""The stream of a plot."""

import math
from array import array

import pytest
from fixtures.gui import FakeSource
from fixtures.says import assert_says

from lcmtools.gui.streams import plot
from lcmtools.gui.streams.plot import Plot
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState
from lcmtools.types.std_msgs import Float64, String


def _open(source, *fields):
    stream = Plot(source, fields=fields, choice=3)
    stream.update()  # it follows what is there
    return stream


def _samples(update):
    values = array("d", bytes(update.payload or b""))
    return list(zip(values[::3], values[1::3], values[2::3], strict=True))


def _float(value):
    message = Float64()
    message.data = value
    return message


def _problems(update):
    return [one["problem"] for one in update.data["fields"]]


def test_every_sample_comes_with_its_time_and_its_curve():
    source = FakeSource()
    source.know(a=Float64, b=Float64)
    stream = _open(source, "/a/data", "/b/data")
    source.put("/b", _float(1.5), 10.25)
    source.put("/a", _float(2.5), 10.5)
    source.put("/b", _float(3.5), 10.75)
    update = stream.update()
    assert _samples(update) == [(10.25, 1.5, 0), (10.5, 2.5, 1), (10.75, 3.5, 0)]
    assert update.data["curves"] == ["/b/data", "/a/data"]
    assert update.data["choice"] == 3
    assert update.data["fields"] == [
        {"text": "/a/data", "problem": "", "curves": [1]},
        {"text": "/b/data", "problem": "", "curves": [0]},
    ]
    assert stream.update() is None
    source.put("/a", _float(math.nan), 11.0)
    update = stream.update()
    assert math.isnan(_samples(update)[0][1])
    assert "curves" not in update.data


def test_an_array_and_a_message_are_a_curve_for_each_number():
    source = FakeSource()
    source.know(joints=JointState, v=Twist)
    stream = _open(source, "/joints/position", "/v/linear")
    joints = JointState()
    joints.position, joints.position_length = [1.0, 2.0], 2
    source.put("/joints", joints)
    source.put("/v", Twist())
    update = stream.update()
    assert update.data["curves"] == [
        *("/joints/position[0]", "/joints/position[1]"),
        *("/v/linear.x", "/v/linear.y", "/v/linear.z"),
    ]


def test_an_unknown_topic_is_named_with_the_near_one_and_waited_for():
    source = FakeSource()
    source.know(velocity=Float64)
    stream = Plot(source, fields=("/velocty/data",))
    (problem,) = _problems(stream.update())
    assert_says(problem, "no topic", "/velocty/data", "did you mean /velocity/data?")
    source.know(velocity=Float64, velocty=Float64)
    assert _problems(stream.update()) == [""]
    source.put("/velocty", _float(1.0))
    assert len(_samples(stream.update())) == 1


@pytest.mark.parametrize(
    ("field", "message", "problem"),
    [
        ("/a/dat", _float(1.0), "dat: std_msgs/Float64 has no field 'dat' (fields: data)"),
        ("/a/data", String(), "data is a string, not a number; name a field of numbers"),
        ("/a", b"\0\1", "too short for an LCM message"),
    ],
)
def test_what_is_no_number_is_a_problem_of_its_field(field, message, problem):
    source = FakeSource()
    source.know(a=None)
    stream = _open(source, field, "/a/data[")
    source.put("/a", message)
    told = _problems(stream.update())
    assert told[0].startswith(problem)
    assert_says(told[1], "'/data['", "'['", "']'")


def test_a_slow_page_loses_the_oldest_samples_and_is_told(monkeypatch):
    monkeypatch.setattr(plot, "_MOST_SAMPLES", 10)
    source = FakeSource()
    source.know(a=Float64)
    stream = _open(source, "/a/data")
    for value in range(13):
        source.put("/a", _float(value))
    update = stream.update()
    assert update is not None
    samples = _samples(update)
    assert update.data["leftOut"] == 13 - len(samples)
    assert samples[-1][1] == 12
    assert len(samples) <= 10


def test_a_closed_plot_follows_nothing():
    source = FakeSource()
    source.know(a=Float64)
    stream = _open(source, "/a/data")
    stream.close()
    assert source.followed == {"/a": []}


def test_curves_have_the_units_of_their_fields_or_of_those_around_them():
    source = FakeSource()
    source.know(v=Twist, odometry=Odometry)
    fields = ("/v/linear.x", "/v/angular.z", "/odometry/pose.pose.orientation.w")
    stream = _open(source, *fields, "/odometry/pose.covariance[1]", "/odometry/header.stamp")
    source.put("/v", Twist())
    source.put("/odometry", Odometry())
    update = stream.update()
    units = dict(zip(update.data["curves"], update.data["units"], strict=True))
    assert units == {
        "/v/linear.x": "m/s",
        "/v/angular.z": "rad/s",
        "/odometry/pose.pose.orientation.w": "",  # of no dimension
        "/odometry/pose.covariance[1]": "",  # of several
        "/odometry/header.stamp": "s",
    }
