"""The frames in /tf agree with odometry and the sensors' own headers."""

from dataclasses import replace

import pytest

from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools_sim.geometry import Pose
from lcmtools_sim.mounted import Subscribers
from lcmtools_sim.robots import MODELS
from lcmtools_sim.scene import RobotPlacement, Scene
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.world_file import read_scene

ODOMETRY = {"husky": "odometry", "pioneer": "RosAria/pose", "dolly": "odom"}
SENSORS = {
    "husky": {"imu_link": (0.19, 0, 0.149)},
    "pioneer": {"camera_depth_optical_frame": (0.10, 0, 0.25)},
    "dolly": {"laser": (0.2, 0, 0)},
}


@pytest.fixture
def driving(simulate, twist):
    """A simulation of one robot that drives a circle."""

    def make(model, namespace="/r0"):
        robots = (RobotPlacement(MODELS[model], namespace),)
        simulation = simulate(scene=Scene("tf", robots=robots))
        simulation.robots[0].command(twist(0.5, 0.3))
        simulation.select(
            lambda topic: Subscribers.KNOWN if "camera" not in topic else Subscribers.NONE
        )
        return simulation

    return make


@pytest.mark.parametrize("model", MODELS)
def test_odom_to_base_link_is_what_odometry_says(driving, model):
    simulation, compared = driving(model), 0
    for _ in range(960):
        samples = {sample.topic: sample.message for sample in simulation.step()}
        odometry = samples.get(f"/r0/{ODOMETRY[model]}")
        if odometry is None:
            continue
        assert isinstance(odometry, Odometry)
        transforms = samples["/tf"]
        assert isinstance(transforms, TFMessage)
        first = transforms.transforms[0]
        assert first.header.frame_id == odometry.header.frame_id == "r0/odom"
        assert first.child_frame_id == odometry.child_frame_id == "r0/base_link"
        assert first.header.stamp.nsec == odometry.header.stamp.nsec
        place, pose = first.transform.translation, odometry.pose.pose
        assert (place.x, place.y, place.z) == (pose.position.x, pose.position.y, 0)
        turned = first.transform.rotation
        assert (turned.z, turned.w) == (pose.orientation.z, pose.orientation.w)
        compared += 1
    assert compared == {"pioneer": 40, "dolly": 400}.get(model, 200)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("namespace", "prefix"), [("/r0", "r0/"), ("/a/b", "a/b/"), ("/", "")])
def test_every_sensor_with_a_place_hangs_on_base_link(driving, model, namespace, prefix):
    simulation = driving(model, namespace)
    samples = [sample for _ in range(24) for sample in simulation.step()]
    message = next(s.message for s in samples if s.topic == "/tf")
    _, *mounted = message.transforms
    assert {t.header.frame_id for t in mounted} == {f"{prefix}base_link"}
    told = {t.child_frame_id.removeprefix(prefix): t.transform.translation for t in mounted}
    assert {name: (p.x, p.y, p.z) for name, p in told.items()} == {
        name: pytest.approx(place) for name, place in SENSORS[model].items()
    }
    frames = {s.message.header.frame_id for s in samples if hasattr(s.message, "header")}
    known = {t.child_frame_id for t in message.transforms} | {f"{prefix}odom", "world"}
    assert frames <= known


def test_an_optical_frame_looks_forward(driving):
    simulation = driving("pioneer")
    samples = [sample for _ in range(24) for sample in simulation.step()]
    message = next(s.message for s in samples if s.topic == "/tf")
    turned = message.transforms[1].transform.rotation
    assert (turned.x, turned.y, turned.z, turned.w) == pytest.approx((-0.5, 0.5, -0.5, 0.5))


def test_two_sensors_at_two_places_have_two_frames(simulate):
    mounts = (
        SensorMount("laser", "front/scan", 10, Pose(0.5)),
        SensorMount("laser", "rear/scan", 10, Pose(-0.5)),
        SensorMount("laser", "front/more", 10, Pose(0.5)),
        SensorMount("camera", "left", 10, Pose(0, 0.3, 0.5)),
        SensorMount("camera", "right", 10, Pose(0, -0.3, 0.5)),
        SensorMount("transforms", "/tf", 10),
    )
    robots = (RobotPlacement(replace(MODELS["husky"], sensors=mounts), "/r0"),)
    simulation = simulate(scene=Scene("tf", robots=robots))
    samples = {s.topic: s.message for _ in range(24) for s in simulation.step()}
    told = {t.child_frame_id: t.transform.translation for t in samples["/tf"].transforms[1:]}
    where = {topic: told[samples[topic].header.frame_id] for topic in samples if "can" in topic}
    assert {topic: place.x for topic, place in where.items()} == {
        "/r0/front/scan": 0.5,
        "/r0/rear/scan": -0.5,
    }
    assert samples["/r0/front/more"].header.frame_id == "r0/laser"
    assert samples["/r0/rear/scan"].header.frame_id == "r0/rear_scan_laser"
    left, right = (samples[f"/r0/{side}/camera_info"].header.frame_id for side in ("left", "right"))
    assert (told[left].y, told[right].y) == (0.3, -0.3)


def test_a_sensor_that_a_world_file_adds_hangs_on_base_link_too(simulate):
    text = """robots:
      - {model: husky, namespace: /r0, sensors: [{type: laser, topic: scan, pose: [0.4, 0, 0]}]}"""
    simulation = simulate(scene=read_scene(text, "scan.yaml"))
    samples = {s.topic: s.message for _ in range(24) for s in simulation.step()}
    told = {t.child_frame_id: t.transform.translation for t in samples["/tf"].transforms}
    assert told[samples["/r0/scan"].header.frame_id].x == 0.4
