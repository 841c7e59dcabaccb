"""A page's requests to simulators, through their services, and poses that it sends."""

import math
from typing import Annotated, Protocol, TypeAlias, TypeVar

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.typed import Within
from lcmtools.gui.page_publisher import Publishers, RequestT
from lcmtools.gui.protocol import Json, MalformedRequest
from lcmtools.gui.source import Source, publishers_of, topic_to_publish
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
_Place: TypeAlias = Annotated[float, Within(-_FARTHEST, _FARTHEST)]
_Part: TypeAlias = Annotated[float, Within(-1, 1)]  # of a quaternion


class _Outcome(Message, Protocol):
    """The fields of every simulator's response."""

    success: bool
    message: str


OutcomeT = TypeVar("OutcomeT", bound=_Outcome)


def simulate(  # noqa: PLR0913 - the keys of a request
    source: Source,
    *,
    node: str,
    verb: str,
    name: str = "",
    steps: Annotated[int, Within(1, _MOST_STEPS)] = 1,
    rate: Annotated[float, Within(0)] = 1.0,
    x: _Place = 0.0,
    y: _Place = 0.0,
    z: _Place = 0.0,
    qz: _Part = 0.0,
    qw: _Part = 1.0,
) -> Json:
    """Call ``verb`` of the simulator ``node``; return its answer.

    Raises:
        LcmtoolsError: The simulator refused; the error has its reason.
        ServiceTimeout: It did not answer.
    """
    service = resolve(f"{node}/{verb}")
    publishers = publishers_of(source)
    if verb in ("pause", "resume", "reset"):
        return _call(publishers, Trigger, service, Trigger.Request())
    if verb == "step":
        step = Step.Request()
        step.steps = steps
        return _call(publishers, Step, service, step)
    if verb == "set_rate":
        faster = SetRate.Request()
        faster.rate = rate
        return _call(publishers, SetRate, service, faster)
    if verb == "set_pose":
        pose = SetPose.Request()
        pose.robot, pose.pose = name, _pose(x, y, z, qz, qw)
        return _call(publishers, SetPose, service, pose)
    raise MalformedRequest(f"no simulator has a service '{verb[:40]}'")


def send_pose(  # noqa: PLR0913 - the keys of a request
    source: Source,
    *,
    topic: str,
    frame: str,
    x: _Place = 0.0,
    y: _Place = 0.0,
    qz: _Part = 0.0,
    qw: _Part = 1.0,
) -> Json:
    """Publish a pose in a ``frame`` on ``topic``, like rviz for a goal or an initial pose.

    The latter is a topic of PoseWithCovarianceStamped.
    """
    topic, pose = topic_to_publish(source, topic), _pose(x, y, 0.0, qz, qw)
    message: PoseStamped | PoseWithCovarianceStamped = PoseStamped()
    if source.latest.row(topic).types[:1] == (type_name(PoseWithCovarianceStamped),):
        message = _uncertain(pose)
    else:
        message.pose = pose
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


def _pose(x: float, y: float, z: float, qz: float, qw: float) -> Pose:
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = x, y, z
    pose.orientation.z, pose.orientation.w = qz, qw
    return pose
