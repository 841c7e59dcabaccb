"""What cameras share: looking at the world from where one is mounted on a robot."""

import numpy as np

from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, RobotState, placed
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.depth import Sight, look
from lcmtools_sim.vision.solids import Solids, joined, solids_of


class Eye:
    """A camera on a robot. It does not see the robot's own body.

    Args:
        camera: Its intrinsics.
        mount: Where it is: x forward, into the scene.
        carrier: The robot.
        frame: The usual name of its optical frame (z forward, x right, y down), without the prefix.

    Attributes:
        camera: As given.
        frame: The optical frame's id.
    """

    def __init__(self, camera: Camera, mount: SensorMount, carrier: Carrier, frame: str) -> None:
        self.camera = camera
        self.frame = carrier.put_frame(mount, frame, optical(mount.pose.rotation))
        self._pose = mount.pose
        self._around = carrier.around
        self._fixed: Solids | None = None
        self._fixed_parts: object = None

    def look(self, state: RobotState, far: float = np.inf) -> Sight:
        """What is seen after one step, up to a greatest depth [m]."""
        position, rotation = placed(state, self._pose)
        return look(self._solids(), self.camera, position, optical(rotation), far)

    def _solids(self) -> Solids:
        """Everything around; what stands for ever is prepared once."""
        parts = self._around.fixed_parts()
        if self._fixed is None or parts is not self._fixed_parts:
            self._fixed, self._fixed_parts = solids_of(parts, self._around.ground_color()), parts
        moving = self._around.moving_parts()
        return joined(self._fixed, solids_of(moving)) if moving else self._fixed
