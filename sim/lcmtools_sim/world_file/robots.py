"""The entries of ``robots``: model, place, and changes of the model."""

from collections.abc import Iterable
from dataclasses import replace

from lcmtools.errors import InvalidName
from lcmtools.names import check_length, resolve, resolve_namespace
from lcmtools_sim.geometry import ORIGIN
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import CommandTopic, RobotModel
from lcmtools_sim.scene import RobotPlacement
from lcmtools_sim.sensors.sensor import SensorMount
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.sensors import read_sensors
from lcmtools_sim.world_file.urdf import read_urdf
from lcmtools_sim.world_file.urdf_robot import urdf_model
from lcmtools_sim.world_file.values import (
    checked_name,
    given_twice,
    named_file,
    one_of,
    pose,
    value,
)

_ROBOT_KEYS = (
    *("model", "namespace", "pose", "cmd_timeout", "sensors", "topics", "commands", "drive"),
    *("gazebo_quirks", "skid"),
)


def read_robots(item: Item, notes: list[str]) -> tuple[RobotPlacement, ...]:
    """All entries of ``robots``; notes on ignored content of their files are added to ``notes``.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
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
    namespace = checked_name(resolve_namespace)(keys["namespace"])
    _check_topics(model, namespace, keys, item)
    return RobotPlacement(
        model=model,
        namespace=namespace,
        pose=value(keys, "pose", pose, ORIGIN),
        cmd_timeout=value(keys, "cmd_timeout", _timeout, None),
        where=f"{item.source}:{item.line}",
    )


def _model(keys: dict[str, Item], item: Item, notes: list[str]) -> RobotModel:
    """The model with the entry's changes."""
    model = _plain_model(keys, item, notes)
    if value(keys, "gazebo_quirks", Item.flag, default=False):
        if model.gazebo_drive is None:
            raise keys["gazebo_quirks"].error(f"a {model.name} has no quirks in Gazebo")
        model = replace(model, drive=model.gazebo_drive)
    if "skid" in keys:
        skids = one_of(keys["skid"], {"none": False, "coulomb": True}, "skid")
        if skids and not model.drive.wheels:
            raise keys["skid"].error(f"a {model.name} has two wheels, which do not skid")
        model = replace(model, drive=replace(model.drive, skids=skids))
    if "sensors" in keys:
        model = replace(model, sensors=read_sensors(keys["sensors"], model.sensors))
    if "topics" in keys:
        model = replace(model, sensors=_renamed(keys["topics"], model.sensors))
    if "commands" in keys:
        model = replace(model, commands=_commands(keys["commands"]))
    return model


def _plain_model(keys: dict[str, Item], item: Item, notes: list[str]) -> RobotModel:
    """The model with a name, or of a URDF file."""
    path = keys["model"].text()
    if "/" not in path and not path.endswith((".urdf", ".xacro")):
        if "drive" in keys:
            raise keys["drive"].error(
                f"a {path} has a drive already", "'drive' is for a model from a URDF file"
            )
        return one_of(keys["model"], MODELS, "model")
    urdf = read_urdf(*named_file(keys["model"]))
    if "drive" not in keys:
        turning = [name for name, joint in urdf.joints.items() if joint.kind == "continuous"]
        raise item.error(
            "a model from a URDF file needs the key 'drive'",
            "name its wheels: drive: {left: [JOINT], right: [JOINT]}; joints that turn:"
            f" {', '.join(turning) or 'none'}",
        )
    model, more = urdf_model(urdf, keys["drive"])
    notes += [note for note in more if note not in notes]
    return model


def _renamed(item: Item, mounts: Iterable[SensorMount]) -> tuple[SensorMount, ...]:
    """The sensors with other topics, by their present ones."""
    topics = {mount.topic: mount for mount in mounts}
    named = item.fields(topics)
    return tuple(
        replace(mount, topic=named[topic].text()) if topic in named else mount
        for topic, mount in topics.items()
    )


def _commands(item: Item) -> tuple[CommandTopic, ...]:
    """The topics of its commands, each declared as Twist."""
    names = [name.text() for name in item.items()]
    if not names:
        raise item.error("'commands' is empty: nothing could steer the robot")
    if twice := given_twice(names):
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
