"""Messages in the form that pages draw: plain values, and many numbers as bytes.

A type is drawn if it is in DRAWINGS, which also has the kind of its drawing: the page's code for
each kind is in static/panels/world/drawings.js.

Poses are lists of seven numbers: position [m] and quaternion (x, y, z, w). Pure: no source, and
times come in as arguments.
"""

import sys
from array import array
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from itertools import chain
from typing import NamedTuple, cast

from lcmtools.clock import NANOSECONDS
from lcmtools.errors import LcmtoolsError
from lcmtools.gui.frames import FrameStore, is_finite, pose_of
from lcmtools.gui.protocol import Json
from lcmtools.gui.streams.base import Update
from lcmtools.messages.registry import Message, type_name
from lcmtools.types.geometry_msgs import (
    Pose,
    PoseArray,
    PoseStamped,
    PoseWithCovarianceStamped,
)
from lcmtools.types.nav_msgs import OccupancyGrid, Odometry, Path
from lcmtools.types.sensor_msgs import LaserScan, PointCloud, PointCloud2
from lcmtools.types.std_msgs import ColorRGBA
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker, MarkerArray

_FIELD_BYTES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 8: 8}  # by PointField's datatype


class Malformed(LcmtoolsError):  # noqa: N818 - named for what happened, as in errors.py
    """A message that contradicts itself, so that it cannot be drawn."""


@cache
def drawing_kinds() -> Mapping[str, str]:
    """Return the kind of drawing of each type that can be drawn, by the type's name."""
    kinds = {message_type: drawing.kind for message_type, drawing in DRAWINGS.items()}
    kinds |= {TFMessage: "frames", Marker: "markers", MarkerArray: "markers"}
    return {type_name(message_type): kind for message_type, kind in kinds.items()}


class WorldDrawing(NamedTuple):
    """The drawing of a type of which only the newest message is drawn."""

    kind: str  # a key of KINDS in static/panels/world/drawings.js, shared by similar types
    convert: Callable[[Message], Update]  # returns what the page's drawing of this kind reads


def frames_drawing(store: FrameStore, old: Sequence[str]) -> Update:
    """Return all frames: pairs of names, which are old, and the poses as float32."""
    found = list(store.latest())
    names: list[Json] = [[parent, child] for child, parent, _ in found]
    numbers = (number for _, _, link in found for number in link.pose)
    about: dict[str, Json] = {"kind": "frames", "time": store.time / 1e9, "stamp": store.stamp}
    return Update({**about, "frames": names, "old": old}, floats(numbers))


class MarkerScene:
    """The markers of a topic, as messages have added and removed them."""

    def __init__(self) -> None:
        self._markers: dict[tuple[str, int], Json] = {}
        self._ends: dict[tuple[str, int], float] = {}
        self._has_changed = False

    def add(self, message: Message, now: float) -> None:
        """Add a Marker or a MarkerArray at a time [s]."""
        for marker in message.markers if isinstance(message, MarkerArray) else [message]:
            assert isinstance(marker, Marker), "a topic of markers has no others"
            self._add_marker(marker, now)
        self._has_changed = True

    def drawing(self, now: float) -> Update | None:
        """Return all markers at a time [s]; None if nothing has changed."""
        for key in [key for key, end in self._ends.items() if now >= end]:
            del self._markers[key], self._ends[key]
            self._has_changed = True
        if not self._has_changed:
            return None
        self._has_changed = False
        return Update({"kind": "markers", "markers": list(self._markers.values())})

    def _add_marker(self, marker: Marker, now: float) -> None:
        if marker.action == Marker.DELETEALL:
            self._markers.clear()
            self._ends.clear()
            return
        key = marker.ns, marker.id
        self._ends.pop(key, None)
        self._markers.pop(key, None)
        if marker.action == Marker.ADD:
            self._markers[key] = _marker(marker)
            if life := marker.lifetime.sec + marker.lifetime.nsec / NANOSECONDS:
                self._ends[key] = now + life


def floats(numbers: Iterable[float]) -> bytes:
    """Return numbers as float32, little-endian."""
    found = array("f", numbers)
    if sys.byteorder == "big":
        found.byteswap()
    return found.tobytes()


def _finite(frame: str, places: Iterable[Sequence[float]]) -> Update:
    """Return the numbers of finite places as float32, and how many places are not finite."""
    found = list(places)
    finite = list(filter(is_finite, found))
    about: dict[str, Json] = {"frame": frame, "odd": len(found) - len(finite)}
    return Update(about, floats(chain.from_iterable(finite)))


def _of(pose: Pose) -> list[float]:
    return pose_of(pose.position, pose.orientation)


def _marker(marker: Marker) -> Mapping[str, Json]:
    return {
        "ns": marker.ns,
        "frame": marker.header.frame_id,
        "type": marker.type,
        "pose": _of(marker.pose),
        "scale": [marker.scale.x, marker.scale.y, marker.scale.z],
        "color": _rgba(marker.color),
        "points": [number for at in marker.points for number in (at.x, at.y, at.z)],
        "colors": [number for color in marker.colors for number in _rgba(color)],
        "text": marker.text,
    }


