"""Bullet, through pybullet, with its simple rigid bodies."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pybullet
from pybullet_utils.bullet_client import BulletClient

from lcmtools_sim.engines.engine import ContactPoint, Motion, RigidBody
from lcmtools_sim.engines.native import suppressed_output
from lcmtools_sim.geometry import IDENTITY, ZERO, Quaternion, Vector, add, axes, scaled, subtract
from lcmtools_sim.scene import Scene
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere

_RECOVERY = 12.0  # [1/s] at which overlapping bodies separate; more shakes a pushed body aside
_RIM = 0.002  # [m] length of the discs at a cylinder's ends
_RECESS = 0.0002  # [m] by which the cylinder between them is thinner than they are


class Bullet:
    """A Bullet world (see engine.Engine)."""

    def __init__(self) -> None:
        with suppressed_output():
            self._bullet: Any = BulletClient(pybullet.DIRECT)
        self._client: int = self._bullet._client  # noqa: SLF001 - for what each step calls, unbound

    def begin(self, scene: Scene) -> None:
        """Empty the world, and set a scene's gravity, dt and ground."""
        bullet = self._bullet
        with suppressed_output():
            bullet.resetSimulation()
        bullet.setGravity(0.0, 0.0, -scene.gravity)
        bullet.setTimeStep(scene.dt)
        bullet.setPhysicsEngineParameter(
            # By default, bodies that start on the ground fall into the engine's slop, and bounce.
            contactSlop=0.0,
            contactERP=_RECOVERY * scene.dt,
            # The engine's defaults are so coarse that crates at rest creep.
            solverResidualThreshold=1e-12,
            warmStartingFactor=1.0,
        )
        self._shapes: dict[tuple[Part, ...], int] = {}
        """The shapes so far, shared by equal bodies, because the engine cannot free any."""
        plane = bullet.createCollisionShape(bullet.GEOM_PLANE)
        self.ground = self._make(0.0, plane, ZERO, IDENTITY)
        bullet.changeDynamics(self.ground, -1, lateralFriction=scene.ground.friction)

    def add(self, body: RigidBody) -> int:
        """Add a body and return its number."""
        parts = tuple(body.parts if body.is_robot or not body.mass else _with_rims(body.parts))
        if parts not in self._shapes:
            self._shapes[parts] = self._compound(parts)
        number = self._make(body.mass, self._shapes[parts], body.position, body.rotation)
        self._bullet.changeDynamics(number, -1, lateralFriction=body.friction)
        if body.mass:
            self._bullet.changeDynamics(
                number,
                -1,
                mass=body.mass,  # without it the engine sets the mass to 0
                localInertiaDiagonal=body.inertia,
                linearDamping=0.0,
                angularDamping=0.0,
            )
        if body.mass and not body.is_robot:
            # A body that moves farther than its own size in a step would pass through a wall.
            radius = min(min(part.shape.size) for part in body.parts) / 4
            self._bullet.changeDynamics(number, -1, ccdSweptSphereRadius=radius)
        return number

    def remove(self, body: int) -> None:
        """Remove a robot."""
        self._bullet.removeBody(body)

    def disable(self, body: int) -> None:
        """Exclude a movable body from the simulation."""
        self._bullet.setCollisionFilterGroupMask(body, -1, 0, 0)
        asleep = self._bullet.ACTIVATION_STATE_SLEEP
        self._bullet.changeDynamics(body, -1, activationState=asleep)

    def enable(self, body: int) -> None:
        """Undo ``disable``."""
        self._bullet.setCollisionFilterGroupMask(body, -1, 1, -1)  # as by the engine's default
        awake = self._bullet.ACTIVATION_STATE_DISABLE_SLEEPING
        self._bullet.changeDynamics(body, -1, activationState=awake)

    def step(self) -> None:
        """Simulate one dt."""
        pybullet.stepSimulation(self._client)

    def motion(self, body: int) -> Motion:
        """Return the current motion of a body."""
        place = pybullet.getBasePositionAndOrientation(body, self._client)
        return Motion._make(place + pybullet.getBaseVelocity(body, self._client))

    def motions(self, bodies: Sequence[int]) -> Motion:
        """Return the current motions of bodies, as arrays."""
        vectors = zip(*map(self.motion, bodies), strict=True)
        return Motion(*(tuple(np.array(vector).T) for vector in vectors))

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a body's centre of mass at a pose, at rest."""
        self._bullet.resetBasePositionAndOrientation(body, position, rotation)
        self.set_velocity(body, ZERO, ZERO)

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Set a body's velocity [m/s] and angular velocity [rad/s], in the world frame."""
        pybullet.resetBaseVelocity(body, velocity, angular_velocity, self._client)

    def set_velocities(
        self, bodies: Sequence[int], velocities: Vector, angular_velocities: Vector
    ) -> None:
        """Do the same for several bodies, given as arrays."""
        rows = (np.array(vectors).T.tolist() for vectors in (velocities, angular_velocities))
        for body, velocity, turning in zip(bodies, *rows, strict=True):
            pybullet.resetBaseVelocity(body, velocity, turning, self._client)

    def detect_contacts(self) -> None:
        """Find the contacts at the current poses, without a step."""
        self._bullet.performCollisionDetection()

    def contacts(self, body: int) -> list[ContactPoint]:
        """Return a body's contacts from the last step or ``detect_contacts``."""
        return [
            ContactPoint(point[2], point[5], point[7], point[9], -point[8])
            for point in self._bullet.getContactPoints(body)
        ]

    def warnings(self) -> list[str]:
        """Return none: it has no warnings."""
        return []

    def close(self) -> None:
        """Disconnect from the engine."""
        with suppressed_output():
            if self._bullet.isConnected():
                self._bullet.disconnect()

    def _make(self, mass: float, shape: int, position: Vector, rotation: Quaternion) -> int:
        number = self._bullet.createMultiBody(
            mass, shape, basePosition=position, baseOrientation=rotation, useMaximalCoordinates=True
        )
        return int(number)

    def _compound(self, parts: Sequence[Part]) -> int:
        """Return the collision shape of several parts, in one frame."""
        bullet, shapes = self._bullet, [part.shape for part in parts]
        kinds = {
            Cuboid: bullet.GEOM_BOX,
            Cylinder: bullet.GEOM_CYLINDER,
            Sphere: bullet.GEOM_SPHERE,
        }
        number = bullet.createCollisionShapeArray(
            shapeTypes=[kinds[type(shape)] for shape in shapes],
            halfExtents=[scaled(s.size, 0.5) if isinstance(s, Cuboid) else ZERO for s in shapes],
            radii=[0.0 if isinstance(shape, Cuboid) else shape.radius for shape in shapes],
            lengths=[shape.length if isinstance(shape, Cylinder) else 0.0 for shape in shapes],
            collisionFramePositions=[part.position for part in parts],
            collisionFrameOrientations=[part.rotation for part in parts],
        )
        return int(number)


def _with_rims(parts: Sequence[Part]) -> list[Part]:
    """Return the parts, with each cylinder as two discs and a thinner cylinder between them.

    On a whole cylinder that lies down, the engine finds only one end at a time and leaves the
    other's contact behind, which would drive it on.
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
