"""Drive the Pioneer by keys.

Publishes:
    /RosAria/cmd_vel   geometry_msgs/Twist   linear.x [m/s] and angular.z [rad/s]: at once for each
                                             key, at 10 Hz while it moves, 0 at the end

Parameters:
    speed   0.5   [m/s] at the start, at most 1.2
    turn    1.0   [rad/s] at the start, at most 5.2

Example:
    lcmtools run sim --world pioneer
    lcmtools run pioneer_manual_controller
    echo "i 2 u 3 k" | lcmtools run pioneer_manual_controller _speed:=0.3
"""

from collections.abc import Sequence

import lcmtools
from lcmtools.labs.nodes import check_command_line
from lcmtools.labs.nodes.driving.driver import TwistDriver, drive, keys_help
from lcmtools.labs.nodes.driving.motion import MOTION_HELP, Motion

SPEED_LIMIT = 1.2  # largest speed of a Pioneer 3-DX [m/s]
TURN_LIMIT = 5.2  # largest turn rate of a Pioneer 3-DX [rad/s]


class PioneerManualController(TwistDriver):
    """Publishes the velocity that the keys set."""

    key_help = MOTION_HELP

    def __init__(self) -> None:
        super().__init__("pioneer_manual_controller", "/RosAria/cmd_vel")
        speed = self.declare_parameter("speed", 0.5, "at the start [m/s]", minimum=0.0)
        turn = self.declare_parameter("turn", 1.0, "at the start [rad/s]", minimum=0.0)
        limits = Motion(speed_limit=SPEED_LIMIT, turn_limit=TURN_LIMIT)
        self.motion = limits.with_speeds(speed.value, turn.value)


def main(args: Sequence[str] | None = None) -> None:
    """Drive until Ctrl-C, or until a script of keys is over."""
    if check_command_line(args, keys_help(__doc__, MOTION_HELP)):
        lcmtools.init(args)
        drive(PioneerManualController())
        lcmtools.shutdown()
