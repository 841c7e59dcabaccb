"""Log the distances that the Dolly's laser measures: the subscriber beside moving_robot.

Subscribes:
    /dolly/laser_scan   sensor_msgs/LaserScan   the distances ahead, to both sides and the nearest
                                                are logged, twice a second

Example:
    lcmtools run sim --world dolly
    lcmtools run reading_laser
    lcmtools run reading_laser /dolly/laser_scan:=/husky0/lidar
"""

import math
from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.labs.nodes import check_command_line
from lcmtools.types.sensor_msgs import LaserScan

PERIOD = 0.5  # seconds between two lines; the laser is much faster than a person reads


class ReadingLaser(Node):
    """Logs what a laser scanner measures."""

    def __init__(self) -> None:
        super().__init__("reading_laser")
        self._next_time = 0
        self.create_subscription(LaserScan, "/dolly/laser_scan", self._read, 10)

    def _read(self, scan: LaserScan) -> None:
        now = self.get_clock().now()
        if now < self._next_time <= now + PERIOD * 1e9:  # or else time was set back
            return
        self._next_time = now + round(PERIOD * 1e9)
        self.get_logger().info(describe(scan))


def describe(scan: LaserScan) -> str:
    """Return a scan in one line: ahead, at both ends, and nearest; distances in metres."""
    beams = range(len(scan.ranges))
    if not beams or not math.isfinite(scan.angle_min + scan.angle_increment):
        return f"{len(beams)} ranges that cannot be read"
    ahead = min(beams, key=lambda beam: abs(_angle(scan, beam)))
    right, left = sorted((beams[0], beams[-1]), key=lambda beam: _angle(scan, beam))
    return (
        f"{len(beams)} ranges: right {_metres(scan, right)}, ahead {_metres(scan, ahead)},"
        f" left {_metres(scan, left)}, {_nearest(scan)}"
    )


def _nearest(scan: LaserScan) -> str:
    valid = [beam for beam in range(len(scan.ranges)) if _is_valid(scan, beam)]
    if not valid:
        return f"nothing from {scan.range_min:g} to {scan.range_max:g} m"
    beam = min(valid, key=scan.ranges.__getitem__)
    angle = math.degrees(_angle(scan, beam))
    side = "left" if angle > 0 else "right"
    return f"nearest {scan.ranges[beam]:.2f} m at {abs(angle):.0f} degrees {side}"


def _angle(scan: LaserScan, beam: int) -> float:
    """The direction of a beam [rad], positive to the left."""
    return scan.angle_min + beam * scan.angle_increment


def _metres(scan: LaserScan, beam: int) -> str:
    return f"{scan.ranges[beam]:.2f} m" if _is_valid(scan, beam) else "nothing"


def _is_valid(scan: LaserScan, beam: int) -> bool:
    """Return True if a range is within the limits, that is, measured (REP-117)."""
    return scan.range_min <= scan.ranges[beam] <= scan.range_max


def main(args: Sequence[str] | None = None) -> None:
    """Read until Ctrl-C."""
    if check_command_line(args, __doc__):
        lcmtools.init(args)
        lcmtools.spin(ReadingLaser())
        lcmtools.shutdown()
