"""One robot of the running simulation: its body in the engine, its wheels and its command."""

import math

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.command import interpret
from lcmtools_sim.drive import (
    STOPPED,
    Encoders,
    Odometer,
    SideSpeeds,
    Wheels,
    body_velocity,
)
from lcmtools_sim.pose import Pose
from lcmtools_sim.robots.model import Drive, RobotModel
from lcmtools_sim.rotation import (
    Quaternion,
    Vector,
    add,
    axes,
    components,
    cross,
    scaled,
    subtract,
    turn,
)
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.sensors.odometry import OdometrySettings
from lcmtools_sim.sensors.sensor import Contact, RobotState, WheelState, generator
from lcmtools_sim.shapes import Color, Part
from lcmtools_sim.skid import skidding
from lcmtools_sim.tyres import gripping
from lcmtools_sim.world import Motion, World

_LIFTING_OFF = 0.2  # [m/s] along its own up axis: what stands on its wheels has none
START_OVERLAP = 0.02
"""[m] That a body may stand in another one at the start."""
_UPRIGHT = 0.5  # cosine of the tilt; further over, no wheel reaches the ground


class Robot:
    """Drives one body by the last command.

    Args:
        world: Where its body is put.
        scene: Step, gravity and ground.
        placement: Its model, namespace, start and timeout.
    """

    def __init__(self, world: World, scene: Scene, placement: RobotPlacement) -> None:
        self.model = placement.model
        self.namespace = placement.namespace
        self._world = world
        self._dt = scene.dt
        self._timeout = placement.cmd_timeout
        self._ground_color = scene.ground.color
        self._wheels = Wheels()
        self._body = world.add_robot(
            self.namespace, self.model.body, placement.pose, self._wheels.angles
        )
        self._motion = self._before = world.motion(self._body)
        friction = self.model.drive.tyre_friction * scene.ground.friction
        self._fall = scene.gravity * scene.dt  # [m/s] in a step
        self._largest_impulse = friction * self.model.body.mass / 2 * self._fall
        self._tyres = skidding(self.model) if self.model.drive.skids else gripping(self.model)
        self._half_turn_by_speed = scene.dt / 2 / self.model.drive.track  # [rad s/m]
        self._odometer = Odometer()
        noise = generator(scene.seed, f"{self.namespace}/encoders").standard_normal
        self._encoders = Encoders(_travel_noise(self.model), noise)
        self._targets = STOPPED
        self._command_age = 0.0

    def check_start(self, where: str) -> None:
        """Refuse a start inside something else: the engine would throw the robot out.

        Raises:
            InvalidFile: Naming the other one, and ``where`` the world file puts the robot.
        """
        depth, other = self._world.overlap(self._body)
        if depth > START_OVERLAP:
            raise InvalidFile(
                f"{where}: the {self.model.name} {self.namespace} starts {depth:.2f} m inside"
                f" {other}",
                "change its pose",
            )

    def command(self, message: JointState | Twist) -> None:
        """Obey a message until the next one comes or the timeout is over.

        Raises:
            ValueMismatch: It is no command; the last one stays.
        """
        self._targets = interpret(message, self.model)
        self._command_age = 0.0

    def drive(self) -> None:
        """Turn the wheels and let them pull the body, before the engine's step."""
        drive, dt = self.model.drive, self._dt
        self._wheels.turn(self._obeyed_targets(), drive, dt)
        counted = self._encoders.read(self._wheels.speeds, dt)
        self._odometer.advance(*body_velocity(counted, drive.track), dt)
        velocity, turning = self._pulled(self._motion)
        self._world.set_velocity(self._body, velocity, turning)

    def observe(self) -> None:
        """Look at the body, after the engine's step."""
        self._before, self._motion = self._motion, self._world.motion(self._body)

    def remove(self) -> None:
        """Take its body out of the world."""
        self._world.remove(self._body)

    def place(self, pose: Pose) -> None:
        """Put its base_footprint elsewhere, at rest; the wheels stop, the encoders go on.

        Raises:
            UsageError: It would stand inside something else; it stays as it is.
        """
        height = scaled(turn((0.0, 0.0, 1.0), pose.rotation), self.model.body.centre_of_mass)
        centre = add(pose.position, height)
        depth, other = self._world.overlap_at(self._body, centre, pose.rotation)
        if depth > START_OVERLAP:
            raise UsageError(
                f"{self.namespace} would stand {depth:.2f} m inside {other}", "choose another place"
            )
        self._world.place(self._body, centre, pose.rotation)
        self._wheels.speeds = self._targets = STOPPED
        self._motion = self._before = self._world.motion(self._body)

    def fixed_parts(self) -> tuple[Part, ...]:
        """The shapes that stand for ever; see Surroundings, which a robot is for its sensors."""
        return self._world.fixed_parts()

    def moving_parts(self) -> list[Part]:
        """The shapes that can move, in the world now, but for its own."""
        return self._world.moving_parts(but=self._body)

    def moving_bodies(self) -> list[tuple[tuple[Part, ...], Vector, Quaternion]]:
        """The bodies that can move, but its own."""
        return self._world.moving_bodies(but=self._body)

    def ground_color(self) -> Color:
        """How the plane z = 0 looks."""
        return self._ground_color

    def touching(self) -> list[Contact]:
        """Where it touches something that is not the ground."""
        return self._world.contacts(self._body)

    def state(self, time: int) -> RobotState:
        """What its sensors may measure; ``time`` in simulated nanoseconds."""
        motion, body = self._motion, self.model.body
        frame = axes(motion.rotation)
        base_link = scaled(frame[2], body.base_height - body.centre_of_mass)
        velocity = add(motion.velocity, cross(motion.turning, base_link))
        return RobotState(
            time=time,
            position=add(motion.position, base_link),
            rotation=motion.rotation,
            velocity=components(velocity, frame),
            turning=components(motion.turning, frame),
            acceleration=components(self._change_of_velocity(base_link), frame),
            turning_change=components(self._change_of_turning(), frame),
            wheels=_wheel_states(self._wheels, self._targets, self.model.drive),
            reckoned_pose=(self._odometer.x, self._odometer.y, self._odometer.yaw),
            reckoned_speed=body_velocity(self._wheels.speeds, self.model.drive.track),
        )

    def _change_of_velocity(self, lever: Vector) -> Vector:
        """The acceleration of a point, ``lever`` from the centre of mass, in the last step."""
        motion, before = self._motion, self._before
        centre = scaled(subtract(motion.velocity, before.velocity), 1 / self._dt)
        spin = cross(motion.turning, cross(motion.turning, lever))
        return add(add(centre, cross(self._change_of_turning(), lever)), spin)

    def _change_of_turning(self) -> Vector:
        """The angular acceleration in the last step, in the world."""
        return scaled(subtract(self._motion.turning, self._before.turning), 1 / self._dt)

    def _obeyed_targets(self) -> SideSpeeds:
        """The last command's, until it is too old."""
        if self._timeout is not None:
            if self._command_age >= self._timeout:
                self._targets = STOPPED
            self._command_age += self._dt
        return self._targets

    def _pulled(self, motion: Motion) -> tuple[Vector, Vector]:
        """Velocity and angular velocity in the world after the tyres' pull.

        The pull acts along the heading in the middle of the step, so that the engine's straight
        steps are the chords of the arc that the robot drives. It makes good what gravity is going
        to do in this step, or the robot would creep down every slope; on a slope the wheels carry
        less.
        """
        _, rotation, velocity, turning = motion
        (fx, fy, fz), (lx, ly, lz), (ux, uy, uz) = axes(rotation)
        (vx, vy, vz), (wx, wy, wz) = velocity, turning
        if uz < _UPRIGHT or abs(vx * ux + vy * uy + vz * uz) > _LIFTING_OFF:
            return velocity, turning
        speeds, falling = self._wheels.speeds, vz - self._fall
        half_turn = (speeds.right - speeds.left) * self._half_turn_by_speed
        c, s = math.cos(half_turn), math.sin(half_turn)
        along = vx * fx + vy * fy + falling * fz
        aside = vx * lx + vy * ly + falling * lz
        forward, sideways, turn_rate = self._tyres(
            c * along + s * aside,
            c * aside - s * along,
            wx * ux + wy * uy + wz * uz,
            speeds,
            self._largest_impulse * uz,
        )
        along, aside = c * forward - s * sideways, s * forward + c * sideways
        vx, vy, vz = (
            vx + along * fx + aside * lx,
            vy + along * fy + aside * ly,
            vz + along * fz + aside * lz,
        )
        return (vx, vy, vz), (wx + turn_rate * ux, wy + turn_rate * uy, wz + turn_rate * uz)


def _travel_noise(model: RobotModel) -> float:
    """Of its encoders; they are the same for all that is told from them."""
    settings = [mount.settings for mount in model.sensors]
    return max((s.travel_noise for s in settings if isinstance(s, OdometrySettings)), default=0.0)


def _wheel_states(
    wheels: Wheels, targets: SideSpeeds, drive: Drive
) -> tuple[WheelState, WheelState]:
    """What encoders and motor drivers report of both sides."""
    left, right = (
        WheelState(
            angle, speed / drive.wheel_radius, max(-1.0, min(1.0, target / drive.full_speed))
        )
        for angle, speed, target in zip(
            (wheels.left_angle, wheels.right_angle), wheels.speeds, targets, strict=True
        )
    )
    return left, right
