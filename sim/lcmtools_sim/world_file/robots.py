"""The entries of ``robots``: which model, where, and what is different about it."""

from collections.abc import Iterable
from dataclasses import replace

from lcmtools.errors import InvalidName
from lcmtools.names import check_length, resolve
from lcmtools_sim.pose import ORIGIN
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import CommandTopic, RobotModel
from lcmtools_sim.scene import RobotPlacement
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.sensors import read_sensors
from lcmtools_sim.world_file.urdf import read_urdf
from lcmtools_sim.world_file.urdf_robot import urdf_model
from lcmtools_sim.world_file.values import named_file, namespace, one_of, pose, value

_ROBOT_KEYS = (
    "model",
    "namespace",
    "pose",
    "cmd_timeout",
    "sensors",
    "topics",
    "commands",
    "drive",
    "gazebo_quirks",
    "skid",
)


def read_robots(item: Item, notes: list[str]) -> tuple[RobotPlacement, ...]:
    """Everything that ``robots`` lists; ``notes`` gets what was left out of their files.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
    robots: list[RobotPlacement] = []
    for element in item.items():
        robot = read_robot(element, notes)
        if robot.namespace in [other.namespace for other in robots]:
            raise element.error(f"two robots have the namespace '{robot.namespace}'")
        robots.append(robot)
    return tuple(robots)


def read_robot(item: Item, notes: list[str]) -> RobotPlacement:
    """One entry of ``robots``.

    Raises:
        InvalidFile: Anything is wrong with it, with file, line and reason.
    """
    keys = item.fields(_ROBOT_KEYS, required=["model", "namespace"])
    model, where = _model(keys, item, notes), namespace(keys["namespace"])
    _check_topics(model, where, keys, item)
    return RobotPlacement(
        model=model,
        namespace=where,
        pose=value(keys, "pose", pose, ORIGIN),
        cmd_timeout=value(keys, "cmd_timeout", _timeout, None),
        where=f"{item.source}:{item.line}",
    )


def _model(keys: dict[str, Item], item: Item, notes: list[str]) -> RobotModel:
    """The model, with what the entry changes of it."""
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
    """The model that is named, or described by a URDF file."""
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
    """The sensors with other topics: those that they have now are the keys."""
    topics = {mount.topic: mount for mount in mounts}
    named = item.fields(topics)
    return tuple(
        replace(mount, topic=named[topic].text()) if topic in named else mount
        for topic, mount in topics.items()
    )


def _commands(item: Item) -> tuple[CommandTopic, ...]:
    """The topics that steer it, each declared as one of Twists."""
    names = [name.text() for name in item.items()]
    if not names:
        raise item.error("'commands' is empty: nothing could steer the robot")
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise item.error(f"'{twice}' is given twice in 'commands'")
    return tuple(CommandTopic(name, is_twist=True) for name in names)


def _check_topics(model: RobotModel, where: str, keys: dict[str, Item], item: Item) -> None:
    """Refuse topics that the bus could not carry, and two sensors or a command on one.

    Raises:
        InvalidFile: Naming the topic.
    """
    sensors = keys.get("topics") or keys.get("sensors") or item
    commands = keys.get("commands") or sensors
    names = [(mount.topic, sensors) for mount in model.sensors]
    names += [(command.name, commands) for command in model.commands]
    found: set[str] = set()
    for name, said in names:
        try:
            topic = check_length(resolve(name, where), name)
        except InvalidName as error:
            raise said.error(error.what, error.hint) from None
        if topic in found:
            raise said.error(f"the topic '{topic}' is used twice", "give one another name")
        found.add(topic)


def _timeout(item: Item) -> float | None:
    return None if item.text() in ("none", "null", "~") else item.number(1e-3, 1e5)
