"""Steer a robot with two sliders, as rqt's robot steering does, in a terminal.

Publishes:
    TOPIC   geometry_msgs/Twist   linear.x [m/s] and angular.z [rad/s]: at once for each key, at
                                  10 Hz while it moves, 0 at the end; cmd_vel if none is given

Parameters:
    max_linear    1.0   [m/s]
    max_angular   3.0   [rad/s]

Example:
    lcmtools run steering /husky0/desired_velocity
    echo "up up 3 left 2 space" | lcmtools run steering /husky0/desired_velocity
"""

from collections.abc import Sequence

import lcmtools
from lcmtools.labs.nodes.argument_parser import NodeParser, read_command_line
from lcmtools.labs.nodes.driving.driver import TwistDriver, drive, keys_help
from lcmtools.labs.nodes.driving.motion import SLIDERS_HELP, Sliders


class Steering(TwistDriver):
    """Publishes the velocity that two sliders set."""

    key_help = SLIDERS_HELP

    def __init__(self, topic: str = "cmd_vel") -> None:
        super().__init__("steering", topic)
        self.motion = Sliders(
            most_forward=self._limit("max_linear", 1.0, "largest speed [m/s]"),
            most_turn_rate=self._limit("max_angular", 3.0, "largest turn rate [rad/s]"),
        )

    def _limit(self, name: str, default: float, about: str) -> float:
        return self.declare_parameter(name, default, about, minimum=0.01).value


def main(args: Sequence[str] | None = None) -> None:
    """Steer until Ctrl-C, or until a script of keys is over."""
    parser = NodeParser()
    parser.add_argument("topic", nargs="?", default="cmd_vel")
    options = read_command_line(args, keys_help(__doc__, SLIDERS_HELP), parser)
    if options:
        lcmtools.init(args)
        drive(Steering(options.topic))
        lcmtools.shutdown()
