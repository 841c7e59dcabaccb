"""The catalogue of the labs: name, world, programs, and the commands to type."""

from collections.abc import Mapping
from dataclasses import dataclass

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean


@dataclass(frozen=True, slots=True)
class LabProgram:
    """A program that students write in a lab."""

    option: str  # its option of lab check
    node: str  # the model answer and the skeleton, nodes of the same name
    # Names that connect it; added unless the command line has a := of its own.
    arguments: tuple[str, ...] = ()
    publishes: tuple[str, ...] = ()  # topics, one of which it must publish
    types: tuple[str, ...] = ()  # the message types that these may have
    subscribes: tuple[str, ...] = ()  # topics that it must subscribe to
    has_keys: bool = False  # it is driven by keys, and not by its callbacks
    may_end: bool = False  # it may end by itself when its work is done
    check_time: float = 8.0  # that the check of a right one usually takes [s]
    rate: float = 4.0  # simulated seconds per second of its check, where simulated time counts

    @property
    def answer(self) -> tuple[str, ...]:
        """The command line of the model answer."""
        return "lcmtools", "run", self.node


@dataclass(frozen=True, slots=True)
class Lab:
    """A lab."""

    name: str  # its name on the command line
    title: str  # its subject, in one line
    world: str  # the simulator's world
    simulator: str  # the simulator's node in that world
    robot: str  # the robot's namespace in that world
    programs: tuple[LabProgram, ...]  # the programs that a student writes
    steps: tuple[str, ...]  # commands to type next, in a second terminal


_HUSKY = Lab(
    "husky",
    "A Husky by wheel effort: topics, names, a speed controller",
    "husky",
    "/morse",
    "/husky0",
    (
        LabProgram(
            "controller",
            "simple_controller",
            ("__ns:=/husky0", "controlled_velocity:=velocity_cmd"),
            publishes=(
                "/husky0/velocity_cmd",
                "/husky0/wheel_cmd",
                "/husky0/wheel_velocity_cmd",
                "/husky0/cmd_vel",
            ),
            types=("sensor_msgs/JointState", "geometry_msgs/Twist"),
            subscribes=("/husky0/odometry", "/husky0/desired_velocity"),
        ),
        LabProgram(
            "evaluator",
            "evaluate_controller",
            ("__ns:=/husky0",),
            publishes=("/husky0/evaluation_stat",),
            types=("air_lab0/ControllerEvaluationStat",),
            subscribes=("/husky0/odometry", "/husky0/desired_velocity"),
        ),
    ),
    (
        "lcmtools list",
        "lcmtools echo /husky0/odometry",
        'lcmtools pub /husky0/wheel_cmd sensor_msgs/JointState "effort: [1, 1]"',
        "lcmtools lab skeleton simple_controller",
        "lcmtools lab check husky simple_controller.py",
    ),
)
_PIONEER = Lab(
    "pioneer",
    "A Pioneer with a Kinect: publishers, subscribers, a picture, driving by keys",
    "pioneer",
    "/gazebo",
    "/",
    (
        LabProgram(
            "teleop",
            "pioneer_manual_controller",
            publishes=("/RosAria/cmd_vel",),
            types=("geometry_msgs/Twist",),
            has_keys=True,
            check_time=14.0,
            rate=1.0,
        ),
        LabProgram(
            "viewer",
            "kinect_viewer",
            subscribes=("/camera/depth/image_raw",),
            may_end=True,
            rate=1.0,
        ),
        LabProgram(
            "path",
            "path_follower",
            publishes=("/RosAria/cmd_vel",),
            types=("geometry_msgs/Twist",),
            subscribes=("/path", "/ground_truth"),
            may_end=True,
            check_time=14.0,
        ),
    ),
    (
        "lcmtools node list",
        "lcmtools list",
        "lcmtools run image_view image:=/camera/depth/image_raw",
        "lcmtools run pioneer_manual_controller",
        "lcmtools lab skeleton pioneer_manual_controller",
        "lcmtools lab check pioneer pioneer_manual_controller.py",
    ),
)
_DOLLY = Lab(
    "dolly",
    "A Dolly in a circle: a node with a timer, and one that reads a laser",
    "dolly",
    "/gazebo",
    "/dolly",
    (
        LabProgram(
            "mover",
            "moving_robot",
            publishes=("/dolly/cmd_vel",),
            types=("geometry_msgs/Twist",),
            check_time=14.0,
        ),
        LabProgram("reader", "reading_laser", subscribes=("/dolly/laser_scan",)),
    ),
    (
        "lcmtools list",
        "lcmtools run reading_laser",
        "lcmtools run moving_robot",
        "lcmtools hz /dolly/cmd_vel",
        "lcmtools lab skeleton moving_robot",
        "lcmtools lab check dolly moving_robot.py",
    ),
)

LABS: Mapping[str, Lab] = {lab.name: lab for lab in (_HUSKY, _PIONEER, _DOLLY)}
"""By name, in the order they are listed."""


def find_lab(name: str) -> Lab:
    """Return the lab with a name, or raise UsageError."""
    if name not in LABS:
        hint = did_you_mean(name, LABS) or f"there are: {', '.join(LABS)}"
        raise UsageError(f"there is no lab '{name}'", hint)
    return LABS[name]
