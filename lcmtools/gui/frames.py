"""Coordinate frames as transforms tell of them: parents, poses, times, and who sends them.

Poses are as in ``drawings``. Pure: no source, and times come in as arguments [ns].
"""

import math
from collections.abc import Iterable, Iterator
from typing import TypeAlias

from lcmtools.clock import NANOSECONDS
from lcmtools.observe.channels.activity import SILENT_AFTER
from lcmtools.types.geometry_msgs import Point, Quaternion, TransformStamped, Vector3
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Sender

_LARGEST = 1e30  # a number beyond this is no place, and no float32
_SILENT_GAPS = 3  # times without a message are silence, if longer than SILENT_AFTER
_MOST = 5000  # frames
Pose: TypeAlias = list[float]


class Link:
    """A frame in a parent, with its latest pose, topic, sender and time."""

    def __init__(self, topic: str, sender: Sender | None, pose: Pose, time: int) -> None:
        self.topic, self.sender, self.pose, self.time = topic, sender, pose, time
        self._is_repeated, self._gap = False, 0

    def renew(self, topic: str, sender: Sender | None, pose: Pose, time: int) -> None:
        """Take the next message."""
        self._is_repeated, self._gap = True, time - self.time
        self.topic, self.sender, self.pose, self.time = topic, sender, pose, time

    def is_old(self, now: int, *, is_once: bool = False) -> bool:
        """Return whether it should have come again by a time; ``is_once`` if it came once."""
        if not self._is_repeated:
            return is_once
        return now - self.time > max(SILENT_AFTER, _SILENT_GAPS * self._gap)


class FrameStore:
    """The frames of some topics; a frame may be said to be in several parents."""

    def __init__(self) -> None:
        self.time, self.stamp = 0, 0.0  # of the latest message [ns], and its latest stamp [s]
        self.links: dict[str, dict[str, Link]] = {}  # by child and parent

    def add(
        self, message: TFMessage, time: int, topic: str = "", sender: Sender | None = None
    ) -> str:
        """Add the frames of a message; return which are ignored and why, else ""."""
        self.time, ignored = time, ""
        for one in message.transforms:
            child, parent = one.child_frame_id, one.header.frame_id
            place = pose_of(one.transform.translation, one.transform.rotation)
            if fault := _fault(one, place):
                ignored = fault
                continue
            self.stamp = one.header.stamp.sec + one.header.stamp.nsec / NANOSECONDS
            if link := self.links.get(child, {}).get(parent):
                link.renew(topic, sender, place, time)
            elif len(self.links) < _MOST:
                self.links.setdefault(child, {})[parent] = Link(topic, sender, place, time)
        return ignored

    def forget(self, names: Iterable[str]) -> None:
        """Remove frames."""
        for name in names:
            self.links.pop(name, None)

    def latest(self) -> Iterator[tuple[str, str, Link]]:
        """Yield each frame with its latest parent."""
        for child, parents in self.links.items():
            parent, link = max(parents.items(), key=lambda one: one[1].time)
            yield child, parent, link


def pose_of(place: Point | Vector3, turn: Quaternion) -> Pose:
    """Return a pose with a rotation of length 1; like rviz, read an all-zero one as none."""
    rotation = [turn.x, turn.y, turn.z, turn.w]
    length = math.hypot(*rotation)
    if length == 0:
        rotation[3] = 1.0
    elif length < math.inf:
        rotation = [number / length for number in rotation]
    return [place.x, place.y, place.z, *rotation]


def is_finite(numbers: Iterable[float]) -> bool:
    """Return whether numbers are a place, and fit into float32."""
    return all(abs(number) < _LARGEST for number in numbers)


def _fault(one: TransformStamped, pose: Pose) -> str:
    """Return which transform is ignored and why; "" if it is used."""
    parent, child = one.header.frame_id, one.child_frame_id
    reason = ""
    if not (parent and child):
        reason = "it has an empty name"
    elif parent == child:
        reason = "it is its own parent"
    elif not is_finite(pose):
        reason = "its place is not finite"
    return reason and f"the frame '{child}' in '{parent}' is ignored: {reason}"
