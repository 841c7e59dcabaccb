"""What the wheels do: angle, speed and applied effort of both sides."""

from collections.abc import Collection, Mapping

from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, fill_header


class WheelStatesSensor:
    """sensor_msgs/JointState with two joints: left at index 0, right at index 1.

    Args:
        mount: Where it publishes.
        carrier: The robot, whose namespace prefixes the frame.
    """

    outputs: Mapping[str, type[Message]] = {"": JointState}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        del mount  # it measures the whole robot, which is one thing to set
        self._frame = carrier.frame("base_link")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """The message of one step."""
        del wanted
        message = JointState()
        fill_header(message.header, state.time, self._frame)
        message.name = ["left", "right"]
        message.position = [wheel.angle for wheel in state.wheels]
        message.velocity = [wheel.speed for wheel in state.wheels]
        message.effort = [wheel.effort for wheel in state.wheels]
        return {"": message}
