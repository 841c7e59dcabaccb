"""The tree of coordinate frames, and the transform between any two of them.

Pure: transforms come in with the time of their arrival. The topics of a namespace, as
/husky0/tf and /husky0/tf_static, have frames of their own.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from lcmtools.bounded import BoundedDict
from lcmtools.clock import join_stamp
from lcmtools.errors import LcmtoolsError
from lcmtools.names import did_you_mean, namespace_of
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.wire.packet import Sender

_STATIC = "tf_static"  # the end of the name of a topic whose transforms do not change

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # x, y, z, w


class Transform(NamedTuple):
    """The pose of a frame in another one."""

    translation: Vector = (0.0, 0.0, 0.0)  # [m]
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def __matmul__(self, inner: "Transform") -> "Transform":
        """Return the pose of a frame whose pose in this frame is ``inner``."""
        x, y, z = _rotated(self.rotation, inner.translation)
        a, b, c = self.translation
        return Transform((a + x, b + y, c + z), _product(self.rotation, inner.rotation))

    def inverse(self) -> "Transform":
        """Return the pose of the other frame in this one."""
        x, y, z, w = self.rotation
        turn = -x, -y, -z, w
        a, b, c = _rotated(turn, self.translation)
        return Transform((-a, -b, -c), turn)

    @property
    def angles(self) -> Vector:
        """Roll, pitch and yaw [rad], about the fixed axes x, y and z (REP-103)."""
        x, y, z, w = self.rotation
        roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
        yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        return roll, pitch, yaw


@dataclass(slots=True)
class Link:
    """A frame in its parent, by the last message about it."""

    parent: str
    transform: Transform
    stamp: int  # in the message [ns since 1970]
    topic: str
    sender: Sender | None
    first_time: int  # of arrival [ns since 1970]
    last_time: int
    messages: int = 1
    others: dict[str, int] = field(default_factory=dict)  # other parents, by time of arrival

    @property
    def is_static(self) -> bool:
        """True if it is on a topic of transforms that do not change."""
        return self.topic.endswith(_STATIC)

    @property
    def rate(self) -> float | None:
        """Its messages per second, first to last; None before two messages."""
        span = self.last_time - self.first_time
        return (self.messages - 1) * 1e9 / span if span > 0 else None


class Place(NamedTuple):
    """The place of a frame in the tree."""

    frame: str
    depth: int
    link: Link | None  # None for a root
    is_looped: bool = False  # no root leads to it


class Frames:
    """The frames of one namespace's topics."""

    def __init__(self) -> None:
        self._links = BoundedDict[str, Link]()  # by child

    def add(self, one: TransformStamped, topic: str, time: int, sender: Sender | None) -> str:
        """Add a transform that arrived at a time [ns]; return why it is ignored, or ""."""
        parent, child = one.header.frame_id.lstrip("/"), one.child_frame_id.lstrip("/")
        found = _transform(one)
        if not (parent and child) or parent == child or found is None:
            reason = "has no length" if found is None else "is not between two frames"
            return f"a transform of '{child}' in '{parent}' on {topic} is ignored: it {reason}"
        stamp = join_stamp(one.header.stamp.sec, one.header.stamp.nsec)
        link = self._links.use(child)
        if link is None:
            self._links[child] = Link(parent, found, stamp, topic, sender, time, time)
            return ""
        if link.parent != parent:
            link.others[link.parent] = link.last_time
            link.others.pop(parent, None)
        link.parent, link.transform, link.stamp = parent, found, stamp
        link.topic, link.sender, link.last_time = topic, sender, time
        link.messages += 1
        return ""

    def has(self, frame: str) -> bool:
        """Return whether a frame is known."""
        return frame in self.names()

    def names(self) -> set[str]:
        """Return all frames."""
        return {*self._links, *(link.parent for link in self._links.values())}

    def between(self, source: str, target: str) -> tuple[Transform, int]:
        """Return the pose of a frame ``target`` in ``source``, and its time [ns since 1970].

        The time is that of the oldest of its transforms that change; 0 if none does.

        Raises:
            LcmtoolsError: A frame is not known, or nothing connects the two.
        """
        for frame in (source, target):
            if not self.has(frame):
                known = sorted(self.names())
                hint = did_you_mean(frame, known) or f"there are {', '.join(known) or 'none'}"
                raise LcmtoolsError(f"there is no frame {frame}", hint)
        (root, from_root, links), (other, there, more) = map(self._from_root, (source, target))
        if root != other:
            what = f"nothing connects {source}, below {root}, with {target}, below {other}"
            raise LcmtoolsError(what, "lcmtools tf tree shows the frames")
        stamps = [link.stamp for link in (*links, *more) if not link.is_static]
        return from_root.inverse() @ there, min(stamps, default=0)

    def places(self) -> Iterator[Place]:
        """Yield each frame below its parent; a loop begins with its first frame."""
        children: dict[str, list[str]] = {}
        for child in sorted(self._links, reverse=True):
            children.setdefault(self._links[child].parent, []).append(child)
        roots, seen = sorted(children.keys() - self._links.keys()), set[str]()
        for start in (*roots, *sorted(self._links)):
            waiting = [(start, 0)]
            while waiting:
                frame, depth = waiting.pop()
                if frame not in seen:
                    seen.add(frame)
                    yield Place(frame, depth, self._links.get(frame), start in self._links)
                    waiting += [(child, depth + 1) for child in children.get(frame, ())]

    def _from_root(self, frame: str) -> tuple[str, Transform, Sequence[Link]]:
        """Return the root above a frame, the frame's pose in it, and the links between them."""
        pose, links, seen = Transform(), list[Link](), {frame}
        while link := self._links.get(frame):
            pose, frame = link.transform @ pose, link.parent
            links.append(link)
            if frame in seen:
                raise LcmtoolsError(f"{frame} is below itself", "lcmtools tf tree shows the loop")
            seen.add(frame)
        return frame, pose, links


