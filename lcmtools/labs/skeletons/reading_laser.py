"""Log the distances that the Dolly's laser measures (skeleton).

Run it with   python reading_laser.py   while the simulator runs: lcmtools run sim --world dolly
See the messages themselves with   lcmtools echo -n 1 /dolly/laser_scan
"""

from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.types.sensor_msgs import LaserScan


class ReadingLaser(Node):
    """Logs what a laser scanner measures."""

    def __init__(self) -> None:
        super().__init__("reading_laser")
        # TODO 1: subscribe to LaserScan on the topic /dolly/laser_scan, so that scan_callback is
        # called with each message: self.create_subscription(TYPE, TOPIC, FUNCTION, 10)

    def scan_callback(self, scan: LaserScan) -> None:
        """Read one scan."""
        # TODO 2: find the distance straight ahead. Beam i points at the angle
        # scan.angle_min + i * scan.angle_increment [rad], 0 is ahead, and scan.ranges[i] is its
        # distance [m]: math.inf where there is nothing.

        # TODO 3: find the nearest thing and the angle that it is at. Only what is between
        # scan.range_min and scan.range_max was measured.

        # TODO 4: log both with self.get_logger().info(TEXT). The laser measures many times a
        # second: throttle=0.5 as a second argument logs twice a second at most.
        del scan  # remove this line


def main(args: Sequence[str] | None = None) -> None:
    """Run the node until Ctrl-C."""
    lcmtools.init(args)
    lcmtools.spin(ReadingLaser())
    lcmtools.shutdown()


if __name__ == "__main__":
    main()
