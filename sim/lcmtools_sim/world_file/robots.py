"""The entries of ``robots``: which model, where, and what is different about it."""

from dataclasses import replace

from lcmtools_sim.pose import ORIGIN
from lcmtools_sim.robots import MODELS
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.scene import RobotPlacement
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.sensors import read_sensors
from lcmtools_sim.world_file.values import namespace, one_of, pose, value

_ROBOT_KEYS = ("model", "namespace", "pose", "cmd_timeout", "sensors", "gazebo_quirks")


def read_robots(item: Item) -> tuple[RobotPlacement, ...]:
    """Everything that ``robots`` lists.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
    robots: list[RobotPlacement] = []
    for element in item.items():
        robot = read_robot(element)
        if robot.namespace in [other.namespace for other in robots]:
            raise element.error(f"two robots have the namespace '{robot.namespace}'")
        robots.append(robot)
    return tuple(robots)


def read_robot(item: Item) -> RobotPlacement:
    """One entry of ``robots``.

    Raises:
        InvalidFile: Anything is wrong with it, with file, line and reason.
    """
    keys = item.fields(_ROBOT_KEYS, required=["model", "namespace"])
    return RobotPlacement(
        model=_model(keys),
        namespace=namespace(keys["namespace"]),
        pose=value(keys, "pose", pose, ORIGIN),
        cmd_timeout=value(keys, "cmd_timeout", _timeout, None),
        where=f"{item.source}:{item.line}",
    )


def _model(keys: dict[str, Item]) -> RobotModel:
    """The model, with what the entry changes of it."""
    model = one_of(keys["model"], MODELS, "model")
    if value(keys, "gazebo_quirks", Item.flag, default=False):
        if model.gazebo_drive is None:
            raise keys["gazebo_quirks"].error(f"a {model.name} has no quirks in Gazebo")
        model = replace(model, drive=model.gazebo_drive)
    if "sensors" in keys:
        model = replace(model, sensors=read_sensors(keys["sensors"], model.sensors))
    return model


def _timeout(item: Item) -> float | None:
    return None if item.text() in ("none", "null", "~") else item.number(1e-3, 1e5)
