"""The protocol of a physics engine: rigid bodies with shapes, their motion, and contacts.

Engines know shapes, masses and friction. The world (world.py) has names, robots and sensors.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from lcmtools_sim.geometry import ZERO, Quaternion, Vector
from lcmtools_sim.scene import Scene
from lcmtools_sim.shapes import Part


class Motion(NamedTuple):
    """The pose and velocity of a body in the world frame. A tuple: each step creates one."""

    position: Vector  # of the centre of mass [m]
    rotation: Quaternion  # of the body
    velocity: Vector = ZERO  # of the centre of mass [m/s]
    angular_velocity: Vector = ZERO  # [rad/s]


class ContactPoint(NamedTuple):
    """A point where a body touches another one, in the world frame."""

    other: int  # the other body's number
    position: Vector  # [m]
    normal: Vector  # towards the body
    force: float  # along the normal [N]
    depth: float  # penetration [m]; negative for a gap


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A body to add. The origin of its frame is its centre of mass."""

    parts: Sequence[Part]  # the body's shapes
    position: Vector  # in the world [m]
    rotation: Quaternion  # in the world
    mass: float = 0.0  # [kg]; 0 for an immovable body
    inertia: Vector = ZERO  # about the axes of its frame [kg m^2]
    friction: float = 0.0  # Coulomb coefficient; the product of two bodies' is effective
    is_robot: bool = False  # False for an object


class Engine(Protocol):
    """One world of an engine."""

    ground: int  # the number of the plane z = 0

    def begin(self, scene: Scene) -> None:
        """Empty the world, and set a scene's gravity, dt and ground."""

    def add(self, body: RigidBody) -> int:
        """Add a body and return its number, which no other body has had since ``begin``."""

    def remove(self, body: int) -> None:
        """Remove a body."""

    def disable(self, body: int) -> None:
        """Exclude a movable body from the simulation: it neither moves nor touches anything."""

    def enable(self, body: int) -> None:
        """Undo ``disable``; the caller then calls ``place`` and ``set_velocity``."""

    def step(self) -> None:
        """Simulate one dt."""

    def motion(self, body: int) -> Motion:
        """Return the current motion of a body."""

    def motions(self, bodies: Sequence[int]) -> Motion:
        """Return the current motions of movable bodies: each number is an array over them."""

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a movable body's centre of mass at a pose, at rest."""

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Set a movable body's velocity [m/s] and angular velocity [rad/s], in the world frame."""

    def set_velocities(
        self, bodies: Sequence[int], velocities: Vector, angular_velocities: Vector
    ) -> None:
        """Do the same for several bodies: each number is an array over them."""

    def detect_contacts(self) -> None:
        """Find the contacts at the current poses, without a step."""

    def contacts(self, body: int) -> list[ContactPoint]:
        """Return a body's contacts from the last step or ``detect_contacts``."""

    def warnings(self) -> list[str]:
        """Return the engine's warnings since the last call, only the first of each kind."""

    def close(self) -> None:
        """Free the world; may be called more than once."""
