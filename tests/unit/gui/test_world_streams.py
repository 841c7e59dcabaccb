"""The streams of the world: frames, markers, and the newest of other topics, as numbers."""

import math
import re
from array import array
from pathlib import Path as FilePath

import pytest
from fixtures.gui import FakeSource
from fixtures.says import assert_says

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.gui import drawings
from lcmtools.gui.drawings import DRAWINGS, MarkerScene, drawing_kinds
from lcmtools.gui.streams import STREAMS
from lcmtools.gui.streams.pool import OpenStream
from lcmtools.gui.streams.world import Drawable, Frames, Markers, Newest
from lcmtools.messages.message_template import draft
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.types.geometry_msgs import PoseStamped, TransformStamped
from lcmtools.types.nav_msgs import OccupancyGrid, Odometry, Path
from lcmtools.types.sensor_msgs import Image, LaserScan, PointCloud2, PointField
from lcmtools.types.std_msgs import String
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker, MarkerArray

HALF = math.sqrt(0.5)


def numbers(update):
    assert update.payload is not None
    return [round(one, 4) for one in array("f", bytes(update.payload))]


def transforms(*frames, sec=0):
    """Frames with their parent and x."""
    message = TFMessage()
    for parent, child, x in frames:
        one = TransformStamped()
        one.header.frame_id, one.child_frame_id, one.header.stamp.sec = parent, child, sec
        one.transform.translation.x, one.transform.rotation.w = x, 1.0
        message.transforms.append(one)
    return message


def marker(number, action=Marker.ADD, life=0):
    found = Marker()
    found.ns, found.id, found.action, found.type = "a", number, action, Marker.CUBE
    found.header.frame_id, found.lifetime.sec = "base", life
    found.scale.x, found.color.g, found.pose.orientation.w = 2.0, 1.0, 1.0
    return found


def ids(update):
    """The number of markers of an update."""
    shown = update.data["markers"]
    assert isinstance(shown, list)
    return len(shown)


def test_topics_that_can_be_drawn_and_simulators_are_listed():
    source = FakeSource()
    source.know(tf=TFMessage, scan=LaserScan, chatter=String, camera=Image, unknown=None)
    service = Endpoint("/morse/set_pose", Role.SERVICE, types=("sim_msgs/SetPose",))
    node = NodeInfo("/morse", "1", "here", 1, endpoints=(service,))
    source.latest = Snapshot(source.latest.rows, graph=Graph(nodes=(node,)))
    stream = Drawable(source)
    update = stream.update()
    topics = update.data["topics"]
    assert isinstance(topics, list)
    assert [(one["topic"], one["type"], one["kind"]) for one in topics] == [
        ("/scan", "sensor_msgs/LaserScan", "scan"),
        ("/tf", "tf2_msgs/TFMessage", "frames"),
    ]
    assert update.data["undrawn"] == ["sensor_msgs/Image", "std_msgs/String"]
    assert update.data["simulators"] == ["/morse"]


def test_the_page_has_code_for_each_kind_of_drawing_and_no_other():
    panels = FilePath(drawings.__file__).parent / "static" / "panels"
    source = (panels / "world" / "drawings.js").read_text()
    (table,) = re.findall(r"^export const KINDS = \{$(.*?)^\};$", source, re.MULTILINE | re.DOTALL)
    kinds = re.findall(r"^  (\w+): \{", table, re.MULTILINE)
    assert sorted(kinds) == sorted(set(drawing_kinds().values()))
    assert set(re.findall(r'stream: "(\w+)"', table)) <= STREAMS.keys()


def test_pages_get_what_they_share_once_until_it_changes(monkeypatch):
    monkeypatch.setattr(Drawable, "period", 0.0)
    source = FakeSource()
    source.know(tf=TFMessage)
    shown = OpenStream(Drawable(source))
    for _ in range(2):
        shown.refresh()
    assert shown.version == 1
    source.know(scan=LaserScan)
    shown.refresh()
    assert shown.version == 2


