"""One robot of the running simulation: its body in the engine, its wheels and its command."""

import math

from lcmtools.clock import split_stamp
from lcmtools.errors import InvalidFile, UsageError
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.command import interpret
from lcmtools_sim.drive import STOPPED, Drivetrain, body_velocity
from lcmtools_sim.geometry import Pose, Vector, add, axes, components, cross, scaled, subtract
from lcmtools_sim.robots.model import Drive
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.sensors.motion import OdometrySettings
from lcmtools_sim.sensors.sensor import RobotState, Sides, random_numbers
from lcmtools_sim.tyres import gripping, skidding
from lcmtools_sim.world import World

_LIFTING_OFF = 0.2  # [m/s] along its own up axis: a robot on its wheels has none
START_OVERLAP = 0.02
"""[m] The largest penetration of another body at the start."""
_UPRIGHT = 0.5  # cosine of the tilt; further over, no wheel reaches the ground


class Robot:
    """A robot that is driven by the last command.

    Attributes:
        model: Its kind.
        namespace: Global.
        world: The engine's.
        body: Its body's number there.
    """

    def __init__(self, world: World, scene: Scene, placement: RobotPlacement) -> None:
        self.model = placement.model
        self.namespace = placement.namespace
        self.world = world
        self._dt = scene.dt
        self._timeout = math.inf if placement.cmd_timeout is None else placement.cmd_timeout
        self._train = _drivetrain(placement, scene)
        self.body = world.add_robot(
            self.namespace, self.model.body, placement.pose, self._train.angles
        )
        self._motion = self._before = world.motion(self.body)
        friction = self.model.drive.tyre_friction * scene.ground.friction
        self._fall = scene.gravity * scene.dt  # [m/s] in a step
        self._largest_impulse = friction * self.model.body.mass / 2 * self._fall
        self._tyres = skidding(self.model) if self.model.drive.skids else gripping(self.model)
        self._targets = STOPPED
        self._command_age = 0.0

    def check_start(self, where: str) -> None:
        """Refuse a start inside another body: the engine would throw the robot out.

        Raises:
            InvalidFile: With the other one's name; ``where`` is the robot's place in its file.
        """
        depth, other = self.world.overlap(self.body)
        if depth > START_OVERLAP:
            raise InvalidFile(
                f"{where}: the {self.model.name} {self.namespace} starts {depth:.2f} m inside"
                f" {other}",
                "change its pose",
            )

    def command(self, message: JointState | Twist) -> None:
        """Execute a command until the next one or the timeout.

        Raises:
            ValueMismatch: It is no command; the last one remains.
        """
        self._targets = interpret(message, self.model)
        self._command_age = 0.0

    def drive(self) -> None:
        """Turn the wheels and let them pull the body, before the engine's step."""
        if self._command_age >= self._timeout:
            self._targets = STOPPED
        self._command_age += self._dt
        self._train.step(self._targets)
        self.world.set_velocity(self.body, *self._pulled())

    def observe(self) -> None:
        """Read the body's motion, after the engine's step."""
        self._before, self._motion = self._motion, self.world.motion(self.body)

    def remove(self) -> None:
        """Remove its body from the world."""
        self.world.remove(self.body)

    def place(self, pose: Pose) -> None:
        """Put its base_footprint at a pose, at rest; the wheels stop, the encoders continue.

        Raises:
            UsageError: It would stand inside another body; it stays as it is.
        """
        centre = pose.frame.point((0.0, 0.0, self.model.body.centre_of_mass))
        depth, other = self.world.overlap_at(self.body, centre, pose.rotation)
        if depth > START_OVERLAP:
            raise UsageError(
                f"{self.namespace} would be {depth:.2f} m inside {other}", "choose another place"
            )
        self.world.place(self.body, centre, pose.rotation)
        self._targets = STOPPED
        self._train.stop()
        self._motion = self._before = self.world.motion(self.body)

    def state(self, time: int) -> RobotState:
        """The state that its sensors measure; ``time`` in simulated nanoseconds."""
        motion, before, body = self._motion, self._before, self.model.body
        drive, train = self.model.drive, self._train
        frame = axes(motion.rotation)
        base_link = scaled(frame[2], body.base_height - body.centre_of_mass)
        swing = cross(motion.angular_velocity, base_link)
        change = scaled(subtract(motion.velocity, before.velocity), 1 / self._dt)
        angular_acceleration = scaled(
            subtract(motion.angular_velocity, before.angular_velocity), 1 / self._dt
        )
        of_lever = add(
            cross(angular_acceleration, base_link), cross(motion.angular_velocity, swing)
        )
        velocity = components(add(motion.velocity, swing), frame)
        angular_velocity = components(motion.angular_velocity, frame)
        (left, right), (left_target, right_target) = train.speeds, self._targets
        return RobotState(
            time=time,
            stamp=split_stamp(time),
            position=add(motion.position, base_link),
            rotation=motion.rotation,
            velocity=self._in_mid_step(velocity, angular_velocity[2]),
            angular_velocity=angular_velocity,
            acceleration=components(add(change, of_lever), frame),
            angular_acceleration=components(angular_acceleration, frame),
            wheel_angles=Sides(*train.angles()),
            wheel_speeds=Sides(left / drive.wheel_radius, right / drive.wheel_radius),
            efforts=Sides(_effort(left_target, drive), _effort(right_target, drive)),
            odometry_pose=train.odometry_pose(),
            odometry_speed=body_velocity(train.speeds, drive.track),
        )

    def _in_mid_step(self, velocity: Vector, turn_rate: float) -> Vector:
        """A velocity in the body's axes in the middle of its last step, given in those at its end.

        The body moved along a chord, in the direction of its heading in the middle.
        """
        angle = turn_rate * self._dt / 2
        s, c = math.sin(angle), math.cos(angle)
        forward, left, up = velocity
        return forward * c - left * s, forward * s + left * c, up

    def _pulled(self) -> tuple[Vector, Vector]:
        """Velocity and angular velocity in the world after the tyres' pull.

        The pull acts along the heading in the middle of the step, so that the engine's straight
        steps are the chords of the robot's arc. It compensates the effect of gravity in this step,
        or the robot would creep down every slope; on a slope the wheels carry less.

        The rotations are written out, as this is called in every step; tests compare it with
        geometry's functions.
        """
        _, (x, y, z, w), velocity, angular_velocity = self._motion
        (vx, vy, vz), (wx, wy, wz) = velocity, angular_velocity
        s, c = self._train.mid_turn
        x, y, z, w = c * x + s * y, c * y - s * x, c * z + s * w, c * w - s * z
        x2, y2, z2 = x + x, y + y, z + z
        xx, yy, zz, xy, xz, yz = x * x2, y * y2, z * z2, x * y2, x * z2, y * z2
        wx2, wy2, wz2 = w * x2, w * y2, w * z2
        ux, uy, uz = xz + wy2, yz - wx2, 1 - xx - yy
        if uz < _UPRIGHT or abs(vx * ux + vy * uy + vz * uz) > _LIFTING_OFF:
            return velocity, angular_velocity
        fx, fy, fz = 1 - yy - zz, xy + wz2, xz - wy2
        lx, ly, lz = xy - wz2, 1 - xx - zz, yz + wx2
        falling = vz - self._fall
        forward, sideways, turn_rate = self._tyres(
            vx * fx + vy * fy + falling * fz,
            vx * lx + vy * ly + falling * lz,
            wx * ux + wy * uy + wz * uz,
            self._train.speeds,
            self._largest_impulse * uz,
        )
        return (
            (
                vx + forward * fx + sideways * lx,
                vy + forward * fy + sideways * ly,
                vz + forward * fz + sideways * lz,
            ),
            (wx + turn_rate * ux, wy + turn_rate * uy, wz + turn_rate * uz),
        )


def _drivetrain(placement: RobotPlacement, scene: Scene) -> Drivetrain:
    """A robot's; all its odometry sensors share the encoders."""
    settings = [mount.settings for mount in placement.model.sensors]
    noise = max((s.travel_noise for s in settings if isinstance(s, OdometrySettings)), default=0.0)
    random = random_numbers(scene.seed, f"{placement.namespace}/encoders").standard_normal
    return Drivetrain(placement.model.drive, scene.dt, noise, random)


def _effort(target: float, drive: Drive) -> float:
    """The report of a motor driver: the fraction of full power."""
    return max(-1.0, min(1.0, target / drive.full_speed))
