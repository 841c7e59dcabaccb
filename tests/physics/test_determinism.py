"""The same seed and the same commands at the same steps give the same run, bit for bit."""

import os
import subprocess
import sys

import pytest

SCRIPT = """
import hashlib
from lcmtools.messages.codec import encode
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world

COMMANDS = {0: (1, 0.9), 500: (-0.4, 1), 1200: (1, 1)}
digest = hashlib.sha256()
with Simulation(read_scene(*find_world("husky"))) as simulation:
    for step in range(2400):
        if step in COMMANDS:
            message = JointState()
            message.effort = COMMANDS[step]
            simulation.robots[0].command(message)
        for sample in simulation.step():
            digest.update(encode(sample.message))
print(digest.hexdigest())
"""


EVERYTHING = """
import hashlib
import math
from dataclasses import replace
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools_sim.pose import Pose
from lcmtools_sim.robots import DOLLY, HUSKY, PIONEER
from lcmtools_sim.scene import RobotPlacement, Scene, box
from lcmtools_sim.sensors.camera import CameraSettings
from lcmtools_sim.sensors.depth_camera import DepthCameraSettings
from lcmtools_sim.sensors.imu import ImuSettings
from lcmtools_sim.sensors.laser import LaserSettings
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.odometry import OdometrySettings
from lcmtools_sim.simulation import Simulation

front = Pose(0.6, 0, 0.3)
more = (
    SensorMount("bumper", "bumper", 50.0),
    SensorMount("camera", "eye", 5.0, front, settings=CameraSettings(64, 48)),
    SensorMount("depth_camera", "kinect", 5.0, front, settings=DepthCameraSettings(
        64, 48, noise=1.4e-3, step=2.85e-3, dropout=0.01)),
    SensorMount("imu", "noisy_imu", 100.0, settings=ImuSettings(0.01, 0.1)),
    SensorMount("laser", "scan", 10.0, front, settings=LaserSettings(noise=0.01)),
    SensorMount("odometry", "noisy_odometry", 50.0, settings=OdometrySettings(0.01, 0.01, 0.01)),
)
skid = replace(HUSKY, drive=replace(HUSKY.drive, skids=True))
places = [(HUSKY, Pose()), (skid, Pose(0, 3)), (PIONEER, Pose(0, -3)), (DOLLY, Pose(-3, 0))]
robots = []
for number, (model, pose) in enumerate(places):
    model = replace(model, sensors=model.sensors[:3] + more + model.sensors[-1:])
    robots.append(RobotPlacement(model, f"/r{number}", pose))
things = (
    box("wall", (0.2, 20, 2), Pose(3, 0, 1)),
    box("crate", (1, 1, 1), Pose(2, 0, 0.5), mass=10),
)
digest, topics = hashlib.sha256(), set()
with Simulation(Scene("all", seed=5, things=things, robots=tuple(robots))) as simulation:
    for step in range(960):
        if step % 240 == 0:
            for number, robot in enumerate(simulation.robots):
                message = Twist()
                message.linear.x, message.angular.z = 0.9, math.sin(step + number)
                robot.command(message)
        for sample in simulation.step():
            topics.add(sample.topic)
            digest.update(sample.topic.encode() + encode(sample.message))
assert len(topics) > 60, topics
print(digest.hexdigest())
"""


@pytest.mark.parametrize("script", [SCRIPT, EVERYTHING], ids=["world", "everything"])
def test_two_processes_publish_bitwise_the_same(script: str) -> None:
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", script],
            stdout=-1,
            stderr=-1,
            text=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        )
        for seed in ("1", "2")
    ]
    results = [process.communicate(timeout=60) for process in processes]

    # Nothing of the engine's own chatter is in between, either.
    assert [error for _, error in results] == ["", ""]
    assert results[0][0] == results[1][0]
    assert len(results[0][0]) == 64 + 1
