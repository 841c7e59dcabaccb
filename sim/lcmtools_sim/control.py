"""The simulator's services: pause, resume, step, reset, and those of single robots.

Each answers with ``success`` and, if that is false, the reason; none can end the simulator. They
run between two steps, on the simulating thread.
"""

import math
from collections.abc import Callable, Mapping
from typing import Protocol, TypeVar

import numpy as np

from lcmtools import Node
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.names import did_you_mean, resolve_namespace
from lcmtools.text_table import plural
from lcmtools.types import geometry_msgs, sim_msgs, std_srvs
from lcmtools_sim.geometry import (
    Frame,
    Pose,
    Quaternion,
    Vector,
    add,
    from_euler,
    rotate,
    to_euler,
    yaw_of,
)
from lcmtools_sim.loop import Loop
from lcmtools_sim.robot import Robot
from lcmtools_sim.robots import MODELS
from lcmtools_sim.scene import RobotPlacement
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.vision.camera import Camera, corners_of, optical
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.messages import png_file
from lcmtools_sim.vision.render import render
from lcmtools_sim.vision.solids import Floats, Solids
from lcmtools_sim.world import MovableObject

_FIELD_OF_VIEW = math.radians(60)
_DOWN: Quaternion = (1.0, 0.0, 0.0, 0.0)
"""The rotation of an optical frame that looks down, with the world's x to the right."""
_MARGIN = 1.15
_LEAST_EXTENT = 3.0  # [m]
_BEHIND: Vector = (-3.0, 0.0, 1.8)  # [m] the eye behind a robot, in a frame with its heading
_TILT = math.radians(22)


def snapshot(solids: Solids, width: int, height: int, robot: Frame | None = None) -> bytes:
    """Return a PNG file of the whole world from above (x right, y up), or from behind a robot.

    ``solids`` are all shapes and ``robot`` is the robot's base_link, in the world.
    """
    camera = Camera(width, height, _FIELD_OF_VIEW)
    if robot is None:
        eye, view = _above(corners_of(solids).reshape(-1, 3), camera), _DOWN
    else:
        heading = yaw_of(robot.rotation)
        eye = add(robot.position, rotate(_BEHIND, from_euler(0.0, 0.0, heading)))
        view = optical(from_euler(0.0, _TILT, heading))
    return png_file(color_image(render(solids, camera, eye, view)))


def _above(corners: Floats, camera: Camera) -> Vector:
    """The eye of a camera that looks down and sees all these points (n, 3), even high ones."""
    finite = corners[np.isfinite(corners).all(axis=1)]  # except bodies that the engine has lost
    points = finite if len(finite) else np.zeros((1, 3))
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    slope = camera.focal_length / np.array((camera.width, camera.height)) * 2 * _MARGIN
    reach = (np.abs(points - middle)[:, :2] * slope).max(axis=1)
    least = _LEAST_EXTENT / 2 * slope.max()
    height = max((points[:, 2] + reach).max(), high[2] + least)
    return float(middle[0]), float(middle[1]), float(height)


_MOST_STEPS = 1_000_000
_MOST_PIXELS = 4096
_WIDTH, _HEIGHT = 800, 600
_FARTHEST = 1e5  # [m], as in world files


class Outcome(Protocol):
    """The fields of every response."""

    success: bool
    message: str


RequestT = TypeVar("RequestT")
OutcomeT = TypeVar("OutcomeT", bound=Outcome)
BodyT = TypeVar("BodyT", bound=Robot | MovableObject)


