"""One robot of the running simulation: its command, and its body, in the engine or not.

A command is a JointState or a Twist, and is interpreted as the speeds of the two sides, without its
sender and time. Wrong ones are refused with the reason.
"""

import math
from collections.abc import Iterable, Sequence

from lcmtools.errors import InvalidFile, ValueMismatch
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.drive import SideSpeeds, body_velocity, side_speeds
from lcmtools_sim.engines.engine import Motion
from lcmtools_sim.geometry import Frame, Pose, yaw_of
from lcmtools_sim.in_engine import RobotsInEngine, pulled
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import RobotState, random_numbers
from lcmtools_sim.vehicles import (
    Variables,
    Vehicles,
    constants_of,
    measured,
    planar_motion,
    planar_motions,
)
from lcmtools_sim.vision.solids import solids_of
from lcmtools_sim.world import START_OVERLAP, World

_ROUNDING = 1 + 1e-6  # a controller that limits its own commands may compute in float32


def interpret(message: JointState | Twist, model: RobotModel) -> tuple[SideSpeeds, str]:
    """Return the side speeds [m/s] for a command, within the robot's limits.

    A Twist gives the forward speed and turn rate; a JointState gives the efforts of the sides
    (fractions of full power) or, without efforts, their wheel speeds [rad/s]. For another message,
    ValueMismatch names the field. With them comes a text: the first value beyond the robot's
    limits, to which it is reduced; "" for none.
    """
    drive = model.drive
    if isinstance(message, Twist):
        forward = _finite("linear.x", message.linear.x)
        turn_rate = _finite("angular.z", message.angular.z)
        names = "linear.x", "angular.z"
    elif not isinstance(message, JointState):
        what = f"a {type(message).__name__} is not a command"
        raise ValueMismatch(what, "send a JointState or a Twist")
    elif message.effort:
        left, right = _by_side("effort", message.effort, message.name, model)
        efforts = [(f"effort[{i}]", value, 1.0, "") for i, value in enumerate(message.effort)]
        full = drive.full_speed
        kept = (max(-1.0, min(1.0, side)) * full for side in (left, right))
        return SideSpeeds(*kept), _reduced(efforts)
    elif message.velocity:
        left, right = _by_side("velocity", message.velocity, message.name, model)
        speeds = (left * drive.wheel_radius, right * drive.wheel_radius)
        forward, turn_rate = body_velocity(*speeds, drive.track)
        names = "the speed of the wheels", "the turn rate of the wheels"
    else:
        raise ValueMismatch("neither effort nor velocity is given", "for example effort: [1, 1]")
    limits = (forward, drive.max_speed, " m/s"), (turn_rate, drive.max_turn_rate, " rad/s")
    values = [(name, *about) for name, about in zip(names, limits, strict=True)]
    return side_speeds(forward, turn_rate, drive), _reduced(values)


def _reduced(values: Iterable[tuple[str, float, float, str]]) -> str:
    """Return the first of some values, with its limit and unit, that is beyond the limit."""
    for name, value, limit, unit in values:
        if abs(value) > limit * _ROUNDING:
            return f"{name} is {value:.4g}{unit}, the limit {limit:g}{unit}"
    return ""


def _by_side(
    field: str, values: Sequence[float], names: Sequence[str], model: RobotModel
) -> tuple[float, float]:
    """Return the values of the left and right side, averaged over the wheels of each side."""
    names = names or (model.left_wheels[0], model.right_wheels[0])
    if len(values) != len(names):
        wanted = f"{len(names)} ({', '.join(names)})"
        raise ValueMismatch(f"{field} has the wrong length: {len(values)} instead of {wanted}")
    if len(set(names)) != len(names):
        raise ValueMismatch(f"a name is given twice in {list(names)}")
    known = (*model.left_wheels, *model.right_wheels)
    for name in names:
        if name not in known:
            raise ValueMismatch(f"unknown wheel '{name}'", f"known names: {', '.join(known)}")
    by_name = {n: _finite(f"{field}[{i}]", values[i]) for i, n in enumerate(names)}
    return _mean(by_name, model.left_wheels), _mean(by_name, model.right_wheels)


