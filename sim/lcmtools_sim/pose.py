"""Poses: where something stands in a frame, as worlds and robot models say it."""

from dataclasses import dataclass

from lcmtools_sim.rotation import Quaternion, Vector, from_euler


@dataclass(frozen=True, slots=True)
class Pose:
    """A place: metres, and fixed-axis roll, pitch, yaw in radians (REP-103)."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0

    @property
    def position(self) -> Vector:
        """The place alone [m]."""
        return self.x, self.y, self.z

    @property
    def rotation(self) -> Quaternion:
        """Roll, pitch and yaw as one rotation."""
        return from_euler(self.roll, self.pitch, self.yaw)


ORIGIN = Pose()
"""Where a frame itself is."""