class Trees:
    """The frames of all namespaces."""

    def __init__(self) -> None:
        self._trees: dict[str, Frames] = {}

    def at(self, topic: str) -> Frames:
        """Return the frames that a topic's transforms belong to."""
        return self._trees.setdefault(namespace_of(topic), Frames())

    def all(self) -> Mapping[str, Frames]:
        """Return the frames by namespace."""
        return self._trees

    def between(self, source: str, target: str) -> tuple[Transform, int]:
        """Return a pose and its time, as ``Frames.between`` of the namespace that has both.

        Raises:
            LcmtoolsError: None has both frames, or several have.
        """
        found = [name for name, one in self._trees.items() if one.has(source) and one.has(target)]
        if len(found) > 1:
            what = f"{source} and {target} are in {' and in '.join(sorted(found))}"
            raise LcmtoolsError(what, "--ns NAME chooses one of them")
        if not found:
            whole = Frames()
            for one in self._trees.values():
                whole._links.update(one._links)  # noqa: SLF001 - for the error
            return whole.between(source, target)
        return self._trees[found[0]].between(source, target)


def _transform(one: TransformStamped) -> Transform | None:
    """Return a transform with a rotation of length 1; None if it is not finite or has none."""
    place, turn = one.transform.translation, one.transform.rotation
    numbers = turn.x, turn.y, turn.z, turn.w
    length = math.hypot(*numbers)
    if not length or not math.isfinite(length + place.x + place.y + place.z):
        return None
    x, y, z, w = (number / length for number in numbers)
    return Transform((place.x, place.y, place.z), (x, y, z, w))


def _product(one: Quaternion, other: Quaternion) -> Quaternion:
    (a, b, c, d), (x, y, z, w) = one, other
    return (
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    )


def _rotated(turn: Quaternion, vector: Vector) -> Vector:
    x, y, z, w = turn
    a, b, c, _ = _product(_product(turn, (*vector, 0.0)), (-x, -y, -z, w))
    return a, b, c
