"""The sensors, one file each; robot models and world files name them by their key here."""

from lcmtools_sim.sensors.bumper import BumperSensor
from lcmtools_sim.sensors.camera import CameraSensor, CameraSettings
from lcmtools_sim.sensors.depth_camera import BULKY, DepthCameraSensor, DepthCameraSettings
from lcmtools_sim.sensors.ground_truth import GroundTruthSensor, GroundTruthSettings
from lcmtools_sim.sensors.imu import ImuSensor, ImuSettings
from lcmtools_sim.sensors.laser import LaserSensor, LaserSettings
from lcmtools_sim.sensors.odometry import OdometrySensor, OdometrySettings
from lcmtools_sim.sensors.sensor import SensorKind
from lcmtools_sim.sensors.transforms import TransformsSensor
from lcmtools_sim.sensors.wheel_states import WheelStatesSensor, WheelStatesSettings

SENSORS: dict[str, SensorKind] = {
    "bumper": SensorKind(BumperSensor, topic="bumper"),
    "camera": SensorKind(CameraSensor, CameraSettings, rate=30.0, topic="camera"),
    "depth_camera": SensorKind(
        DepthCameraSensor, DepthCameraSettings, rate=30.0, topic="camera", bulky=BULKY
    ),
    "ground_truth": SensorKind(GroundTruthSensor, GroundTruthSettings, topic="ground_truth"),
    "imu": SensorKind(ImuSensor, ImuSettings, topic="imu"),
    "laser": SensorKind(LaserSensor, LaserSettings, rate=10.0, topic="scan"),
    "odometry": SensorKind(OdometrySensor, OdometrySettings, topic="odometry"),
    "transforms": SensorKind(TransformsSensor, topic="/tf"),
    "wheel_states": SensorKind(WheelStatesSensor, WheelStatesSettings, topic="wheel_velocities"),
}
"""Every sensor by its kind."""
