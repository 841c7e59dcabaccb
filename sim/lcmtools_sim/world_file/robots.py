"""The entries of ``robots``: model, pose, and changes to the model and its sensors."""

from collections.abc import Iterable, Sequence
from dataclasses import Field, fields, replace

from lcmtools.errors import InvalidName
from lcmtools.names import check_legal, check_length, resolve, resolve_namespace
from lcmtools_sim.geometry import ORIGIN
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import CommandTopic, RobotModel
from lcmtools_sim.scene import RobotPlacement
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import SensorKind, SensorMount, Settings
from lcmtools_sim.world_file import values
from lcmtools_sim.world_file.urdf import read_urdf
from lcmtools_sim.world_file.urdf_robot import urdf_model
from lcmtools_sim.world_file.values import Item, value

_ROBOT_KEYS = (
    *("model", "namespace", "pose", "cmd_timeout", "sensors", "topics", "commands", "drive"),
    *("gazebo_quirks", "skid"),
)
_MOUNT_KEYS = ("type", "topic", "rate", "pose", "frame", "always", "off")


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
    keys = item.fields(_ROBOT_KEYS, required=["model", "namespace"])
    model = _model(keys, item, notes)
    namespace = values.checked_name(resolve_namespace)(keys["namespace"])
    _check_topics(model, namespace, keys, item)
    return RobotPlacement(
        model=model,
        namespace=namespace,
        pose=value(keys, "pose", values.pose, ORIGIN),
        cmd_timeout=value(keys, "cmd_timeout", _timeout, None),
        where=f"{item.source}:{item.line}",
    )


def _model(keys: dict[str, Item], item: Item, notes: list[str]) -> RobotModel:
    model = _plain_model(keys, item, notes)
    if value(keys, "gazebo_quirks", Item.flag, default=False):
        if model.gazebo_drive is None:
            raise keys["gazebo_quirks"].error(f"a {model.name} has no quirks in Gazebo")
        model = replace(model, drive=model.gazebo_drive)
    if "skid" in keys:
        skids = values.one_of(keys["skid"], {"none": False, "coulomb": True}, "skid")
        if skids and not model.drive.wheels:
            raise keys["skid"].error(f"a {model.name} has two wheels, which do not skid")
        model = replace(model, drive=replace(model.drive, skids=skids))
    if "sensors" in keys:
        model = replace(model, sensors=_read_sensors(keys["sensors"], model.sensors))
    if "topics" in keys:
        model = replace(model, sensors=_renamed(keys["topics"], model.sensors))
    if "commands" in keys:
        model = replace(model, commands=_commands(keys["commands"]))
    return model


def _plain_model(keys: dict[str, Item], item: Item, notes: list[str]) -> RobotModel:
    """Return the model with a name, or from a URDF file."""
    path = keys["model"].text()
    if "/" not in path and not path.endswith((".urdf", ".xacro")):
        if "drive" in keys:
            hint = "'drive' is for a model from a URDF file"
            raise keys["drive"].error(f"a {path} has a drive already", hint)
        return values.one_of(keys["model"], MODELS, "model")
    urdf = read_urdf(*values.named_file(keys["model"]))
    if "drive" not in keys:
        turning = [name for name, joint in urdf.joints.items() if joint.kind == "continuous"]
        hint = "name its wheels: drive: {left: [JOINT], right: [JOINT]}; joints that turn: "
        hint += ", ".join(turning) or "none"
        raise item.error("a model from a URDF file needs the key 'drive'", hint)
    model, more = urdf_model(urdf, keys["drive"])
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


def _check_topics(model: RobotModel, namespace: str, keys: dict[str, Item], item: Item) -> None:
    """Refuse topics that are illegal on the bus, and one topic for two uses."""
    sensors = keys.get("topics") or keys.get("sensors") or item
    commands = keys.get("commands") or sensors
    names = [(mount.topic, sensors) for mount in model.sensors]
    names += [(command.name, commands) for command in model.commands]
    found: set[str] = set()
    for name, given in names:
        try:
            topic = check_length(resolve(name, namespace), name)
        except InvalidName as error:
            raise given.error(error.what, error.hint) from None
        if topic in found:
            raise given.error(f"the topic '{topic}' is used twice", "give one another name")
        found.add(topic)


def _timeout(item: Item) -> float | None:
    return None if item.text() in ("none", "null", "~") else item.number(1e-3, 1e5)


def _read_sensors(item: Item, mounted: Sequence[SensorMount]) -> tuple[SensorMount, ...]:
    """Return the sensors of a robot whose model has ``mounted`` sensors.

    An entry with the topic of one of the model's sensors changes it; any other adds a sensor.
    """
    mounts = {mount.topic: mount for mount in mounted}
    topics: set[str] = set()
    frames: dict[str, SensorMount] = {}
    for entry in item.items():
        kind = values.one_of(entry.field("type"), SENSORS, "sensor")
        keys = entry.fields((*_MOUNT_KEYS, *(one.name for one in fields(kind.settings))))
        topic = value(keys, "topic", Item.text, kind.topic)
        if topic in topics:
            raise entry.error(f"two sensors have the topic '{topic}'", "give one another topic")
        topics.add(topic)
        name = keys["type"].text()
        usual = SensorMount(name, topic, kind.rate)
        changed = mounts.get(topic, usual)
        if value(keys, "off", Item.flag, default=False):
            mounts.pop(topic, None)
        else:
            mounts[topic] = _mount(keys, kind, changed if changed.kind == name else usual)
            if "frame" in keys:
                _check_frame(keys["frame"], mounts[topic], frames)
    return tuple(mounts.values())


def _check_frame(item: Item, mount: SensorMount, frames: dict[str, SensorMount]) -> None:
    """Refuse one frame name for two poses; optical frames also differ in orientation."""
    other = frames.setdefault(mount.frame, mount)
    is_optical, is_other_optical = (SENSORS[one.kind].is_optical for one in (mount, other))
    if other.pose != mount.pose or is_optical != is_other_optical:
        what = f"the frame '{mount.frame}' is that of '{other.topic}' too, which sits elsewhere"
        raise item.error(what, "give one another frame")


def _mount(keys: dict[str, Item], kind: SensorKind, mount: SensorMount) -> SensorMount:
    return replace(
        mount,
        rate=value(keys, "rate", values.number(1e-3, 1e4), mount.rate),
        pose=value(keys, "pose", values.pose, mount.pose),
        frame=value(keys, "frame", values.checked_name(check_legal), mount.frame),
        always=value(keys, "always", Item.flag, mount.always),
        settings=_settings(keys, kind.settings_of(mount)),
    )


def _settings(keys: dict[str, Item], settings: Settings) -> Settings:
    given = {
        setting.name: _setting(keys[setting.name], setting)
        for setting in fields(settings)
        if setting.name in keys
    }
    changed = replace(settings, **given)
    for setting in fields(changed):  # a shortest range must not be above the longest one
        low, high = setting.metadata["above"], setting.name
        item = keys.get(low) or keys.get(high)
        if low and item:
            least, most = getattr(changed, low), getattr(changed, high)
            if least >= most:
                raise item.error(f"'{low}' ({least:g}) must be less than '{high}' ({most:g})")
    return changed


def _setting(item: Item, setting: Field[float]) -> float:
    """Read one setting, with its default's type; see ``number`` in sensors.sensor."""
    lowest, highest = setting.metadata["lowest"], setting.metadata["highest"]
    if isinstance(setting.default, int):
        return item.integer(lowest, highest)
    read = item.angle if setting.metadata["angle"] else item.number
    return read(lowest, highest)