def _rgba(color: ColorRGBA) -> list[float]:
    return [color.r, color.g, color.b, color.a]


def _scan(scan: LaserScan) -> Update:
    """Return the ranges as float32 [m]."""
    if not scan.range_min <= scan.range_max:
        raise Malformed(f"range_min is {scan.range_min:g} and range_max {scan.range_max:g}")
    about: dict[str, Json] = {
        "frame": scan.header.frame_id,
        "first": scan.angle_min,
        "step": scan.angle_increment,
        "shortest": scan.range_min,
        "longest": scan.range_max,
    }
    return Update(about, floats(scan.ranges))


def _cloud(cloud: PointCloud2) -> Update:
    """Return the points unchanged, with the offsets of their fields, for the page to read."""
    for field in cloud.fields:
        end = field.offset + _FIELD_BYTES.get(field.datatype, 1) * max(1, field.count)
        if field.offset < 0 or end > cloud.point_step:
            what = f"the field '{field.name}' ends at byte {end} of a point"
            raise Malformed(f"{what}, which has {cloud.point_step}")
    _check_size(cloud.width, cloud.height)
    row = cloud.width * cloud.point_step
    if cloud.height > 1 and cloud.row_step < row:
        raise Malformed(f"row_step is {cloud.row_step}, but a row has {row} bytes")
    needed = (cloud.height - 1) * cloud.row_step + row if cloud.width and cloud.height else 0
    if len(cloud.data) < needed:
        size = f"{cloud.width} x {cloud.height} points need {needed} bytes"
        raise Malformed(f"{size}, but data has {len(cloud.data)}")
    about: dict[str, Json] = {
        "frame": cloud.header.frame_id,
        "width": cloud.width,
        "height": cloud.height,
        "pointStep": cloud.point_step,
        "rowStep": cloud.row_step,
        "isBigEndian": cloud.is_bigendian,
        "fields": [[field.name, field.offset, field.datatype] for field in cloud.fields],
    }
    return Update(about, bytes(cloud.data))


def _check_size(width: int, height: int) -> None:
    if min(width, height) < 0:
        raise Malformed(f"its size is {width} x {height}")


def _plain_cloud(cloud: PointCloud) -> Update:
    """Return the points as float32 [m]."""
    return _finite(cloud.header.frame_id, ((at.x, at.y, at.z) for at in cloud.points))


def _odometry(odometry: Odometry) -> Update:
    linear, angular = odometry.twist.twist.linear, odometry.twist.twist.angular
    about: dict[str, Json] = {
        "frame": odometry.header.frame_id,
        "child": odometry.child_frame_id,
        "pose": _of(odometry.pose.pose),
        "twist": [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z],
    }
    return Update(about)


def _stamped(message: PoseStamped) -> Update:
    return Update({"frame": message.header.frame_id, "pose": _of(message.pose)})


def _uncertain(message: PoseWithCovarianceStamped) -> Update:
    about: dict[str, Json] = {"frame": message.header.frame_id, "pose": _of(message.pose.pose)}
    return Update({**about, "covariance": list(message.pose.covariance)})


def _many(message: PoseArray) -> Update:
    """Return the poses as float32."""
    return _finite(message.header.frame_id, map(_of, message.poses))


def _path(path: Path) -> Update:
    """Return the positions as float32 [m]."""
    places = (one.pose.position for one in path.poses)
    return _finite(path.header.frame_id, ((at.x, at.y, at.z) for at in places))


def _grid(grid: OccupancyGrid) -> Update:
    """Return the cells as int8: -1 for unknown, 0 to 100 for the probability of occupancy [%]."""
    _check_size(grid.info.width, grid.info.height)
    if grid.info.width * grid.info.height != len(grid.data):
        size = f"{grid.info.width} x {grid.info.height} cells"
        raise Malformed(f"it should have {size}, but data has {len(grid.data)}")
    if not grid.info.resolution > 0:
        raise Malformed(f"its resolution is {grid.info.resolution:g} m")
    about: dict[str, Json] = {
        "frame": grid.header.frame_id,
        "resolution": grid.info.resolution,
        "width": grid.info.width,
        "height": grid.info.height,
        "origin": _of(grid.info.origin),
    }
    return Update(about, array("b", grid.data).tobytes())


_DRAWINGS = {
    LaserScan: ("scan", _scan),
    PointCloud2: ("cloud", _cloud),
    PointCloud: ("points", _plain_cloud),
    Odometry: ("odometry", _odometry),
    PoseStamped: ("pose", _stamped),
    PoseWithCovarianceStamped: ("pose", _uncertain),
    PoseArray: ("poses", _many),
    Path: ("path", _path),
    OccupancyGrid: ("grid", _grid),
}
DRAWINGS = {
    cast("type[Message]", cls): WorldDrawing(kind, cast("Callable[[Message], Update]", convert))
    for cls, (kind, convert) in _DRAWINGS.items()
}
"""The types of which only the newest message is drawn."""
