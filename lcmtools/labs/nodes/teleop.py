"""Drive any robot by keys, as teleop_twist_keyboard does.

Publishes:
    cmd_vel   geometry_msgs/Twist, or TwistStamped with --stamped: linear.x [m/s] and angular.z
              [rad/s]; at once for each key, at 10 Hz while it moves, 0 at the end

Options:
    --hold      drive only while a key is held down
    --stamped   publish TwistStamped

Parameters:
    speed         0.5    [m/s] at the start
    turn          1.0    [rad/s] at the start
    speed_limit   1000   [m/s]
    turn_limit    1000   [rad/s]
    frame_id      ""     of the stamped messages

Example:
    lcmtools run teleop cmd_vel:=/husky0/cmd_vel _speed:=0.3 _speed_limit:=1.0
    lcmtools run teleop __ns:=/dolly --hold
    echo "i 2 k" | lcmtools run teleop cmd_vel:=/RosAria/cmd_vel
"""

from collections.abc import Sequence

import lcmtools
from lcmtools.clock import split_stamp
from lcmtools.labs.nodes.argument_parser import NodeParser, read_command_line
from lcmtools.labs.nodes.driving.driver import Driver, drive, keys_help
from lcmtools.labs.nodes.driving.motion import MOTION_HELP, HeldKey, Motion
from lcmtools.types.geometry_msgs import Twist, TwistStamped


class Teleop(Driver):
    """Publishes the velocity that the keys set, as TwistStamped if ``stamped``.

    With ``hold`` the robot stops when a key is let go.
    """

    key_help = MOTION_HELP

    def __init__(self, *, hold: bool = False, stamped: bool = False) -> None:
        super().__init__("teleop")
        self._stamped = self.create_publisher(TwistStamped, "cmd_vel", 1) if stamped else None
        self._plain = None if stamped else self.create_publisher(Twist, "cmd_vel", 1)
        self._frame = self.declare_parameter("frame_id", "", "of stamped messages").value
        limits = Motion(
            speed_limit=self._number("speed_limit", 1000.0, "largest speed [m/s]"),
            turn_limit=self._number("turn_limit", 1000.0, "largest turn rate [rad/s]"),
        )
        self.motion = limits.with_speeds(
            self._number("speed", 0.5, "at the start [m/s]"),
            self._number("turn", 1.0, "at the start [rad/s]"),
        )
        self._held = HeldKey() if hold else None
        if hold:
            self.create_timer(0.02, self._check_held)

    def press(self, key: str) -> None:
        """Drive, stop or change a speed, by the table in driving/motion.py."""
        super().press(key)
        if self._held:
            self._held.press(key, self.callbacks.time())

    def send(self, forward: float, turn_rate: float) -> None:
        """Publish one command; what is not set is 0."""
        stamped = TwistStamped()
        stamped.twist.linear.x = forward
        stamped.twist.angular.z = turn_rate
        if self._plain:
            self._plain.publish(stamped.twist)
        if self._stamped:
            stamped.header.frame_id = self._frame
            stamp = stamped.header.stamp
            stamp.sec, stamp.nsec = split_stamp(self.get_clock().now())
            self._stamped.publish(stamped)

    def _check_held(self) -> None:
        moves = self.motion.forward or self.motion.turn_rate
        if self._held and moves and self._held.is_over(self.callbacks.time()):
            self.motion = self.motion.stopped()
            self.command()

    def _number(self, name: str, default: float, about: str) -> float:
        return self.declare_parameter(name, default, about, minimum=0.0).value


def main(args: Sequence[str] | None = None) -> None:
    """Drive until Ctrl-C, or until a script of keys is over."""
    parser = NodeParser()
    parser.add_argument("--hold", action="store_true")
    parser.add_argument("--stamped", action="store_true")
    options = read_command_line(args, keys_help(__doc__, MOTION_HELP), parser)
    if options:
        lcmtools.init(args)
        drive(Teleop(hold=options.hold, stamped=options.stamped))
        lcmtools.shutdown()
