"""The simulator's world for viewers, in standard messages, while a node subscribes.

``~world`` has the shapes of all bodies in their frames; it is sent to each new subscriber, when
bodies come or go, and every second, because LCM may lose it. ``~poses`` has the poses of the true
frames, thirty times a second by the wall clock. Programs that are not nodes get neither, because
their subscriptions are unknown.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Generic, TypeVar

from lcmtools import Node
from lcmtools.clock import split_stamp
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.node.timer import Timer
from lcmtools.types.geometry_msgs import Point
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker, MarkerArray
from lcmtools_sim.geometry import Frame, from_euler
from lcmtools_sim.robot import Robot
from lcmtools_sim.scene import MarkedPath, Scene
from lcmtools_sim.sensors.sensor import transform_message
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Part, Shape, Sphere
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world import MovableObject

_PERIOD = 0.1  # [s]; the longest delay for a new subscriber
_REPEAT = 10  # periods

MessageT = TypeVar("MessageT", bound=Message)


class LatchedPublisher(Generic[MessageT]):
    """Publishes a message to each new subscriber, and again from time to time.

    ``make`` creates the message when it is needed. ``is_repeated`` is called once a second and
    returns whether to publish it again.
    """

    def __init__(
        self,
        node: Node,
        message_type: type[MessageT],
        topic: str,
        make: Callable[[], MessageT],
        is_repeated: Callable[[], bool],
    ) -> None:
        self._publisher = node.create_publisher(message_type, topic)
        self._publisher.is_latched = True
        self._make, self._is_repeated = make, is_repeated
        self._payload = b""
        self._subscribers: frozenset[str] = frozenset()
        self._count = 0
        node.create_timer(_PERIOD, self._publish_if_due)

    @property
    def has_subscribers(self) -> bool:
        """True while a node subscribes."""
        return bool(self._subscribers)

    def renew(self) -> None:
        """Publish the message anew to all subscribers, because it has changed."""
        self._payload, self._subscribers = b"", frozenset()

    def _publish_if_due(self) -> None:
        self._count += 1
        subscribers = self._publisher.subscriber_ids()
        is_time = self._count % _REPEAT == 0 and self._is_repeated()
        if is_time or subscribers - self._subscribers:
            self._payload = self._payload or encode(self._make())
            self._publisher.publish_payload(self._payload)
        self._subscribers = subscribers


WORLD = "world"  # the frame of everything that does not move
_GROUND_SIZE = (200.0, 200.0, 0.1)
_LINE_HEIGHT = 0.002  # [m] of painted lines above the ground
_TYPES: dict[type[Shape], int] = {
    Cuboid: Marker.CUBE,
    Cylinder: Marker.CYLINDER,
    Sphere: Marker.SPHERE,
}


def true_frame(body: Robot | MovableObject, part: str = "") -> str:
    """Return the name of a body's true frame, or of one of its parts' frames.

    A robot's is its base_footprint; an object's is on the ground below its centre.
    """
    name = f"{body.namespace}/base_footprint" if isinstance(body, Robot) else body.name
    frame = f"ground_truth/{name.strip('/')}"
    return f"{frame}/{part}" if part else frame


def wheel_frames(robot: Robot) -> list[str]:
    """Return the names of the frames of a robot's wheels, in the order of ``Look.wheels``."""
    count = len(robot.model.body.look.wheels)
    return [true_frame(robot, f"wheel{number}") for number in range(count)]


def world_markers(
    scene: Scene | None, robots: Sequence[Robot], objects: Sequence[MovableObject]
) -> MarkerArray:
    """The markers of all bodies, replacing earlier ones; ``scene`` has the immovable ones."""
    clear = Marker()
    clear.header.frame_id, clear.action = WORLD, Marker.DELETEALL
    clear.pose.orientation.w = 1.0  # else wtf reports an invalid rotation
    message = MarkerArray()
    fixed = _fixed(scene) if scene else ()
    movable = (_marker(true_frame(one), one.name, part) for one in objects for part in one.parts)
    message.markers = [clear, *fixed, *movable, *_of_robots(robots)]
    for number, marker in enumerate(message.markers):
        marker.id = number
    return message


def _fixed(scene: Scene) -> Iterator[Marker]:
    ground = Part(Cuboid(_GROUND_SIZE), (0.0, 0.0, -_GROUND_SIZE[2] / 2), color=scene.ground.color)
    yield _marker(WORLD, "ground", ground)
    for thing in scene.objects:
        if not thing.mass:
            for part in thing.parts:
                yield _marker(WORLD, thing.name, part.placed(*thing.pose.frame))
    for path in scene.paths:
        yield _painted(path)