def test_frames_of_all_messages_are_kept_each_where_it_was_last():
    source = FakeSource()
    stream = Frames(source, topic="/tf")
    source.put("/tf", transforms(("odom", "a", 1), ("a", "laser", 3), sec=4), time=10.0)
    source.put("/tf", transforms(("odom", "b", 2)))
    source.put("/tf", transforms(("odom", "a", 5), sec=7), time=12.0)
    update = stream.update()
    assert update.data["frames"] == [["odom", "a"], ["a", "laser"], ["odom", "b"]]
    assert (update.data["time"], update.data["stamp"]) == (12.0, 7.0)
    assert numbers(update)[::7] == [5, 3, 2]
    assert stream.update() is None


@pytest.mark.parametrize(
    ("parent", "child", "x", "said"),
    [
        ("", "", 1.0, "empty name"),
        ("odom", "", 1.0, "empty name"),
        ("odom", "odom", 1.0, "own parent"),
        ("odom", "base", math.nan, "not finite"),
    ],
)
def test_a_frame_that_cannot_be_placed_is_told_and_the_others_stay(parent, child, x, said):
    source = FakeSource()
    stream = Frames(source, topic="/tf")
    source.put("/tf", transforms(("odom", "a", 1), (parent, child, x)), time=1.0)
    update = stream.update()
    assert update.data["frames"] == [["odom", "a"]]
    assert_says(stream.problem(), "/tf: the frame", said)
    source.put("/tf", transforms(("odom", "a", 2)), time=2.0)
    assert stream.update() is not None
    assert stream.problem() == ""


@pytest.mark.parametrize(
    ("sent", "now", "is_latched", "old"),
    [
        ({"a": [1, 2, 3], "b": [3, 9]}, 5.9, False, []),
        ({"a": [1, 2, 3], "b": [3, 9]}, 9.0, False, ["a"]),  # others are sent on the same topic
        ({"a": [1, 2, 3], "b": [3, 9]}, 9.0, True, []),
        ({"a": [1], "b": [9]}, 60.0, False, []),
        ({"a": [1, 11]}, 40.0, False, []),
        ({"a": [1, 11]}, 42.0, False, ["a"]),  # three times ten seconds
    ],
)
def test_a_frame_that_was_sent_repeatedly_is_old_when_it_no_longer_is(
    *, sent, now, is_latched, old
):
    source = FakeSource()
    stream = Frames(source, topic="/tf")
    end = Endpoint("/tf", Role.PUBLISHER, types=("tf2_msgs/TFMessage",), latched=is_latched)
    nodes = (NodeInfo("/n", "1", "here", 1, endpoints=(end,)),)
    for time, child in sorted((time, child) for child, times in sent.items() for time in times):
        source.put("/tf", transforms(("odom", child, 1)), time=time)
        stream.update()
    source.latest = Snapshot(graph=Graph(nodes=nodes, time=round(now * 1e9)))
    update = stream.update()
    assert (update.data["old"] if update else []) == old
    if old:
        assert_says(stream.problem(), "old: 1 of", "'a' for")
        source.put("/tf", transforms(("odom", "a", 1)), time=now)
        update = stream.update()
        assert update.data["old"] == []
        assert "old" not in stream.problem()


@pytest.mark.parametrize(("messages", "is_old"), [(2, False), (3, True)])
def test_a_frame_that_has_come_once_is_as_old_as_its_topic(*, messages, is_old):
    source = FakeSource()  # a page that is opened late has the last message only
    stream = Frames(source, topic="/tf")
    source.put("/tf", transforms(("odom", "a", 1)), time=1.0)
    stream.update()
    senders = ("/one", "/other")  # that have sent one each, or more
    row = ChannelRow("/tf", messages=messages, rate=0.0, age=16.0, senders=senders)
    source.latest = Snapshot((row,), graph=Graph(time=17_000_000_000))
    stream.update()
    assert stream.problem() == ("old: 1 of 1 frame, 'a' for 16 s" if is_old else "")


