"""The simulator's world for viewers, in standard messages, while a node subscribes.

``~world`` has the shapes of all bodies in their frames; it is sent to each new subscriber, when
bodies come or go, and every second, because LCM may lose it. ``~poses`` has the poses of the true
frames, thirty times a second by the wall clock. Programs that are not nodes get neither, because
their subscriptions are unknown.
"""

from collections.abc import Sequence

from lcmtools import Node
from lcmtools.clock import split_stamp
from lcmtools.node.timer import Timer
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import MarkerArray
from lcmtools_sim.geometry import Frame, from_euler
from lcmtools_sim.latched import LatchedPublisher
from lcmtools_sim.markers import WORLD, true_frame, wheel_frames, world_markers
from lcmtools_sim.robot import Robot
from lcmtools_sim.sensors.sensor import transform_message
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world import MovableObject

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
