"""The world as visualization_msgs/MarkerArray: each shape in the frame of its body.

The frames of movable bodies are the true ones (``true_frame``), not those that robots estimate.
"""

from collections.abc import Iterable, Iterator, Sequence

from lcmtools.types.geometry_msgs import Point
from lcmtools.types.visualization_msgs import Marker, MarkerArray
from lcmtools_sim.robot import Robot
from lcmtools_sim.scene import MarkedPath, Scene
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Part, Shape, Sphere
from lcmtools_sim.world import MovableObject

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
