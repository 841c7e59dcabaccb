"""A link of an SDF model: its shapes, mass, friction and looks.

Elements without a simple shape are counted by kind. The format is that of
http://sdformat.org/spec.
"""

import math
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass

from lcmtools_sim.geometry import ZERO, Frame, Pose, Vector, axes
from lcmtools_sim.scene import Ground
from lcmtools_sim.shapes import GREY, Color, Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.world_file.markup import Element

_FRICTION = 1.0  # the default of SDF
_MOST_FRICTION = 10.0
_SLAB = 0.02  # [m] thickness of a plane that is not the ground
_LEVEL = 0.9999
_NEAR = 1e-3
_SCRIPTS: dict[str, Color] = {
    "Black": (0.05, 0.05, 0.05),
    "Blue": (0.0, 0.0, 1.0),
    "BlueGlow": (0.0, 0.0, 1.0),
    "Bricks": (0.55, 0.35, 0.3),
    "CeilingTiled": (0.85, 0.85, 0.85),
    "DarkGrey": (0.18, 0.18, 0.18),
    "Green": (0.0, 1.0, 0.0),
    "Grey": (0.7, 0.7, 0.7),
    "Orange": (1.0, 0.51, 0.04),
    "Purple": (1.0, 0.0, 1.0),
    "Red": (1.0, 0.0, 0.0),
    "Turquoise": (0.0, 1.0, 1.0),
    "White": (1.0, 1.0, 1.0),
    "Wood": (0.6, 0.42, 0.25),
    "Yellow": (1.0, 1.0, 0.0),
}
"""Colours similar to Gazebo's own materials ("Gazebo/Red")."""


@dataclass(frozen=True, slots=True)
class SdfLink:
    """One link in the world."""

    name: str  # for messages
    frame: Frame  # at its centre of mass, with the axes of the link
    parts: tuple[Part, ...]  # its shapes, in the world
    mass: float  # [kg]
    friction: float  # of its first shape
    static: bool  # True for an immovable link
    ground: Ground | None = None  # the plane z = 0, if the link contains it


def read_link(
    element: Element, outer: Frame, name: str, left_out: Counter[str], *, static: bool
) -> SdfLink:
    """Read one link of a model at ``outer`` in the world."""
    frame = outer.place(read_pose(element, {"__model__"}))
    own = element.attributes.get("name", "")
    parts: list[Part] = []
    ground, friction = None, None
    for collision in element.all("collision"):
        place = frame.place(read_pose(collision, {own}))
        color = _color(element, collision)
        mu = collision.path("surface", "friction", "ode", "mu")
        rough = min(_MOST_FRICTION, mu.number(lowest=0.0)) if mu else _FRICTION
        is_level = axes(place.rotation)[2][2] > _LEVEL and abs(place.position[2]) < _NEAR
        if is_level and collision.path("geometry", "plane"):
            ground = Ground(rough, color)
            continue
        found = _parts(collision.needed("geometry"), color, left_out)
        parts += [part.placed(*place) for part in found]
        friction = rough if friction is None else friction
    if element.all("visual") and not element.all("collision"):
        left_out["visuals without collisions"] += len(element.all("visual"))
    mass, centre = _inertial(element)
    centred = Frame(frame.point(centre), frame.rotation)
    friction = _FRICTION if friction is None else friction
    return SdfLink(name, centred, tuple(parts), mass, friction, static, ground)


def read_pose(element: Element, parents: Collection[str]) -> Frame:
    """Read the frame of an element in its parent, which may have the names ``parents``."""
    pose = element.child("pose")
    if pose is None or not pose.text.strip():
        return Frame()
    relative_to = pose.attributes.get("relative_to") or pose.attributes.get("frame") or ""
    if relative_to and relative_to not in parents:
        what = f"the pose of {element} is relative to '{relative_to}'"
        raise pose.error(what, "only poses relative to the enclosing element are supported")
    x, y, z, *angles = pose.numbers("", (6, 7))
    if len(angles) == 4:  # noqa: PLR2004 - a quaternion
        size = math.hypot(*angles)
        if not size:
            raise pose.error("the rotation is all zeros", "0 0 0 1 for none")
        qx, qy, qz, qw = (value / size for value in angles)
        return Frame((x, y, z), (qx, qy, qz, qw))
    if pose.attributes.get("degrees") in ("true", "1"):
        angles = [math.radians(angle) for angle in angles]
    return Pose(x, y, z, *angles).frame


def _parts(geometry: Element, color: Color, left_out: Counter[str]) -> list[Part]:
    """Return the shapes of one geometry, in its own frame; none unless they are simple."""
    if found := geometry.child("box"):
        return [Part(Cuboid(found.needed("size").size()), color=color)]
    if found := geometry.child("sphere"):
        return [Part(Sphere(found.needed("radius").length()), color=color)]
    if found := geometry.child("cylinder") or geometry.child("capsule"):
        radius, long = found.needed("radius").length(), found.needed("length").length()
        parts = [Part(Cylinder(radius, long), color=color)]
        if found.tag == "capsule":
            ends = ((0.0, 0.0, long / 2), (0.0, 0.0, -long / 2))
            parts += [Part(Sphere(radius), end, color=color) for end in ends]
        return parts
    if found := geometry.child("plane"):
        size = found.child("size")
        x, y = size.numbers("", (2,), lowest=1e-4) if size else (1.0, 1.0)
        return [Part(Cuboid((x, y, _SLAB)), (0.0, 0.0, -_SLAB / 2), color=color)]
    left_out[geometry.children[0].tag if geometry.children else "empty geometry"] += 1
    return []


def _inertial(link: Element) -> tuple[float, Vector]:
    """Return the mass [kg], and the centre of mass in the link."""
    inertial = link.child("inertial")
    if inertial is None:
        return 1.0, ZERO
    mass = inertial.child("mass")
    weight = mass.number(lowest=1e-6) if mass else 1.0
    return weight, read_pose(inertial, {link.attributes.get("name", "")}).position


def _color(link: Element, collision: Element) -> Color:
    """Return the colour of the visual with the same shape, else of the link's first visual."""
    geometry = collision.child("geometry")
    visuals = link.all("visual")
    visuals.sort(key=lambda visual: not _same(visual.child("geometry"), geometry))
    return next((color for visual in visuals if (color := _material(visual))), GREY)


def _same(one: Element | None, other: Element | None) -> bool:
    if one is None or other is None:
        return False
    if (one.tag, one.text.split()) != (other.tag, other.text.split()):
        return False
    pairs = zip(one.children, other.children, strict=False)
    return len(one.children) == len(other.children) and all(_same(a, b) for a, b in pairs)


def _material(visual: Element) -> Color | None:
    for kind in ("diffuse", "ambient"):
        if found := visual.path("material", kind):
            return found.color()
    script = visual.path("material", "script", "name")
    return _SCRIPTS.get(script.text.strip().rpartition("/")[2]) if script else None
