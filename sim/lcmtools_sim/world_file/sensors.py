"""A robot's ``sensors``: those of its model, changed, and more of them.

An entry whose topic a sensor of the model has changes that one; any other adds a sensor.
"""

from collections.abc import Sequence
from dataclasses import fields, replace

from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import SensorKind
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.values import one_of, pose, value

_MOUNT_KEYS = ("type", "topic", "rate", "pose", "frame", "always", "off")


def read_sensors(item: Item, mounted: Sequence[SensorMount]) -> tuple[SensorMount, ...]:
    """The sensors of a robot whose model has ``mounted`` ones.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
    mounts = {mount.topic: mount for mount in mounted}
    said: set[str] = set()
    for entry in item.items():
        kind = one_of(entry.field("type"), SENSORS, "sensor")
        keys = entry.fields((*_MOUNT_KEYS, *_names(kind)))
        topic = value(keys, "topic", Item.text, kind.topic)
        if topic in said:
            raise entry.error(f"two sensors have the topic '{topic}'", "give one another topic")
        said.add(topic)
        name = keys["type"].text()
        usual = SensorMount(name, topic, kind.rate)
        known = mounts.get(topic, usual)
        if value(keys, "off", Item.flag, default=False):
            mounts.pop(topic, None)
        else:
            mounts[topic] = _mount(keys, kind, known if known.kind == name else usual)
    return tuple(mounts.values())


def _mount(keys: dict[str, Item], kind: SensorKind, known: SensorMount) -> SensorMount:
    return replace(
        known,
        rate=value(keys, "rate", lambda item: item.number(1e-3, 1e4), known.rate),
        pose=value(keys, "pose", pose, known.pose),
        frame=value(keys, "frame", Item.text, known.frame),
        always=value(keys, "always", Item.flag, known.always),
        settings=_settings(keys, kind, known.settings),
    )


def _settings(keys: dict[str, Item], kind: SensorKind, known: Settings | None) -> Settings | None:
    """The kind's settings with those fields that are given; see sensors.settings."""
    if kind.settings is None:
        return None
    given: dict[str, object] = {}
    for setting in fields(kind.settings):  # type: ignore[arg-type] # each is a dataclass
        if setting.name in keys:
            given[setting.name] = _setting(keys[setting.name], setting.default, **setting.metadata)
    return replace(known or kind.settings(), **given)  # type: ignore[type-var] # a dataclass


def _setting(
    item: Item, default: object, lowest: float = 0.0, highest: float = 0.0, *, angle: bool = False
) -> object:
    """One setting, of the kind of its default."""
    if isinstance(default, bool):
        return item.flag()
    if isinstance(default, int):
        return item.integer(int(lowest), int(highest))
    if isinstance(default, str):
        return item.text()
    return item.angle(lowest, highest) if angle else item.number(lowest, highest)


def _names(kind: SensorKind) -> list[str]:
    return [setting.name for setting in fields(kind.settings)] if kind.settings else []  # type: ignore[arg-type]