def two_points(**values):
    """A cloud with one field, that is as described but for some values."""
    cloud, field = PointCloud2(), PointField()
    field.name, field.offset, field.datatype, field.count = "x", 0, PointField.FLOAT64, 1
    cloud.fields, cloud.width, cloud.height, cloud.point_step = [field], 2, 1, 8
    for name, value in values.items():
        setattr(cloud, name, value)
    cloud.data = bytes(16)
    return cloud


def cells(width, height, resolution=0.05):
    grid = OccupancyGrid()
    grid.info.resolution = resolution
    grid.info.width, grid.info.height, grid.data = width, height, [0] * 6
    return grid


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (two_points(), ""),
        (two_points(point_step=4), "ends at byte 8 of a point, which has 4"),
        (two_points(point_step=0), "which has 0"),
        (two_points(height=2, row_step=8), "row_step is 8, but a row has 16 bytes"),
        (two_points(width=-2, height=-1), "its size is -2 x -1"),
        (two_points(width=3), "3 x 1 points need 24 bytes, but data has 16"),
        (cells(3, 2), ""),
        (cells(4, 2), "4 x 2 cells, but data has 6"),
        (cells(-3, -2), "its size is -3 x -2"),
        (cells(1_000_000_000, 1_000_000_000), "but data has 6"),
        (cells(3, 2, 0.0), "not drawn: its resolution is 0 m"),
        (cells(3, 2, math.nan), "not drawn: its resolution is nan m"),
        (draft(LaserScan, {"range_min": 2.0}).message, "range_min is 2 and range_max 0"),
        (draft(LaserScan, {"range_max": math.nan}).message, "range_min is 0 and range_max nan"),
    ],
)
def test_messages_that_contradict_themselves_are_told(message, said):
    source = FakeSource()
    stream = Newest(source, topic="/x")
    source.put("/x", message)
    assert (stream.update() is None) == bool(said)
    assert said in stream.problem()


@pytest.mark.parametrize(
    ("rate", "age", "messages", "silence"),
    [(10.0, 0.1, 9, None), (0.0, 16.2, 9, 16), (None, 1.2, 1, None), (0.0, 16.2, 1, None)],
)
def test_a_topic_that_was_sent_repeatedly_is_old_when_it_falls_silent(rate, age, messages, silence):
    source = FakeSource()
    row = ChannelRow("/scan", ("sensor_msgs/LaserScan",), messages=messages, rate=rate, age=age)
    source.latest = Snapshot((row,))
    update = Drawable(source).update()
    topics = update and update.data["topics"]
    assert topics[0]["silence"] == silence


def test_markers_come_and_go_and_end():
    scene = MarkerScene()
    message = MarkerArray()
    message.markers = [marker(1), marker(2, life=5), marker(3)]
    scene.add(message, 100.0)
    assert ids(scene.drawing(100.0)) == 3
    assert scene.drawing(101.0) is None
    scene.add(marker(1, Marker.DELETE), 101.0)
    assert ids(scene.drawing(101.0)) == 2
    assert ids(scene.drawing(105.5)) == 1
    scene.add(marker(0, Marker.DELETEALL), 106.0)
    assert ids(scene.drawing(106.0)) == 0


def test_markers_that_are_sent_again_as_they_are_change_nothing():
    source = FakeSource()
    stream = Markers(source, topic="/world")
    source.put("/world", marker(1))
    update = stream.update()
    source.put("/world", marker(1))
    assert update.data["markers"] == [
        {
            "ns": "a",
            "frame": "base",
            "type": Marker.CUBE,
            "pose": [0, 0, 0, 0, 0, 0, 1],
            "scale": [2, 0, 0],
            "color": [0, 1, 0, 0],
            "points": [],
            "colors": [],
            "text": "",
        }
    ]
    assert stream.update() is None


