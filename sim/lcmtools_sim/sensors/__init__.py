"""The sensors, one file each; robot models and world files name them by their key here."""

from lcmtools_sim.sensors.ground_truth import GroundTruthSensor
from lcmtools_sim.sensors.odometry import OdometrySensor
from lcmtools_sim.sensors.sensor import SensorKind
from lcmtools_sim.sensors.wheel_states import WheelStatesSensor

SENSORS: dict[str, SensorKind] = {
    "ground_truth": SensorKind(GroundTruthSensor, topic="ground_truth"),
    "odometry": SensorKind(OdometrySensor, topic="odometry"),
    "wheel_states": SensorKind(WheelStatesSensor, topic="wheel_velocities"),
}
"""Every sensor by its kind."""