def _mean(by_name: dict[str, float], wheels: Sequence[str]) -> float:
    values = [by_name[wheel] for wheel in wheels if wheel in by_name]
    if not values:
        raise ValueMismatch(f"no value for the side of '{wheels[0]}'", "give both sides")
    return sum(values) / len(values)


def _finite(field: str, value: float) -> float:
    if not math.isfinite(value):
        raise ValueMismatch(f"{field} is {value}, which is not a finite number")
    return value


Robots = Vehicles | RobotsInEngine  # several robots, whose states are arrays
Owner = Robots | World  # of a body
_LEVEL = 1e-3  # [rad, m, m/s, rad/s] largest deviation that counts as standing on level ground


class Robot:
    """A robot, which executes the last command.

    Where it may touch something, the engine moves its body. On level ground with nothing near, its
    ``vehicles`` do so, with the same motion: tyres pull the body, which has no friction.
    """

    def __init__(self, world: World, scene: Scene, placement: RobotPlacement) -> None:
        self.model, self.namespace = placement.model, placement.namespace
        self.world = world  # the engine's world
        self._owner: Owner = world  # what moves its body now
        self._number = 0  # in a group that owns it
        # An upper bound of the distance of any point from the centre of mass [m].
        self.reach = solids_of(self.model.body.parts).reach + self.model.body.centre_of_mass
        self._dt = scene.dt
        self._fall = scene.gravity * scene.dt  # [m/s] speed that a falling body gains in a step
        timeout = math.inf if placement.cmd_timeout is None else placement.cmd_timeout
        friction = scene.gravity * scene.ground.friction
        settings = (SENSORS[mount.kind].settings_of(mount) for mount in self.model.sensors)
        noise = max((one.encoder_noise for one in settings), default=0.0)
        random = random_numbers(scene.seed, f"{placement.namespace}/encoders").standard_normal
        constants = constants_of(self.model, scene.dt, timeout, friction)
        # The vehicles with its values, alone or with others.
        self.vehicles = Vehicles(self.model, constants, Variables(), scene.dt, noise, random)
        self.index = 0  # its index there
        self._constants, self._tyres = constants, self.vehicles.tyres
        # Its body's number in the world.
        self.body = world.add_robot(self.namespace, self.model.body, placement.pose)
        motion = world.motion(self.body)
        self._motions = motion, motion  # in the engine: the current one, and that of one step ago
        # The frame of its odometry in the world, exact when the robot was placed.
        self.odometry_frame = self._frame(self.model.body.base_height)

    def check_start(self, where: str) -> None:
        """Refuse a start inside another body: the engine would throw the robot out.

        The world's contacts must have been detected. InvalidFile names the other body; ``where`` is
        the robot's place in its file.
        """
        depth, other = self.world.overlap(self.body)
        if depth > START_OVERLAP:
            what = f"the {self.model.name} {self.namespace} starts {depth:.2f} m inside {other}"
            raise InvalidFile(f"{where}: {what}", "change its pose")

    def command(self, message: JointState | Twist) -> str:
        """Execute a command until the next or the timeout; ValueMismatch leaves the last one.

        Return the first value that was reduced to the robot's limits; "" for none.
        """
        (left, right), reduced = interpret(message, self.model)
        self.vehicles.set(self.index, left_target=left, right_target=right, command_age=0.0)
        return reduced

    def pull(self) -> None:
        """Let the wheels pull the body, before the engine's step."""
        left, right = self.vehicles.get(self.index, "left", "right")
        times = self._dt, self._fall
        pull = pulled(self._motions[0], (left, right), self._constants, self._tyres, times)
        self.world.set_velocity(self.body, *pull)

    def observe(self) -> None:
        """Read the body's motion, after the engine's step."""
        self._motions = self.world.motion(self.body), self._motions[0]

    def hand_to(self, owner: Owner, number: int = 0) -> None:
        """Let another owner move the body from now on, with its present motion.

        Its ``vehicles`` take it, standing on level ground, out of the engine; its ``world`` moves
        it there alone, and a group with others, of which it has a ``number``.
        """
        was_free, is_free = self.is_free, isinstance(owner, Vehicles)
        if was_free and is_free:
            return
        self._motions = motion, before = self.motions
        self._owner, self._number = owner, number
        if was_free:
            self.world.hold(self.body, motion)
        elif is_free:
            (x, y, _), (vx, vy, _) = motion.position, motion.velocity
            values = {"x": x, "y": y, "yaw": yaw_of(motion.rotation), "vx": vx, "vy": vy}
            values["turn_rate"] = motion.angular_velocity[2]
            values |= {"before_vx": before.velocity[0], "before_vy": before.velocity[1]}
            values["before_turn_rate"] = before.angular_velocity[2]
            self.vehicles.set(self.index, **values)
            self.world.release(self.body, lambda: self.motion)

    @property
    def is_free(self) -> bool:
        """True if the engine does not move the body."""
        return isinstance(self._owner, Vehicles)

    @property
    def motions(self) -> tuple[Motion, Motion]:
        """Return its body's motion, and that of one step ago."""
        if self.is_free:
            return planar_motions(*self.vehicles.row(self.index))
        if isinstance(self._owner, RobotsInEngine):
            return self._owner.row(self._number)
        return self._motions

    @property
    def batch(self) -> tuple[Robots, int] | None:
        """Return the robots whose state arrays include this robot's, and its index there."""
        if isinstance(self._owner, RobotsInEngine):
            return self._owner, self._number
        is_one = not self.is_free or self.vehicles.is_single
        return None if is_one else (self.vehicles, self.index)

    @property
    def motion(self) -> Motion:
        """The current motion of its body."""
        if not self.is_free:
            return self.motions[0]
        names = "x", "y", "yaw", "vx", "vy", "turn_rate"
        x, y, yaw, vx, vy, turn_rate = self.vehicles.get(self.index, *names)
        return planar_motion((x, y, self.model.body.centre_of_mass), yaw, (vx, vy, 0.0), turn_rate)

    @property
    def stands(self) -> bool:
        """True if the engine's body stands on level ground."""
        place, (qx, qy, _, _), velocity, (wx, wy, _) = self.motions[0]
        deviation = place[2] - self.model.body.centre_of_mass, qx, qy, velocity[2], wx, wy
        return max(map(abs, deviation)) < _LEVEL

    def remove(self) -> None:
        """Remove its body from the world."""
        self.world.remove(self.body)

    def place(self, pose: Pose) -> None:
        """Put its base_footprint at a pose, at rest; the wheels stop, the encoders continue.

        The engine must move it, and know where all bodies are; see also ``World.place``.
        """
        centre = pose.frame.point((0.0, 0.0, self.model.body.centre_of_mass))
        self.world.place(self.body, centre, pose.rotation)
        self.vehicles.set(self.index, left_target=0.0, right_target=0.0, left=0.0, right=0.0)
        motion = self.world.motion(self.body)
        self._motions, self._owner = (motion, motion), self.world
        x, y, yaw = self.vehicles.get(self.index, "odometry_x", "odometry_y", "odometry_yaw")
        base = self._frame(self.model.body.base_height)
        self.odometry_frame = base.place(Pose(x, y, yaw=yaw).frame.inverse())

    @property
    def frame(self) -> Frame:
        """Its base_footprint in the world."""
        return self._frame(0.0)

    @property
    def wheel_angles(self) -> tuple[float, float]:
        """The angles of the left and right wheels since the start [rad]."""
        left, right = self.vehicles.get(self.index, "left_angle", "right_angle")
        return left, right

    def state(self, time: int) -> RobotState:
        """Return the state that its sensors measure; ``time`` is simulated [ns]."""
        if self.is_free:
            return self.vehicles.state(time, self.index)
        return measured(*self.motions, self.vehicles.row(self.index), (time, self._dt))

    def _frame(self, height: float) -> Frame:
        """Return a frame at this height above its base_footprint [m], in the world."""
        position, rotation = self.motion[:2]
        below = height - self.model.body.centre_of_mass
        return Frame(Frame(position, rotation).point((0.0, 0.0, below)), rotation)
