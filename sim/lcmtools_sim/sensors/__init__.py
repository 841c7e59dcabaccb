"""The sensors; robot models and world files name them by their key here."""

from lcmtools_sim.sensors.bumper import BumperSensor
from lcmtools_sim.sensors.cameras import (
    BULKY,
    CameraSensor,
    CameraSettings,
    DepthCameraSensor,
    DepthCameraSettings,
)
from lcmtools_sim.sensors.laser import LaserSensor, LaserSettings
from lcmtools_sim.sensors.motion import (
    GroundTruthSensor,
    GroundTruthSettings,
    ImuSensor,
    ImuSettings,
    OdometrySensor,
    OdometrySettings,
    TransformsSensor,
    WheelStatesSensor,
    WheelStatesSettings,
)
from lcmtools_sim.sensors.sensor import SensorKind

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