def test_of_other_topics_the_newest_message_is_sent():
    source = FakeSource()
    stream = Newest(source, topic="/scan")
    for first in (1.0, 2.0):
        scan = LaserScan()
        scan.header.frame_id, scan.angle_min, scan.range_max = "laser", -1.0, 9.0
        scan.ranges = [first, math.inf]
        source.put("/scan", scan, time=first)
    update = stream.update()
    assert numbers(update) == [2, math.inf]
    found = {name: update.data[name] for name in ("kind", "frame", "first", "longest", "time")}
    assert found == {"kind": "scan", "frame": "laser", "first": -1, "longest": 9, "time": 2}
    assert stream.update() is None


def test_a_topic_that_cannot_be_drawn_and_one_that_is_not_there_are_told():
    source = FakeSource()
    source.know(chatter=String)
    stream = Newest(source, topic="/chatter")
    source.put("/chatter", String())
    assert stream.update() is None
    assert_says(stream.problem(), "/chatter: ", "cannot draw", "std_msgs/String")
    assert "did you mean /chatter?" in Newest(source, topic="/chater").problem()


def test_what_has_come_once_may_be_silent():
    source = FakeSource()
    stream = Newest(source, topic="/path")
    assert_says(stream.problem(), "no topic /path", "waiting")
    source.put("/path", Path())
    stream.update()
    assert stream.problem() == ""


def odometry():
    message = Odometry()
    message.header.frame_id, message.child_frame_id = "odom", "base"
    message.pose.pose.position.x, message.twist.twist.angular.z = 1.0, 0.5
    return message


def goal(**rotation):
    message = draft(PoseStamped, {"pose": {"orientation": rotation}}).message
    message.pose.position.y = 3.0
    return message


def path():
    message = Path()
    message.poses = [goal(), goal()]
    return message


@pytest.mark.parametrize(
    ("message", "about", "payload"),
    [
        (odometry(), {"child": "base", "twist": [0, 0, 0, 0, 0, 0.5]}, None),
        (goal(), {"frame": "", "pose": [0, 3, 0, 0, 0, 0, 1]}, None),
        (goal(z=5.0, w=-5.0), {"pose": [0, 3, 0, 0, 0, HALF, -HALF]}, None),
        (goal(x=1e-320), {"pose": [0, 3, 0, 1, 0, 0, 0]}, None),
        (goal(x=1.7e308, y=1.7e308), {"pose": [0, 3, 0, 1.7e308, 1.7e308, 0, 0]}, None),
        (path(), {"frame": ""}, [0, 3, 0, 0, 3, 0]),
    ],
    ids=["odometry", "pose", "long", "short", "infinite", "path"],
)
def test_poses_are_seven_numbers(message, about, payload):
    update = DRAWINGS[type(message)].convert(message)
    for name, value in about.items():
        assert update.data[name] == (pytest.approx(value) if name == "pose" else value)
    assert (update.payload and numbers(update)) == payload


def test_a_cloud_is_sent_as_it_is_with_the_places_of_its_fields():
    cloud = PointCloud2()
    field = PointField()
    field.name, field.offset, field.datatype = "x", 4, PointField.FLOAT32
    cloud.fields, cloud.width, cloud.height, cloud.point_step = [field], 2, 1, 8
    cloud.data = bytes(range(16))
    update = DRAWINGS[PointCloud2].convert(cloud)
    assert update.data["fields"] == [["x", 4, PointField.FLOAT32]]
    assert update.payload == bytes(range(16))


def test_the_cells_of_a_map_are_bytes():
    grid = OccupancyGrid()
    grid.info.width, grid.info.height, grid.info.resolution = 3, 1, 0.5
    grid.data = [-1, 0, 100]
    update = DRAWINGS[OccupancyGrid].convert(grid)
    assert update.payload == array("b", [-1, 0, 100]).tobytes()
    assert (update.data["width"], update.data["resolution"]) == (3, 0.5)
