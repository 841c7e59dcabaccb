"""Frames in frames: where something is that stands in something else."""

from dataclasses import dataclass

from lcmtools_sim.pose import Pose
from lcmtools_sim.rotation import (
    Quaternion,
    Vector,
    add,
    multiply,
    scaled,
    subtract,
    to_euler,
    turn,
)
from lcmtools_sim.shapes import UNTURNED, Part


@dataclass(frozen=True, slots=True)
class Frame:
    """Where a frame is in another one: metres, and a rotation."""

    position: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = UNTURNED

    def place(self, inner: "Frame") -> "Frame":
        """Where a frame is in the outer one, that stands in this one as ``inner`` says."""
        return Frame(self.point(inner.position), multiply(self.rotation, inner.rotation))

    def point(self, position: Vector) -> Vector:
        """Where a point of this frame is in the outer one."""
        return add(self.position, turn(position, self.rotation))

    def part(self, part: Part) -> Part:
        """A part of this frame in the outer one."""
        placed = self.place(Frame(part.position, part.rotation))
        return Part(part.shape, placed.position, placed.rotation, part.color)

    def inverse(self) -> "Frame":
        """Where the outer frame is in this one."""
        x, y, z, w = self.rotation
        back = (-x, -y, -z, w)
        return Frame(turn(scaled(self.position, -1.0), back), back)

    def moved(self, by: Vector) -> "Frame":
        """The frame, ``by`` nearer to the outer one's origin."""
        return Frame(subtract(self.position, by), self.rotation)

    def pose(self) -> Pose:
        """The same as scenes have it."""
        return Pose(*self.position, *to_euler(self.rotation))


def frame_of(pose: Pose) -> Frame:
    """The frame that stands at a pose."""
    return Frame(pose.position, pose.rotation)
