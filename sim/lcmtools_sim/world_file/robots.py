"""The entries of ``robots``: model, pose, and changes to the model and its sensors."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

from lcmtools.errors import InvalidName
from lcmtools.formats.typed import Item, Within, arguments, bounds, read
from lcmtools.names import check_legal, check_length, resolve, resolve_namespace
from lcmtools_sim.geometry import ORIGIN, Pose
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import CommandTopic, RobotModel
from lcmtools_sim.scene import RobotPlacement
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import SensorMount, Settings
from lcmtools_sim.world_file import values
from lcmtools_sim.world_file.urdf import read_urdf
from lcmtools_sim.world_file.urdf_robot import urdf_model


def _timeout(item: Item) -> float | None:
    return None if item.text() in ("none", "null", "~") else item.number(1e-3, 1e5)


@dataclass(frozen=True, slots=True)
class _Entry:
    model: Item
    namespace: Annotated[str, values.checked_name(resolve_namespace)]
    pose: Annotated[Pose, values.pose] = ORIGIN
    cmd_timeout: Annotated[float | None, _timeout] = None  # [s]
    sensors: Item | None = None
    topics: Item | None = None
    commands: Item | None = None
    drive: Item | None = None
    gazebo_quirks: bool = False
    skid: Item | None = None


@dataclass(frozen=True, slots=True)
class _Mount:
    type: str
    topic: str | None = None
    rate: Annotated[float, Within(1e-3, 1e4)] = 0.0  # [Hz]
    pose: Annotated[Pose, values.pose] = ORIGIN
    frame: Annotated[str, values.checked_name(check_legal)] = ""
    always: bool = False
    off: bool = False


def read_robots(item: Item, notes: list[str]) -> tuple[RobotPlacement, ...]:
    """Read all entries of ``robots``; ``notes`` gets notes on ignored content of their files."""
    robots: list[RobotPlacement] = []
    for element in item.items():
        robot = _robot(element, notes)
        if robot.namespace in [other.namespace for other in robots]:
            raise element.error(f"two robots have the namespace '{robot.namespace}'")
        robots.append(robot)
    return tuple(robots)


def _robot(item: Item, notes: list[str]) -> RobotPlacement:
    entry = read(_Entry, item)
    model = _model(entry, item, notes)
    _check_topics(model, entry, item)
    where = f"{item.source}:{item.line}"
    return RobotPlacement(model, entry.namespace, entry.pose, entry.cmd_timeout, where)


def _model(entry: _Entry, item: Item, notes: list[str]) -> RobotModel:
    model = _plain_model(entry, item, notes)
    if entry.gazebo_quirks:
        if model.gazebo_drive is None:
            raise item.field("gazebo_quirks").error(f"a {model.name} has no quirks in Gazebo")
        model = replace(model, drive=model.gazebo_drive)
    if entry.skid:
        skids = values.one_of(entry.skid, {"none": False, "coulomb": True}, "skid")
        if skids and not model.drive.wheels:
            raise entry.skid.error(f"a {model.name} has two wheels, which do not skid")
        model = replace(model, drive=replace(model.drive, skids=skids))
    if entry.sensors:
        model = replace(model, sensors=_read_sensors(entry.sensors, model.sensors))
    if entry.topics:
        model = replace(model, sensors=_renamed(entry.topics, model.sensors))
    if entry.commands:
        model = replace(model, commands=_commands(entry.commands))
    return model


def _plain_model(entry: _Entry, item: Item, notes: list[str]) -> RobotModel:
    """Return the model with a name, or from a URDF file."""
    path = entry.model.text()
    if "/" not in path and not path.endswith((".urdf", ".xacro")):
        if entry.drive:
            hint = "'drive' is for a model from a URDF file"
            raise entry.drive.error(f"a {path} has a drive already", hint)
        return values.one_of(entry.model, MODELS, "model")
    urdf = read_urdf(*values.named_file(entry.model))
    if not entry.drive:
        turning = [name for name, joint in urdf.joints.items() if joint.kind == "continuous"]
        hint = "name its wheels: drive: {left: [JOINT], right: [JOINT]}; joints that turn: "
        hint += ", ".join(turning) or "none"
        raise item.error("a model from a URDF file needs the key 'drive'", hint)
    model, more = urdf_model(urdf, entry.drive)
    notes += [note for note in more if note not in notes]
    return model


def _renamed(item: Item, mounts: Iterable[SensorMount]) -> tuple[SensorMount, ...]:
    """Return the sensors with other topics, given by their current ones."""
    topics = {mount.topic: mount for mount in mounts}
    named = item.fields(topics)
    return tuple(
        replace(mount, topic=named[topic].text()) if topic in named else mount
        for topic, mount in topics.items()
    )


def _commands(item: Item) -> tuple[CommandTopic, ...]:
    """Return the topics of its commands, each declared as Twist."""
    names = [name.text() for name in item.items()]
    if not names:
        raise item.error("'commands' is empty: nothing could steer the robot")
    if twice := values.given_twice(names):
        raise item.error(f"'{twice}' is given twice in 'commands'")
    return tuple(CommandTopic(name, is_twist=True) for name in names)


def _check_topics(model: RobotModel, entry: _Entry, item: Item) -> None:
    """Refuse topics that are illegal on the bus, and one topic for two uses."""
    sensors = entry.topics or entry.sensors or item
    commands = entry.commands or sensors
    names = [(mount.topic, sensors) for mount in model.sensors]
    names += [(command.name, commands) for command in model.commands]
    found: set[str] = set()
    for name, given in names:
        try:
            topic = check_length(resolve(name, entry.namespace), name)
        except InvalidName as error:
            raise given.error(error.what, error.hint) from None
        if topic in found:
            raise given.error(f"the topic '{topic}' is used twice", "give one another name")
        found.add(topic)


def _read_sensors(item: Item, mounted: Sequence[SensorMount]) -> tuple[SensorMount, ...]:
    """Return the sensors of a robot whose model has ``mounted`` sensors.

    An entry with the topic of one of the model's sensors changes it; any other adds a sensor.
    """
    mounts = {mount.topic: mount for mount in mounted}
    topics: set[str] = set()
    frames: dict[str, SensorMount] = {}
    for entry in item.items():
        kind = values.one_of(entry.field("type"), SENSORS, "sensor")
        given, own = arguments(entry, _Mount, kind.settings)
        topic = given.get("topic", kind.topic)
        if topic in topics:
            raise entry.error(f"two sensors have the topic '{topic}'", "give one another topic")
        topics.add(topic)
        usual = SensorMount(name := given.pop("type"), topic, kind.rate)
        changed = mounts.get(topic, usual)
        if given.pop("off", False):
            mounts.pop(topic, None)
            continue
        mount = replace(changed if changed.kind == name else usual, **given)
        settings = replace(kind.settings_of(mount), **own)
        _check_order(settings, {name: entry.field(name) for name in own})
        mounts[topic] = replace(mount, settings=settings)
        if "frame" in given:
            _check_frame(entry.field("frame"), mounts[topic], frames)
    return tuple(mounts.values())


def _check_frame(item: Item, mount: SensorMount, frames: dict[str, SensorMount]) -> None:
    """Refuse one frame name for two poses; optical frames also differ in orientation."""
    other = frames.setdefault(mount.frame, mount)
    is_optical, is_other_optical = (SENSORS[one.kind].is_optical for one in (mount, other))
    if other.pose != mount.pose or is_optical != is_other_optical:
        what = f"the frame '{mount.frame}' is that of '{other.topic}' too, which sits elsewhere"
        raise item.error(what, "give one another frame")


def _check_order(settings: Settings, given: Mapping[str, Item]) -> None:
    """Refuse a shortest range above the longest one, if one of them is given."""
    for high, within in bounds(type(settings)).items():
        low = within.above
        if item := given.get(low) or given.get(high):
            least, most = getattr(settings, low, -math.inf), getattr(settings, high)
            if least >= most:
                raise item.error(f"'{low}' ({least:g}) must be less than '{high}' ({most:g})")
