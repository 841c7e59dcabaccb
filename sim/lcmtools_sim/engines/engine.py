"""The protocol of a physics engine: rigid bodies with shapes, their motion, and contacts.

Engines know shapes, masses and friction. Names of bodies, robots and sensors are the world's
(world.py).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from lcmtools_sim.geometry import ZERO, Quaternion, Vector
from lcmtools_sim.scene import Scene
from lcmtools_sim.shapes import Part


class Motion(NamedTuple):
    """The pose and velocity of a body in the world frame. A tuple, for it is made every step.

    Attributes:
        position: Of the centre of mass [m].
        rotation: Of the body.
        velocity: Of the centre of mass [m/s].
        angular_velocity: [rad/s]
    """

    position: Vector
    rotation: Quaternion
    velocity: Vector = ZERO
    angular_velocity: Vector = ZERO


class ContactPoint(NamedTuple):
    """A point where a body touches another one, in the world frame.

    Attributes:
        other: The other body's number.
        position: [m]
        normal: Towards the body.
        force: Along the normal [N].
        depth: Penetration [m]; negative for a gap.
    """

    other: int
    position: Vector
    normal: Vector
    force: float
    depth: float


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A body to add. The origin of its frame is its centre of mass.

    Attributes:
        parts: Its shapes.
        position: In the world [m].
        rotation: In the world.
        mass: [kg]; 0 for an immovable body.
        inertia: About the axes of its frame [kg m^2].
        friction: Coulomb coefficient; the product of two bodies' is effective.
        is_robot: False for an object.
    """

    parts: Sequence[Part]
    position: Vector
    rotation: Quaternion
    mass: float = 0.0
    inertia: Vector = ZERO
    friction: float = 0.0
    is_robot: bool = False


class Engine(Protocol):
    """One world of an engine."""

    ground: int
    """The number of the plane z = 0."""

    def begin(self, scene: Scene) -> None:
        """Empty the world, and take on a scene's gravity, dt and ground."""

    def add(self, body: RigidBody) -> int:
        """Add a body and return its number, which no other body has had since ``begin``."""

    def remove(self, body: int) -> None:
        """Remove a body."""

    def disable(self, body: int) -> None:
        """Leave a movable body out of what is simulated: it neither moves nor touches anything."""

    def enable(self, body: int) -> None:
        """Undo ``disable``; ``place`` and ``set_velocity`` follow."""

    def step(self) -> None:
        """Simulate one dt."""

    def motion(self, body: int) -> Motion:
        """The present motion of a body."""

    def motions(self, bodies: Sequence[int]) -> Motion:
        """The present motions of movable bodies: each number is an array of theirs."""

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a movable body's centre of mass at a pose, at rest."""

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Set a movable body's velocity [m/s] and angular velocity [rad/s], in the world frame."""

    def set_velocities(
        self, bodies: Sequence[int], velocities: Vector, angular_velocities: Vector
    ) -> None:
        """The same of several bodies: each number is an array of theirs."""

    def detect_contacts(self) -> None:
        """Find the contacts at the present poses, without a step."""

    def contacts(self, body: int) -> list[ContactPoint]:
        """The contacts of a body, of the last step or ``detect_contacts``."""

    def warnings(self) -> list[str]:
        """The engine's warnings since the last call; of each kind the first one only."""

    def close(self) -> None:
        """Give the world up; more than once too."""
