"""Reading world files: strict YAML, with references to URDF and SDF files.

Keys and values that are unknown, missing, duplicate or out of range raise InvalidFile with file,
line and reason, in all modules here. No engine and no bus are known.
"""

from dataclasses import replace
from pathlib import PurePath

from lcmtools.names import check_base_name
from lcmtools_sim.scene import Ground, Scene
from lcmtools_sim.world_file.objects import read_objects
from lcmtools_sim.world_file.paths import read_paths
from lcmtools_sim.world_file.robots import read_robots
from lcmtools_sim.world_file.sdf import read_sdf
from lcmtools_sim.world_file.values import Item, checked_name, color, friction, load, number, value

_KEYS = ("node", "seed", "dt", "gravity", "ground", "objects", "robots", "paths")


def read_scene(text: str, source: str) -> Scene:
    """Read a world file's text; ``source`` is its name, for messages and for files beside it.

    It may also be a Gazebo world, see sdf.py. InvalidFile, with file and line, if it is wrong.
    """
    if text.lstrip("\ufeff \t\r\n").startswith("<"):
        return read_sdf(text, source)
    notes: list[str] = []
    keys = load(text, source, "world").fields(_KEYS)
    plain = Scene("")
    scene = Scene(
        name=PurePath(source).stem,
        node=value(keys, "node", checked_name(check_base_name), plain.node),
        seed=value(keys, "seed", lambda item: item.integer(0, 2**63 - 1), plain.seed),
        dt=value(keys, "dt", number(1e-4, 0.02), plain.dt),
        gravity=value(keys, "gravity", number(0, 100), plain.gravity),
        ground=value(keys, "ground", _ground, plain.ground),
        objects=value(keys, "objects", lambda item: read_objects(item, notes), ()),
        robots=value(keys, "robots", lambda item: read_robots(item, notes), ()),
        paths=value(keys, "paths", read_paths, ()),
    )
    return replace(scene, notes=(*notes, *_too_fast(scene)))


def _too_fast(scene: Scene) -> list[str]:
    """Return notes on sensors with a higher rate than the steps."""
    steps = 1 / scene.dt
    return [
        f"{robot.where}: {mount.topic} of {robot.namespace} cannot have {mount.rate:g} Hz: there"
        f" are {steps:g} steps a second"
        for robot in scene.robots
        for mount in robot.model.sensors
        if mount.rate > steps * (1 + 1e-9)
    ]


def _ground(item: Item) -> Ground:
    keys = item.fields(("friction", "color"))
    return Ground(
        friction=value(keys, "friction", friction, Ground().friction),
        color=value(keys, "color", color, Ground().color),
    )
