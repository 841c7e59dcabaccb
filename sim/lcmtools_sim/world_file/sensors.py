"""A robot's ``sensors``: those of its model, changed, and additional ones.

An entry with the topic of a sensor of the model changes that one; any other adds a sensor.
"""

from collections.abc import Sequence
from dataclasses import Field, fields, replace

from lcmtools.names import check_legal
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.sensor import SensorKind, SensorMount, Settings
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.values import checked_name, number, one_of, pose, value

_ORDERED = (("shortest", "longest"), ("near", "far"))
_MOUNT_KEYS = ("type", "topic", "rate", "pose", "frame", "always", "off")


def read_sensors(item: Item, mounted: Sequence[SensorMount]) -> tuple[SensorMount, ...]:
    """The sensors of a robot whose model has ``mounted`` ones.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
    mounts = {mount.topic: mount for mount in mounted}
    topics: set[str] = set()
    frames: dict[str, SensorMount] = {}
    for entry in item.items():
        kind = one_of(entry.field("type"), SENSORS, "sensor")
        keys = entry.fields((*_MOUNT_KEYS, *_setting_names(kind.settings)))
        topic = value(keys, "topic", Item.text, kind.topic)
        if topic in topics:
            raise entry.error(f"two sensors have the topic '{topic}'", "give one another topic")
        topics.add(topic)
        name = keys["type"].text()
        usual = SensorMount(name, topic, kind.rate)
        known = mounts.get(topic, usual)
        if value(keys, "off", Item.flag, default=False):
            mounts.pop(topic, None)
        else:
            mounts[topic] = _mount(keys, kind, known if known.kind == name else usual)
            if "frame" in keys:
                _check_frame(keys["frame"], mounts[topic], frames)
    return tuple(mounts.values())


def _check_frame(item: Item, mount: SensorMount, frames: dict[str, SensorMount]) -> None:
    """Refuse one name for two poses; a camera's frame has another orientation than others."""
    other = frames.setdefault(mount.frame, mount)
    is_camera, is_other_camera = ("camera" in each.kind for each in (mount, other))
    if other.pose != mount.pose or is_camera != is_other_camera:
        raise item.error(
            f"the frame '{mount.frame}' is that of '{other.topic}' too, which sits elsewhere",
            "give one another frame",
        )


def _mount(keys: dict[str, Item], kind: SensorKind, known: SensorMount) -> SensorMount:
    return replace(
        known,
        rate=value(keys, "rate", number(1e-3, 1e4), known.rate),
        pose=value(keys, "pose", pose, known.pose),
        frame=value(keys, "frame", checked_name(_frame), known.frame),
        always=value(keys, "always", Item.flag, known.always),
        settings=_settings(keys, kind, known.settings),
    )


def _settings(keys: dict[str, Item], kind: SensorKind, known: Settings | None) -> Settings | None:
    """The kind's settings with the given fields."""
    if kind.settings is None:
        return None
    settings, given = known or kind.settings(), {}
    for setting in fields(settings):  # type: ignore[arg-type] # each is a dataclass
        if setting.name in keys:
            given[setting.name] = _setting(keys[setting.name], setting)
    changed = replace(settings, **given)  # type: ignore[type-var] # a dataclass
    _check_order(keys, changed)
    return changed


def _check_order(keys: dict[str, Item], settings: Settings) -> None:
    """Refuse a shortest range above the longest one, and the like."""
    for low, high in _ORDERED:
        given = keys.get(low) or keys.get(high)
        if given and hasattr(settings, low):
            least, most = getattr(settings, low), getattr(settings, high)
            if least >= most:
                raise given.error(f"'{low}' ({least:g}) must be less than '{high}' ({most:g})")


def _setting(item: Item, setting: Field[float]) -> float:
    """One setting, of the type of its default; see ``number`` in sensors.sensor."""
    lowest, highest = setting.metadata["lowest"], setting.metadata["highest"]
    if isinstance(setting.default, int):
        return item.integer(lowest, highest)
    read = item.angle if setting.metadata["angle"] else item.number
    return read(lowest, highest)


def _setting_names(settings: type[Settings] | None) -> list[str]:
    return [one.name for one in fields(settings)] if settings else []  # type: ignore[arg-type]


def _frame(text: str) -> str:
    """A frame's name, of one part or several, without the robot's."""
    check_legal(text)
    return text
