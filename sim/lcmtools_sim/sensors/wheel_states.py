"""What the wheels do: angle, speed and applied effort of both sides."""

from typing import ClassVar

from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.sensors.sensor import RobotState, fill_header, frame


class WheelStatesSensor:
    """sensor_msgs/JointState with two joints: left at index 0, right at index 1.

    Args:
        namespace: The robot's, which prefixes the frame.
    """

    message_type: ClassVar[type[Message]] = JointState

    def __init__(self, namespace: str) -> None:
        self._frame = frame(namespace, "base_link")

    def sample(self, state: RobotState) -> JointState:
        """The message of one step."""
        message = JointState()
        fill_header(message.header, state.time, self._frame)
        message.name = ["left", "right"]
        message.position = [wheel.angle for wheel in state.wheels]
        message.velocity = [wheel.speed for wheel in state.wheels]
        message.effort = [wheel.effort for wheel in state.wheels]
        return message