def _of_robots(robots: Iterable[Robot]) -> Iterator[Marker]:
    for robot in robots:
        body = robot.model.body
        for part in body.look.parts or body.parts:
            yield _marker(true_frame(robot), robot.namespace, part)
        for frame, wheel in zip(wheel_frames(robot), body.look.wheels, strict=True):
            for part in wheel.parts:
                yield _marker(frame, robot.namespace, part)


def _marker(frame: str, name: str, part: Part) -> Marker:
    marker = _empty(frame, name, part.color)
    marker.type = _TYPES[type(part.shape)]
    marker.scale.x, marker.scale.y, marker.scale.z = part.shape.size
    place, turn = marker.pose.position, marker.pose.orientation
    place.x, place.y, place.z = part.position
    turn.x, turn.y, turn.z, turn.w = part.rotation
    return marker


def _painted(path: MarkedPath) -> Marker:
    line = path.line
    marker = _empty(WORLD, path.topic, line.color)
    marker.type, marker.scale.x = Marker.LINE_STRIP, line.width
    marker.pose.position.z, marker.pose.orientation.w = _LINE_HEIGHT, 1.0
    for x, y in line.points:
        point = Point()
        point.x, point.y = x, y
        marker.points.append(point)
    return marker


def _empty(frame: str, name: str, color: Color) -> Marker:
    marker = Marker()
    marker.header.frame_id, marker.ns, marker.frame_locked = frame, name, True
    marker.color.r, marker.color.g, marker.color.b = color
    marker.color.a = 1.0
    return marker


_RATE = 30.0  # [Hz]
_LOOK_PERIOD = 0.1  # [s]; the longest delay for a new subscriber
_STILL = 30  # periods between two messages while nothing moves


class View:
    """Publishes a simulation's world; only its robots unless ``whole``."""

    def __init__(self, node: Node, simulation: Simulation, *, whole: bool) -> None:
        self._node, self._simulation, self._whole = node, simulation, whole
        self._world = LatchedPublisher(
            node, MarkerArray, "~world", self._markers, lambda: self._world.has_subscribers
        )
        self._publisher = node.create_publisher(TFMessage, "~poses")
        self._poses: Poses | None = None
        self._timer: Timer | None = None
        self._last: list[Frame] | None = None
        self._still = 0
        node.create_timer(_LOOK_PERIOD, self._follow_subscribers)

    def refresh(self) -> None:
        """Show the current bodies, because some have come or gone."""
        self._poses = self._last = None
        self._world.renew()

    def _markers(self) -> MarkerArray:
        scene = self._simulation.scene if self._whole else None
        return world_markers(scene, self._simulation.robots, self._objects())

    def _objects(self) -> Sequence[MovableObject]:
        return self._simulation.objects if self._whole else ()

    def _follow_subscribers(self) -> None:
        is_wanted = self._publisher.subscriber_count() > 0
        if is_wanted and not self._timer:
            self._timer = self._node.create_timer(1 / _RATE, self._publish)
        elif self._timer and not is_wanted:
            self._node.destroy_timer(self._timer)
            self._timer = None

    def _publish(self) -> None:
        if self._poses is None:
            self._poses = Poses(self._simulation.robots, self._objects())
        frames = self._poses.frames()
        self._still = self._still + 1 if frames == self._last else 0
        if self._still % _STILL == 0:
            self._publisher.publish(self._poses.message(self._simulation.time, frames))
        self._last = frames


class Poses:
    """The true poses of bodies, and of the frames of robots' odometry, as one message."""

    def __init__(self, robots: Sequence[Robot], objects: Sequence[MovableObject]) -> None:
        self._robots, self._objects = robots, objects
        frames = [(WORLD, true_frame(thing)) for thing in objects]
        for robot in robots:
            base = true_frame(robot)
            frames += [(WORLD, base), (WORLD, f"{robot.namespace}/odom".lstrip("/"))]
            frames += [(base, wheel) for wheel in wheel_frames(robot)]
        self._message = TFMessage()
        self._message.transforms = [transform_message(*names, Frame()) for names in frames]

    def frames(self) -> list[Frame]:
        """Return each frame in its parent."""
        found = [thing.frame for thing in self._objects]
        for robot in self._robots:
            found += [robot.frame, robot.odometry_frame]
            left, right = (from_euler(0.0, angle, 0.0) for angle in robot.wheel_angles)
            found += [
                Frame(wheel.centre, left if wheel.centre[1] > 0 else right)
                for wheel in robot.model.body.look.wheels
            ]
        return found

    def message(self, time: int, frames: Sequence[Frame]) -> TFMessage:
        """Return the message with these frames at a simulated time [ns]."""
        sec, nsec = split_stamp(time)
        for transform, frame in zip(self._message.transforms, frames, strict=True):
            transform.header.stamp.sec, transform.header.stamp.nsec = sec, nsec
            place, turn = transform.transform.translation, transform.transform.rotation
            (place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w) = frame
        return self._message
