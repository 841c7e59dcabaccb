"""The sensors, one file each; a robot model names them by their key here."""

from collections.abc import Callable

from lcmtools_sim.sensors.ground_truth import GroundTruthSensor
from lcmtools_sim.sensors.odometry import OdometrySensor
from lcmtools_sim.sensors.sensor import Sensor
from lcmtools_sim.sensors.wheel_states import WheelStatesSensor

SENSORS: dict[str, Callable[[str], Sensor]] = {
    "ground_truth": GroundTruthSensor,
    "odometry": OdometrySensor,
    "wheel_states": WheelStatesSensor,
}
"""Every sensor by its kind; it is made for a robot's namespace."""