class Control:
    """Offers the services; ``on_change`` is called when robots have been added or removed."""

    def __init__(
        self, node: Node, simulation: Simulation, loop: Loop, on_change: Callable[[], None]
    ) -> None:
        self._simulation, self._loop, self._on_change = simulation, loop, on_change
        offer = node.create_service
        offer(std_srvs.Trigger, "~pause", _answered(self._pause))
        offer(std_srvs.Trigger, "~resume", _answered(self._resume))
        offer(std_srvs.Trigger, "~reset", _answered(self._reset))
        offer(sim_msgs.Step, "~step", _answered(self._step))
        offer(sim_msgs.SetRate, "~set_rate", _answered(self._set_rate))
        offer(sim_msgs.SetPose, "~set_pose", _answered(self._set_pose))
        offer(sim_msgs.GetState, "~get_state", _answered(self._get_state))
        offer(sim_msgs.Spawn, "~spawn", _answered(self._spawn))
        offer(sim_msgs.Delete, "~delete", _answered(self._delete))
        offer(sim_msgs.Snapshot, "~snapshot", _answered(self._snapshot))

    def _pause(self, _: std_srvs.Trigger_Request, response: std_srvs.Trigger_Response) -> None:
        response.message = "was already paused" if self._loop.paused else "paused"
        self._loop.pause()

    def _resume(self, _: std_srvs.Trigger_Request, response: std_srvs.Trigger_Response) -> None:
        response.message = "resumed" if self._loop.paused else "was not paused"
        self._loop.paused = False

    def _reset(self, _: std_srvs.Trigger_Request, response: std_srvs.Trigger_Response) -> None:
        self._simulation.reset()
        self._on_change()
        response.message = "everything is where it was at the start"

    def _step(self, request: sim_msgs.Step_Request, response: sim_msgs.Step_Response) -> None:
        self._check_leads()
        if not 1 <= request.steps <= _MOST_STEPS:
            raise UsageError(f"steps must be from 1 to {_MOST_STEPS}, not {request.steps}")
        if not self._loop.paused:
            raise UsageError("the simulator is not paused", "pause it first")
        if self._loop.is_stepping:  # the loop is waiting for a follower
            raise UsageError("the simulator is executing another request's steps", "wait for them")
        done = self._loop.step(request.steps)
        response.time = self._simulation.time
        response.message = f"did {plural(done, 'step')}, now at {response.time / 1e9:.6f} s"

    def _set_rate(
        self, request: sim_msgs.SetRate_Request, response: sim_msgs.SetRate_Response
    ) -> None:
        self._check_leads()
        if not 0 <= request.rate < math.inf:  # also refuses NaN
            raise UsageError(f"the rate must be 0 or more, not {request.rate:g}")
        self._loop.set_rate(request.rate)
        speed = f"{request.rate:g} times real time" if request.rate else "as fast as possible"
        response.message = f"simulated time passes {speed}"

    def _set_pose(
        self, request: sim_msgs.SetPose_Request, response: sim_msgs.SetPose_Response
    ) -> None:
        bodies: dict[str, Robot | MovableObject] = {**self._robots()}
        bodies |= {body.name: body for body in self._simulation.objects}
        body = _named(request.robot, bodies, "robot or movable object")
        self._simulation.place(body, _read_pose(request.pose))
        name = body.namespace if isinstance(body, Robot) else body.name
        response.message = f"{name} was placed there"

    def _get_state(
        self, request: sim_msgs.GetState_Request, response: sim_msgs.GetState_Response
    ) -> None:
        robot = self._robot(request.robot)
        state = robot.state(self._simulation.time)
        response.time, response.model = state.time, robot.model.name
        place, turn, twist = response.pose.position, response.pose.orientation, response.twist
        height = robot.model.body.base_height  # height of base_link above base_footprint
        frame = Frame(state.position, state.rotation)
        place.x, place.y, place.z = frame.point((0.0, 0.0, -height))
        turn.x, turn.y, turn.z, turn.w = state.rotation
        twist.linear.x, twist.linear.y, twist.linear.z = state.velocity
        twist.angular.x, twist.angular.y, twist.angular.z = state.angular_velocity

    def _spawn(self, request: sim_msgs.Spawn_Request, response: sim_msgs.Spawn_Response) -> None:
        if request.model not in MODELS:
            hint = did_you_mean(request.model, MODELS) or f"known models: {', '.join(MODELS)}"
            raise UsageError(f"unknown model '{request.model}'", hint)
        namespace = resolve_namespace(request.robot)
        if namespace in self._robots():
            raise UsageError(f"there is already a robot {namespace}")
        pose = _read_pose(request.pose)
        self._simulation.add(RobotPlacement(MODELS[request.model], namespace, pose, where="spawn"))
        self._on_change()
        response.message = f"the {request.model} {namespace} was added"

    def _delete(self, request: sim_msgs.Delete_Request, response: sim_msgs.Delete_Response) -> None:
        robot = self._robot(request.robot)
        self._simulation.remove(robot)
        self._on_change()
        response.message = f"{robot.namespace} was removed"

    def _snapshot(
        self, request: sim_msgs.Snapshot_Request, response: sim_msgs.Snapshot_Response
    ) -> None:
        width, height = request.width or _WIDTH, request.height or _HEIGHT
        if not (1 <= width <= _MOST_PIXELS and 1 <= height <= _MOST_PIXELS):
            raise UsageError(f"a picture has 1 to {_MOST_PIXELS} columns and rows")
        simulation, frame = self._simulation, None
        if request.robot:
            state = self._robot(request.robot).state(simulation.time)
            frame = Frame(state.position, state.rotation)
        response.image.data = snapshot(simulation.solids(), width, height, frame)
        response.image.format = "png"
        response.message = f"a picture of {width} x {height} pixels"

    def _check_leads(self) -> None:
        if not self._simulation.leads:
            what = "this simulator follows the /clock of another one"
            raise UsageError(what, "step that one, or set its rate")

    def _robots(self) -> dict[str, Robot]:
        return {robot.namespace: robot for robot in self._simulation.robots}

    def _robot(self, name: str) -> Robot:
        return _named(name, self._robots(), "robot")


def _named(name: str, bodies: Mapping[str, BodyT], kind: str) -> BodyT:
    """Return the body with a name; a robot's namespace may lack its slash."""
    namespace = f"/{name.strip('/')}"
    if found := bodies.get(namespace) or bodies.get(name):
        return found
    hint = did_you_mean(namespace, bodies) or f"known: {', '.join(bodies) or 'none'}"
    raise UsageError(f"there is no {kind} '{name}'", hint)


def _answered(
    act: Callable[[RequestT, OutcomeT], None],
) -> Callable[[RequestT, OutcomeT], OutcomeT]:
    """Return a service's callback, which acts, and answers with success or the error."""

    def answer(request: RequestT, response: OutcomeT) -> OutcomeT:
        response.success = True
        try:
            act(request, response)
        except LcmtoolsError as error:
            response.success, response.message = False, str(error)
        return response

    return answer


def _read_pose(message: geometry_msgs.Pose) -> Pose:
    """Read a pose, with a quaternion of any length except zero; UsageError for a bad one."""
    place, turn = message.position, message.orientation
    rotation = turn.x, turn.y, turn.z, turn.w
    length = math.hypot(*rotation)
    is_near = all(abs(value) <= _FARTHEST for value in (place.x, place.y, place.z))
    if not (is_near and math.isfinite(length)):
        raise UsageError(f"the pose is not finite, or farther than {_FARTHEST:g} m")
    if not length:
        raise UsageError("the orientation is all zeros", "w: 1 for none")
    x, y, z, w = (value / length for value in rotation)
    return Pose(place.x, place.y, place.z, *to_euler((x, y, z, w)))
