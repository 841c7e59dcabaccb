"""A new kind of sensor is a class and an entry in the table: here a sonar. Metres."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import pytest

import lcmtools
from lcmtools.errors import InvalidFile
from lcmtools.formats.typed import Within
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.types.sensor_msgs import Range
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.geometry import IDENTITY, ZERO
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import (
    SensorKind,
    Settings,
    fill_header,
)
from lcmtools_sim.vision.scan import Scanner
from lcmtools_sim.world_file import read_scene

YARD = """\
node: yard
objects:
  - {type: walls, points: [[2, -5], [2, 5]], height: 1, thickness: 0.2}
robots:
  - model: husky
    namespace: /husky0
    sensors: """
TOLERANCE = 0.01


@dataclass(frozen=True, slots=True)
class SonarSettings(Settings):
    """The properties of a sonar."""

    cone: Annotated[float, Within(0.01, 1.0, unit="rad")] = math.radians(15)
    blind: Annotated[float, Within(0.0, 10.0)] = 0.02
    reach: Annotated[float, Within(0.01, 10.0, above="blind")] = 4.0
    wear: Annotated[float, Within(0.0, 1.0)] = 0.0  # its cable brakes the encoders

    @property
    def encoder_noise(self):
        """The wear."""
        return self.wear


class Sonar:
    """sensor_msgs/Range: the distance to the nearest thing in a cone."""

    outputs: Mapping[str, type[Message]] = {"": Range}

    def __init__(self, mount, context):
        self._settings = settings = mount.settings or SonarSettings()
        self._pose, self._world, self._body = mount.pose, context.world, context.body
        self._frame = context.add_frame(mount, "sonar", mount.pose.rotation)
        half = settings.cone / 2
        self._scanner = Scanner(np.linspace(-half, half, 9), settings.reach)

    def sample(self, state, wanted):
        """Return the range of one step."""
        del wanted
        others = {**self._world.moving_bodies()}
        del others[self._body]
        around = [(self._world.fixed_solids(), ZERO, IDENTITY), *others.values()]
        message = Range()
        fill_header(message.header, state.time, self._frame)
        message.range = float(self._scanner.scan(*state.sensor_frame(self._pose), around).min())
        return {"": encode(message)}


SONAR = SensorKind(Sonar, SonarSettings, rate=20.0, topic="sonar")


@pytest.fixture(autouse=True)
def _in_the_table(monkeypatch):
    monkeypatch.setitem(SENSORS, "sonar", SONAR)


def samples(simulation, kind):
    """The messages of a type in the next second."""
    steps = round(1 / simulation.scene.dt)
    found = [sample for _ in range(steps) for sample in simulation.step()]
    return [sample.message for sample in found if sample.message_type is kind]


def test_a_world_file_may_mount_it_and_it_measures(simulate):
    simulation = simulate(scene=read_scene(f"{YARD}[{{type: sonar, pose: [0.5, 0, 0]}}]", "y.yaml"))
    ranges = samples(simulation, Range)
    assert simulation.topics()["/husky0/sonar"] is Range
    assert len(ranges) == 20
    assert [one.range for one in ranges] == pytest.approx([1.4] * 20, abs=TOLERANCE)
    assert {one.header.frame_id for one in ranges} == {"husky0/sonar"}


MISTAKES = {
    "[{type: sonar, blind: 5}]": "'blind' (5) must be less than 'reach' (4)",
    "[{type: sonar, reach: 0.01}]": "'blind' (0.02) must be less than 'reach' (0.01)",
    "[{type: sonar, blind: 2, reach: 1}]": "'blind' (2) must be less than 'reach' (1)",
    "[{type: sonar, reach: 20}]": "'reach' must be between 0.01 and 10, not 20",
    "[{type: sonar, cone: x deg}]": "'cone' must be an angle, not 'x deg'",
    "[{type: sonar, rays: 3}]": (
        "unknown key 'rays' in 'sensors[0]'; known keys: type, topic, rate, pose, frame, always,"
        " off, cone, blind, reach, wear"
    ),
    "[{type: sonr}]": "unknown sensor 'sonr'; did you mean sonar?",
}


@pytest.mark.parametrize("sensors", MISTAKES)
def test_mistakes_in_its_settings_are_refused_with_their_line(sensors):
    with pytest.raises(InvalidFile) as caught:
        read_scene(f"{YARD}{sensors}", "yard.yaml")
    assert str(caught.value) == f"yard.yaml:7: {MISTAKES[sensors]}"


@pytest.mark.parametrize("is_optical", [False, True])
def test_only_kinds_with_the_same_axes_may_share_a_frame(monkeypatch, *, is_optical):
    monkeypatch.setitem(SENSORS, "sonar", replace(SONAR, is_optical=is_optical))
    text = f"{YARD}[{{type: camera, frame: eye}}, {{type: sonar, frame: eye}}]"
    if is_optical:
        assert read_scene(text, "yard.yaml").robots[0].model.sensors[-1].frame == "eye"
    else:
        with pytest.raises(InvalidFile, match="the frame 'eye' is that of 'camera' too"):
            read_scene(text, "yard.yaml")


@pytest.mark.parametrize("needs_frames", [False, True])
def test_a_kind_that_needs_frames_is_made_after_the_others(simulate, monkeypatch, *, needs_frames):
    monkeypatch.setitem(SENSORS, "sonar", replace(SONAR, needs_frames=needs_frames))
    simulation = simulate(scene=read_scene(f"{YARD}[{{type: sonar}}]", "yard.yaml"))
    (message, *_) = samples(simulation, TFMessage)
    frames = {one.child_frame_id for one in message.transforms}
    assert ("husky0/sonar" in frames) is not needs_frames


@pytest.mark.parametrize("settings", ["", ", wear: 0.05"])
def test_its_settings_may_disturb_the_encoders(simulate, settings):
    text = f"{YARD}[{{type: sonar{settings}}}]"
    (robot,) = simulate(scene=read_scene(text, "yard.yaml")).robots
    assert (robot.vehicles.noise > 0) is bool(settings)


@pytest.fixture
def node(bus_url):
    """A node on a bus of its own."""
    lcmtools.init([], url=bus_url)
    with lcmtools.Node("yard") as node:
        yield node
    lcmtools.shutdown()


def test_its_messages_are_published(simulate, node, wait_until):
    simulation = simulate(scene=read_scene(f"{YARD}[{{type: sonar}}]", "yard.yaml"))
    heard = []
    node.create_subscription(Range, "/husky0/sonar", heard.append)
    bridge = Bridge(node, simulation)

    def hears():
        bridge.receive()
        bridge.publish(simulation.step())
        return bool(heard)

    wait_until(hears)
    assert heard[0].range == pytest.approx(1.9, abs=TOLERANCE)
