"""Reading world files: strict YAML to the values of scene.py.

What is unknown, missing, twice there or out of bounds is an error with file, line and reason. The
text comes in as an argument (worlds/ finds the files); no engine and no bus are known here.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import PurePath
from typing import TypeVar

from lcmtools.errors import InvalidName
from lcmtools.names import check_base_name, did_you_mean, resolve_namespace
from lcmtools_sim.document import Item, load
from lcmtools_sim.pose import ORIGIN, Pose
from lcmtools_sim.robots import MODELS
from lcmtools_sim.scene import FRICTION, WOOD, Ground, RobotPlacement, Scene, Thing
from lcmtools_sim.shapes import GREY, Color, Cuboid, Part

Value = TypeVar("Value")

_WORLD_KEYS = ("node", "seed", "dt", "gravity", "ground", "objects", "robots")
_GROUND_KEYS = ("friction", "color")
_BOX_KEYS = ("type", "name", "size", "pose", "mass", "friction", "color")
_WALLS_KEYS = ("type", "name", "points", "closed", "height", "thickness", "friction", "color")
_ROBOT_KEYS = ("model", "namespace", "pose", "cmd_timeout")
_OBJECT_TYPES = ("box", "walls")


def read_scene(text: str, source: str) -> Scene:
    """Read a world file's text; ``source`` is its name, for messages.

    Raises:
        InvalidFile: Anything is wrong with it, with file, line and reason.
    """
    keys = load(text, source, "world").fields(_WORLD_KEYS)
    plain = Scene("")
    return Scene(
        name=PurePath(source).stem,
        node=_value(keys, "node", _node_name, plain.node),
        seed=_value(keys, "seed", lambda item: item.integer(0, 2**63 - 1), plain.seed),
        dt=_value(keys, "dt", lambda item: item.number(1e-4, 0.02), plain.dt),
        gravity=_value(keys, "gravity", lambda item: item.number(0, 100), plain.gravity),
        ground=_value(keys, "ground", _ground, plain.ground),
        things=_value(keys, "objects", _objects, ()),
        robots=_value(keys, "robots", _robots, ()),
    )


def _value(
    keys: dict[str, Item], name: str, read: Callable[[Item], Value], default: Value
) -> Value:
    """What a key says; ``default`` where it is not there."""
    return read(keys[name]) if name in keys else default


def _node_name(item: Item) -> str:
    try:
        check_base_name(item.text())
    except InvalidName as error:
        raise item.error(error.what, error.hint) from None
    return item.text()


def _ground(item: Item) -> Ground:
    keys = item.fields(_GROUND_KEYS)
    return Ground(
        friction=_value(keys, "friction", _friction, Ground().friction),
        color=_value(keys, "color", _color, Ground().color),
    )


def _objects(item: Item) -> tuple[Thing, ...]:
    return tuple(thing for element in item.items() for thing in _object(element))


def _object(item: Item) -> list[Thing]:
    """The boxes of one entry of ``objects``, by its ``type``."""
    keys = item.fields(tuple(dict.fromkeys(_BOX_KEYS + _WALLS_KEYS)), required=["type"])
    kind = keys["type"].text()
    if kind == "box":
        return [_box(item)]
    if kind == "walls":
        return _walls(item)
    hint = did_you_mean(kind, _OBJECT_TYPES) or f"known types: {', '.join(_OBJECT_TYPES)}"
    raise keys["type"].error(f"unknown type '{kind}'", hint)


def _box(item: Item) -> Thing:
    keys = item.fields(_BOX_KEYS, required=["size", "pose"])
    length, width, height = (side.number(1e-3, 1e4) for side in keys["size"].items(3))
    color = _value(keys, "color", _color, WOOD)
    return Thing(
        name=_value(keys, "name", Item.text, item.name),
        parts=(Part(Cuboid((length, width, height)), color=color),),
        pose=_pose(keys["pose"], height / 2),
        mass=_value(keys, "mass", lambda item: item.number(0, 1e5), 0.0),
        friction=_value(keys, "friction", _friction, FRICTION),
    )


def _walls(item: Item) -> list[Thing]:
    """A wall along a polyline, piece by piece."""
    keys = item.fields(_WALLS_KEYS, required=["points"])
    corners = keys["points"].items()
    if len(corners) < 2:  # noqa: PLR2004 - the ends of a wall
        raise keys["points"].error("'points' must have at least 2 elements")
    pairs = list(pairwise(corners))
    if _value(keys, "closed", Item.flag, default=False):
        pairs.append((corners[-1], corners[0]))
    name = _value(keys, "name", Item.text, item.name)
    height = _value(keys, "height", lambda item: item.number(1e-2, 1e3), 1.0)
    thickness = _value(keys, "thickness", lambda item: item.number(1e-2, 1e3), 0.2)
    friction = _value(keys, "friction", _friction, FRICTION)
    color = _value(keys, "color", _color, GREY)
    pieces = [_piece(start, end, height, thickness) for start, end in pairs]
    return [
        Thing(name, (Part(Cuboid(size), color=color),), pose, friction=friction)
        for size, pose in pieces
    ]


def _piece(
    start: Item, end: Item, height: float, thickness: float
) -> tuple[tuple[float, float, float], Pose]:
    """Size and pose of the wall between two points, half a thickness longer at both ends."""
    x0, y0 = (value.number() for value in start.items(2))
    x1, y1 = (value.number() for value in end.items(2))
    length = math.hypot(x1 - x0, y1 - y0)
    if length == 0:
        raise end.error(f"'{end.name}' is the same point as '{start.name}'")
    pose = Pose((x0 + x1) / 2, (y0 + y1) / 2, height / 2, yaw=math.atan2(y1 - y0, x1 - x0))
    return (length + thickness, thickness, height), pose


def _robots(item: Item) -> tuple[RobotPlacement, ...]:
    robots: list[RobotPlacement] = []
    for element in item.items():
        robot = _robot(element)
        if robot.namespace in [other.namespace for other in robots]:
            raise element.error(f"two robots have the namespace '{robot.namespace}'")
        robots.append(robot)
    return tuple(robots)


def _robot(item: Item) -> RobotPlacement:
    keys = item.fields(_ROBOT_KEYS, required=["model", "namespace"])
    model = keys["model"].text()
    if model not in MODELS:
        hint = did_you_mean(model, MODELS) or f"known models: {', '.join(MODELS)}"
        raise keys["model"].error(f"unknown model '{model}'", hint)
    return RobotPlacement(
        model=MODELS[model],
        namespace=_namespace(keys["namespace"]),
        pose=_value(keys, "pose", lambda pose: _pose(pose, 0.0), ORIGIN),
        cmd_timeout=_value(keys, "cmd_timeout", _timeout, None),
        where=f"{item.source}:{item.line}",
    )


def _namespace(item: Item) -> str:
    try:
        return resolve_namespace(item.text())
    except InvalidName as error:
        raise item.error(error.what, error.hint) from None


def _timeout(item: Item) -> float | None:
    return None if item.text() in ("none", "null", "~") else item.number(1e-3, 1e5)


def _pose(item: Item, standing: float) -> Pose:
    """A pose from [x, y, yaw], then at the height ``standing``, or from all six numbers."""
    values = item.items(3, 6)
    if len(values) == 3:  # noqa: PLR2004 - x, y, yaw
        x, y, yaw = values
        return Pose(x.number(), y.number(), standing, yaw=yaw.angle())
    lengths = [value.number() for value in values[:3]]
    return Pose(*lengths, *[value.angle() for value in values[3:]])


def _friction(item: Item) -> float:
    return item.number(0, 10)


def _color(item: Item) -> Color:
    red, green, blue = (part.number(0, 1) for part in item.items(3))
    return red, green, blue
