"""A page's requests to simulators, through their services, and poses that it sends."""

import math
from typing import Protocol, TypeVar

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.page_publisher import Publishers, RequestT
from lcmtools.gui.protocol import Json, MalformedRequest, Parameters
from lcmtools.gui.source import Source, publishers_of
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message, type_name
from lcmtools.names import resolve
from lcmtools.node.service import ServiceType
from lcmtools.types.geometry_msgs import Pose, PoseStamped, PoseWithCovarianceStamped
from lcmtools.types.sim_msgs import SetPose, SetRate, Step
from lcmtools.types.std_srvs import Trigger

_TIMEOUT = 5.0  # [s]
_FARTHEST = 1e5  # [m]
_MOST_STEPS = 10_000


class _Outcome(Message, Protocol):
    """The fields of every simulator's response."""

    success: bool
    message: str


OutcomeT = TypeVar("OutcomeT", bound=_Outcome)


def simulate(source: Source, parameters: Parameters) -> Json:
    """Call ``verb`` of the simulator ``node``; return its answer.

    Raises:
        LcmtoolsError: The simulator refused; the error has its reason.
        ServiceTimeout: It did not answer.
    """
    verb = parameters.text("verb")
    name = resolve(f"{parameters.text('node')}/{verb}")
    publishers = publishers_of(source)
    if verb in ("pause", "resume", "reset"):
        return _call(publishers, Trigger, name, Trigger.Request())
    if verb == "step":
        step = Step.Request()
        step.steps = round(parameters.number("steps", 1, 1, _MOST_STEPS))
        return _call(publishers, Step, name, step)
    if verb == "set_rate":
        rate = SetRate.Request()
        rate.rate = parameters.number("rate", 1.0, 0.0)
        return _call(publishers, SetRate, name, rate)
    if verb == "set_pose":
        pose = SetPose.Request()
        pose.robot, pose.pose = parameters.text("name"), _pose(parameters)
        return _call(publishers, SetPose, name, pose)
    raise MalformedRequest(f"no simulator has a service '{verb[:40]}'")


def send_pose(source: Source, parameters: Parameters) -> Json:
    """Publish a pose in a ``frame`` on ``topic``, like rviz for a goal or an initial pose.

    The latter is a topic of PoseWithCovarianceStamped.
    """
    topic, frame = resolve(parameters.text("topic")), parameters.text("frame")
    message: PoseStamped | PoseWithCovarianceStamped = PoseStamped()
    if source.latest.row(topic).types[:1] == (type_name(PoseWithCovarianceStamped),):
        message = _uncertain(_pose(parameters))
    else:
        message.pose = _pose(parameters)
    message.header.frame_id = frame
    publishers_of(source).publish(topic, type(message), encode(message))
    return {"topic": topic}


def _call(
    publishers: Publishers, kind: ServiceType[RequestT, OutcomeT], name: str, request: RequestT
) -> Json:
    response = publishers.client(kind, name).call(request, _TIMEOUT)
    if not response.success:
        raise LcmtoolsError(response.message)
    return {"message": response.message}


def _uncertain(pose: Pose) -> PoseWithCovarianceStamped:
    """Return a message with the variances that rviz states: 0.5 m and 15 degrees squared."""
    message = PoseWithCovarianceStamped()
    message.pose.pose = pose
    covariance = [0.0] * 36
    covariance[0] = covariance[7] = 0.25
    covariance[35] = math.radians(15) ** 2
    message.pose.covariance = covariance
    return message


def _pose(parameters: Parameters) -> Pose:
    """Return the pose in ``x``, ``y`` [m] and the quaternion's ``qz`` and ``qw``."""
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = (
        parameters.number(name, 0.0, -_FARTHEST, _FARTHEST) for name in "xyz"
    )
    pose.orientation.z = parameters.number("qz", 0.0, -1, 1)
    pose.orientation.w = parameters.number("qw", 1.0, -1, 1)
    return pose
