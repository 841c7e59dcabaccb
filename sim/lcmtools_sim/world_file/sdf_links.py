"""A link of an SDF model: its shapes, mass, friction and looks.

Elements without a simple shape are counted by kind. The format is that of
http://sdformat.org/spec.
"""

import math
from collections import Counter
from dataclasses import dataclass

from lcmtools_sim.geometry import ZERO, Frame, Quaternion, Vector, axes, multiply, scaled
from lcmtools_sim.scene import Ground
from lcmtools_sim.shapes import GREY, Color, Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.world_file.markup import Element
from lcmtools_sim.world_file.sdf_frames import Frames, read_pose, relative_to

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
    element: Element, frame: Frame, frames: Frames, left_out: Counter[str], *, static: bool
) -> SdfLink:
    """Read one link at ``frame`` in the world; ``frames`` are those of its model."""
    parts: list[Part] = []
    ground, friction = None, None
    for collision in element.all("collision"):
        place = frame.place(_inside(collision, element, frames))
        color = _color(element, collision)
        mu = collision.path("surface", "friction", "ode", "mu")
        rough = min(_MOST_FRICTION, mu.number(lowest=0.0)) if mu else _FRICTION
        plane = collision.path("geometry", "plane")
        if plane and abs(place.position[2]) < _NEAR and _is_level(place, plane):
            ground = Ground(rough, color)
            continue
        found = _parts(collision.needed("geometry"), color, left_out)
        parts += [part.placed(*place) for part in found]
        friction = rough if friction is None else friction
    if element.all("visual") and not element.all("collision"):
        left_out["visuals without collisions"] += len(element.all("visual"))
    mass, centre = _inertial(element, frames)
    centred = Frame(frame.point(centre), frame.rotation)
    friction = _FRICTION if friction is None else friction
    return SdfLink(element.attribute("name"), centred, tuple(parts), mass, friction, static, ground)


def _parts(geometry: Element, color: Color, left_out: Counter[str]) -> list[Part]:
    """Return the shapes of one geometry, in its own frame; none unless they are simple."""
    if found := geometry.child("box"):
        size = found.child("size")
        return [Part(Cuboid(size.size() if size else (1.0, 1.0, 1.0)), color=color)]
    if found := geometry.child("sphere"):
        return [Part(Sphere(_length(found, "radius")), color=color)]
    if found := geometry.child("cylinder") or geometry.child("capsule"):
        radius = _length(found, "radius", 0.5 if found.tag == "capsule" else 1.0)
        long = _length(found, "length")
        parts = [Part(Cylinder(radius, long), color=color)]
        if found.tag == "capsule":
            ends = ((0.0, 0.0, long / 2), (0.0, 0.0, -long / 2))
            parts += [Part(Sphere(radius), end, color=color) for end in ends]
        return parts
    if found := geometry.child("plane"):
        size = found.child("size")
        x, y = size.numbers("", (2,), lowest=1e-4) if size else (1.0, 1.0)
        slab = Part(Cuboid((x, y, _SLAB)), (0.0, 0.0, -_SLAB / 2), color=color)
        return [slab.placed(ZERO, _rotation_to(found))]
    left_out[geometry.children[0].tag if geometry.children else "empty geometry"] += 1
    return []


def _length(shape: Element, name: str, usual: float = 1.0) -> float:
    """Return a length of a shape [m]; ``usual`` is SDF's default."""
    found = shape.child(name)
    return found.length() if found else usual


def _rotation_to(plane: Element) -> Quaternion:
    """Return the shortest rotation of a plane that turns z to its normal."""
    element = plane.child("normal")
    normal = element.vector() if element else (0.0, 0.0, 1.0)
    size = math.hypot(*normal)
    if element and not size:
        raise element.error("the normal is all zeros", "0 0 1 for a level plane")
    x, y, z = scaled(normal, 1 / size)
    if z < -_LEVEL:
        return 1.0, 0.0, 0.0, 0.0
    length = math.hypot(x, y, 1 + z)
    return -y / length, x / length, 0.0, (1 + z) / length


def _is_level(place: Frame, plane: Element) -> bool:
    return axes(multiply(place.rotation, _rotation_to(plane)))[2][2] > _LEVEL


def _inside(element: Element, link: Element, frames: Frames) -> Frame:
    """Return the frame of a part of a link in the link."""
    own = link.attribute("name")
    if relative_to(element) in ("", own):
        return read_pose(element)
    return frames.of(own, link).inverse().place(frames.pose(element))


def _inertial(link: Element, frames: Frames) -> tuple[float, Vector]:
    """Return the mass [kg], and the centre of mass in the link."""
    inertial = link.child("inertial")
    if inertial is None:
        return 1.0, ZERO
    mass = inertial.child("mass")
    weight = mass.number(lowest=1e-6) if mass else 1.0
    return weight, _inside(inertial, link, frames).position


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
