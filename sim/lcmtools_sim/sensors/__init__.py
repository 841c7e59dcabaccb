"""The sensors; robot models and world files name them by their key here."""

from lcmtools_sim.sensors import cameras, motion
from lcmtools_sim.sensors.bumper import BumperSensor
from lcmtools_sim.sensors.laser import LaserSensor, LaserSettings
from lcmtools_sim.sensors.sensor import SensorKind as Kind

SENSORS: dict[str, Kind] = {
    "bumper": Kind(BumperSensor, topic="bumper"),
    "camera": Kind(
        cameras.CameraSensor, cameras.CameraSettings, rate=30.0, topic="camera", is_optical=True
    ),
    "depth_camera": Kind(
        cameras.DepthCameraSensor,
        cameras.DepthCameraSettings,
        rate=30.0,
        topic="camera",
        bulky=cameras.BULKY,
        is_optical=True,
    ),
    "ground_truth": Kind(
        motion.GroundTruthSensor, motion.GroundTruthSettings, topic="ground_truth"
    ),
    "imu": Kind(motion.ImuSensor, motion.ImuSettings, topic="imu"),
    "laser": Kind(LaserSensor, LaserSettings, rate=10.0, topic="scan"),
    "odometry": Kind(motion.OdometrySensor, motion.OdometrySettings, topic="odometry"),
    "transforms": Kind(motion.TransformsSensor, topic="/tf", needs_frames=True),
    "wheel_states": Kind(
        motion.WheelStatesSensor, motion.WheelStatesSettings, topic="wheel_velocities"
    ),
}
