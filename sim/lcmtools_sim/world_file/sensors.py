"""A robot's ``sensors``: those of its model, changed, and more of them.

An entry whose topic a sensor of the model has changes that one; any other adds a sensor.
"""

from collections.abc import Sequence
from dataclasses import fields, replace

from lcmtools.errors import InvalidName
from lcmtools.names import check_legal
from lcmtools_sim.sensors import SENSORS
from lcmtools_sim.sensors.mount import SensorMount, Settings
from lcmtools_sim.sensors.sensor import SensorKind
from lcmtools_sim.world_file.document import Item
from lcmtools_sim.world_file.values import one_of, pose, value

_ORDERED = (("shortest", "longest"), ("near", "far"))
_MOUNT_KEYS = ("type", "topic", "rate", "pose", "frame", "always", "off")


def read_sensors(item: Item, mounted: Sequence[SensorMount]) -> tuple[SensorMount, ...]:
    """The sensors of a robot whose model has ``mounted`` ones.

    Raises:
        InvalidFile: Anything is wrong with an entry, with file, line and reason.
    """
    mounts = {mount.topic: mount for mount in mounted}
    said: set[str] = set()
    frames: dict[str, SensorMount] = {}
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
            if "frame" in keys:
                _check_frame(keys["frame"], mounts[topic], frames)
    return tuple(mounts.values())


def _check_frame(item: Item, mount: SensorMount, frames: dict[str, SensorMount]) -> None:
    """Refuse one name for two places; a camera's frame looks another way than others do."""
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
        rate=value(keys, "rate", lambda item: item.number(1e-3, 1e4), known.rate),
        pose=value(keys, "pose", pose, known.pose),
        frame=value(keys, "frame", _frame, known.frame),
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
    _check_order(keys, known or kind.settings(), given)
    return replace(known or kind.settings(), **given)  # type: ignore[type-var] # a dataclass


def _check_order(keys: dict[str, Item], settings: Settings, given: dict[str, object]) -> None:
    """Refuse a shortest range above the longest one, and the like."""
    for low, high in _ORDERED:
        said = keys.get(low) or keys.get(high)
        if not said or low not in _setting_names(settings):
            continue
        least, most = (given.get(name, getattr(settings, name)) for name in (low, high))
        if least >= most:  # type: ignore[operator] # both are numbers
            raise said.error(f"'{low}' ({least:g}) must be less than '{high}' ({most:g})")


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
    return _setting_names(kind.settings) if kind.settings else []


def _setting_names(settings: Settings | type[Settings]) -> list[str]:
    return [setting.name for setting in fields(settings)]  # type: ignore[arg-type] # a dataclass


def _frame(item: Item) -> str:
    """A frame's name: of one part or several, without the robot's."""
    try:
        check_legal(item.text())
    except InvalidName as error:
        raise item.error(error.what, error.hint) from None
    return item.text()
