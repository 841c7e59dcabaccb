"""Bullet's bodies, made from scene objects and robot models.

The engine comes in as an argument: only world.py imports it.
"""

from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

from lcmtools_sim.geometry import ORIGIN, ZERO, Pose, Vector, add, axes, scaled, subtract
from lcmtools_sim.robots.model import Body, Mesh
from lcmtools_sim.scene import Ground, SceneObject
from lcmtools_sim.shapes import (
    Color,
    Cuboid,
    Cylinder,
    Part,
    Shape,
    Sphere,
    centre_of_mass,
    inertials_of,
    moments,
)

_FEET_COLOR: Color = (0.2, 0.2, 0.2)
_NO_COLLISION = -1
_RIM = 0.002
"""[m] Length of the discs at a cylinder's ends."""
_RECESS = 0.0002
"""[m] By which the cylinder between them is thinner."""


class BodyFactory:
    """Makes bodies in one world of the engine; each method returns the new body's number."""

    def __init__(self, bullet: ModuleType, client: int) -> None:
        self._bullet = bullet
        self._client = client

    def ground(self, ground: Ground) -> int:
        """The plane z = 0."""
        shape = self._bullet.createCollisionShape(
            self._bullet.GEOM_PLANE, physicsClientId=self._client
        )
        body = self._body(0.0, shape, ORIGIN)
        self._set_surface(body, ground.friction, ground.color)
        return body

    def scene_object(self, thing: SceneObject) -> int:
        """An object as one rigid body, whose origin is its centre of mass."""
        parts = _with_rims(thing.parts) if thing.mass else thing.parts
        body = self._body(thing.mass, self._compound(parts), thing.pose)
        self._set_surface(body, thing.friction, thing.parts[0].color)
        if thing.mass:
            inertials = inertials_of(thing.parts, thing.mass)
            self._bullet.changeDynamics(
                body,
                -1,
                mass=thing.mass,  # without it the engine takes the mass away
                localInertiaDiagonal=moments(inertials, centre_of_mass(inertials)[1]),
                # A body that moves farther than its own size in a step would pass through a wall.
                ccdSweptSphereRadius=min(map(_least_radius, thing.parts)) / 2,
                physicsClientId=self._client,
            )
        return body

    def robot(self, body: Body, pose: Pose) -> int:
        """A robot's body, ``pose`` being that of its base_footprint.

        In a window it is invisible if the robot has meshes.
        """
        feet = [
            Part(Sphere(body.foot_radius), (x, y, body.foot_radius), color=_FEET_COLOR)
            for x, y in body.feet
        ]
        number = self._body(
            body.mass,
            self._compound([*body.parts, *feet]),
            pose,
            baseInertialFramePosition=(0.0, 0.0, body.centre_of_mass),
        )
        self._bullet.changeDynamics(
            number,
            -1,
            lateralFriction=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            mass=body.mass,  # as above
            localInertiaDiagonal=body.inertia,
            physicsClientId=self._client,
        )
        self._paint(number, body.parts[0].color, opacity=0.0 if body.meshes else 1.0)
        return number

    def mesh(self, mesh: Mesh) -> int:
        """A mesh in the window, as a body without mass and collision."""
        folder = import_module("pybullet_data").getDataPath()
        visual = self._bullet.createVisualShape(
            self._bullet.GEOM_MESH,
            fileName=f"{folder}/{mesh.file}",
            rgbaColor=(*mesh.color, 1.0),
            physicsClientId=self._client,
        )
        return self._body(0.0, _NO_COLLISION, ORIGIN, baseVisualShapeIndex=visual)

    def _body(self, mass: float, shape: int, pose: Pose, **more: object) -> int:
        """Make a body; ``more`` are createMultiBody's own names."""
        number = self._bullet.createMultiBody(
            mass,
            shape,
            basePosition=pose.position,
            baseOrientation=pose.rotation,
            useMaximalCoordinates=True,
            physicsClientId=self._client,
            **more,
        )
        return int(number)

    def _set_surface(self, body: int, friction: float, color: Color) -> None:
        self._bullet.changeDynamics(
            body, -1, lateralFriction=friction, physicsClientId=self._client
        )
        self._paint(body, color)

    def _paint(self, body: int, color: Color, opacity: float = 1.0) -> None:
        """Set a body's colour: the engine has one for each body."""
        self._bullet.changeVisualShape(
            body, -1, rgbaColor=(*color, opacity), physicsClientId=self._client
        )

    def _compound(self, parts: Sequence[Part]) -> int:
        """The collision shape of several parts, in one frame."""
        bullet, shapes = self._bullet, [part.shape for part in parts]
        kinds = {
            Cuboid: bullet.GEOM_BOX,
            Cylinder: bullet.GEOM_CYLINDER,
            Sphere: bullet.GEOM_SPHERE,
        }
        number = bullet.createCollisionShapeArray(
            shapeTypes=[kinds[type(shape)] for shape in shapes],
            halfExtents=[_half_extents(shape) for shape in shapes],
            radii=[0.0 if isinstance(shape, Cuboid) else shape.radius for shape in shapes],
            lengths=[shape.length if isinstance(shape, Cylinder) else 0.0 for shape in shapes],
            collisionFramePositions=[part.position for part in parts],
            collisionFrameOrientations=[part.rotation for part in parts],
            physicsClientId=self._client,
        )
        return int(number)


def _with_rims(parts: Sequence[Part]) -> list[Part]:
    """The parts with each cylinder as two discs and a thinner cylinder between them.

    Of a whole one that lies the engine finds one end at a time, and leaves the other's contact
    behind, which would drive it on.
    """
    found = []
    for part in parts:
        shape = part.shape
        if not isinstance(shape, Cylinder) or shape.length < 4 * _RIM:
            found.append(part)
            continue
        inner = Cylinder(shape.radius - _RECESS, shape.length - 2 * _RIM)
        out = scaled(axes(part.rotation)[2], (shape.length - _RIM) / 2)
        rim = Cylinder(shape.radius, _RIM)
        found += [
            Part(inner, part.position, part.rotation),
            Part(rim, add(part.position, out), part.rotation),
            Part(rim, subtract(part.position, out), part.rotation),
        ]
    return found


def _half_extents(shape: Shape) -> Vector:
    return scaled(shape.size, 0.5) if isinstance(shape, Cuboid) else ZERO


def _least_radius(part: Part) -> float:
    """Half of the least dimension of a shape [m]."""
    shape = part.shape
    if isinstance(shape, Cuboid):
        return min(shape.size) / 2
    return min(shape.radius, shape.length / 2) if isinstance(shape, Cylinder) else shape.radius
