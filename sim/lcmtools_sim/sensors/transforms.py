"""Where a robot's frames are: odom to base_link by the encoders, base_link to each sensor."""

import math
from collections.abc import Collection, Mapping

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools_sim.rotation import Quaternion, Vector
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_quaternion
from lcmtools_sim.shapes import UNTURNED


class TransformsSensor:
    """tf2_msgs/TFMessage with all frames of one robot (REP-105).

    Mount it last: it tells the frames of the sensors that were mounted before.

    Args:
        mount: Where it publishes.
        carrier: The robot.
    """

    outputs: Mapping[str, type[Message]] = {"": TFMessage}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        del mount  # it measures the whole robot
        self._carrier = carrier
        self._odom = carrier.frame("odom")
        self._base = carrier.frame("base_link")
        self._template: PayloadTemplate | None = None

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """The transforms of one step."""
        del wanted
        stencil = self._template = self._template or self._prepare()
        x, y, yaw = state.reckoned_pose
        place = x, y, 0.0, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)
        stamps = [state.stamp] * (1 + len(self._carrier.frames))
        return {"": stencil.fill(place, *stamps)}

    def _prepare(self) -> PayloadTemplate:
        """The message but for where the robot is and all stamps."""
        message = TFMessage()
        message.transforms = [
            _transform(self._odom, self._base, (0.0, 0.0, 0.0), UNTURNED),
            *(
                _transform(self._base, frame, position, rotation)
                for frame, (position, rotation) in self._carrier.frames.items()
            ),
        ]
        stamps = (f"transforms[{index}].header.stamp" for index in range(len(message.transforms)))
        return PayloadTemplate(message, "transforms[0].transform", *stamps)


def _transform(parent: str, child: str, position: Vector, rotation: Quaternion) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id = parent
    message.child_frame_id = child
    place = message.transform.translation
    place.x, place.y, place.z = position
    fill_quaternion(message.transform.rotation, rotation)
    return message
