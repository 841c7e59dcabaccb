"""Vectors, quaternions (x, y, z, w), poses and frames.

Plain functions of tuples: for single vectors these are faster than arrays. Frames are
right-handed, x forward, y left, z up (REP-103).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)
IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)
_STRAIGHT_UP = 1 - 1e-12


def from_euler(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation about the fixed axes x, y, z, in this order [rad]."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def to_euler(rotation: Quaternion) -> Vector:
    """Return roll, pitch and yaw about the fixed axes [rad]; the inverse of ``from_euler``."""
    x, y, z, w = rotation
    sine = max(-1.0, min(1.0, 2 * (w * y - z * x)))
    if abs(sine) > _STRAIGHT_UP:  # roll and yaw are then about the same axis: all counts as yaw
        return 0.0, math.asin(sine), math.copysign(2.0, -sine) * math.atan2(x, w)
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return roll, math.asin(sine), yaw_of(rotation)


def axes(rotation: Quaternion) -> tuple[Vector, Vector, Vector]:
    """The rotated axes forward, left and up: the columns of the rotation matrix."""
    x, y, z, w = rotation
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)),
    )


def upwards(rotation: Quaternion) -> Vector:
    """The outer frame's up axis in the rotated frame: the third row of the rotation matrix."""
    x, y, z, w = rotation
    return 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


def yaw_of(rotation: Quaternion) -> float:
    """The heading [rad]: the angle of the rotated x axis in the plane, counter-clockwise."""
    x, y, z, w = rotation
    return math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z))


def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def add(a: Vector, b: Vector) -> Vector:
    """The sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def subtract(a: Vector, b: Vector) -> Vector:
    """The difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scaled(vector: Vector, factor: float) -> Vector:
    """A vector times a factor."""
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def components(vector: Vector, frame: tuple[Vector, Vector, Vector]) -> Vector:
    """Return the components of a vector along these axes."""
    (x, y, z), ((a, b, c), (d, e, f), (g, h, i)) = vector, frame
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def rotate(vector: Vector, rotation: Quaternion) -> Vector:
    """Return a vector given in the rotated frame, in the outer frame."""
    forward, left, up = axes(rotation)
    return add(add(scaled(forward, vector[0]), scaled(left, vector[1])), scaled(up, vector[2]))


def multiply(outer: Quaternion, inner: Quaternion) -> Quaternion:
    """The product: the rotation ``inner`` within a frame that is rotated by ``outer``."""
    x1, y1, z1, w1 = outer
    x2, y2, z2, w2 = inner
    return (
        w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
        w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
        w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
    )


class Frame(NamedTuple):
    """The position [m] and rotation of a frame in an outer one."""

    position: Vector = ZERO
    rotation: Quaternion = IDENTITY

    def place(self, inner: "Frame") -> "Frame":
        """Return the frame ``inner``, which is given in this frame, in the outer one."""
        return Frame(self.point(inner.position), multiply(self.rotation, inner.rotation))

    def point(self, position: Vector) -> Vector:
        """Return a point given in this frame, in the outer one."""
        return add(self.position, rotate(position, self.rotation))

    def inverse(self) -> "Frame":
        """The outer frame in this one."""
        x, y, z, w = self.rotation
        back = (-x, -y, -z, w)
        return Frame(rotate(scaled(self.position, -1.0), back), back)

    def pose(self) -> "Pose":
        """The same as a pose."""
        return Pose(*self.position, *to_euler(self.rotation))


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose as in world files: metres, and fixed-axis roll, pitch, yaw in radians."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0

    @property
    def position(self) -> Vector:
        """The position only [m]."""
        return self.x, self.y, self.z

    @property
    def rotation(self) -> Quaternion:
        """The orientation as a quaternion."""
        return from_euler(self.roll, self.pitch, self.yaw)

    @property
    def frame(self) -> Frame:
        """The frame at this pose."""
        return Frame(self.position, self.rotation)


ORIGIN = Pose()
