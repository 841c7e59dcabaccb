"""Reading world files: strict YAML, with references to URDF and SDF files.

Keys and values that are unknown, missing, duplicate or out of range raise InvalidFile with file,
line and reason, in all modules here. No engine and no bus are known.
"""

from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import Annotated

from lcmtools.formats.typed import Item, Within, load, read
from lcmtools.names import check_base_name
from lcmtools_sim.scene import Ground, Scene
from lcmtools_sim.world_file.objects import read_objects, read_paths
from lcmtools_sim.world_file.robots import read_robots
from lcmtools_sim.world_file.sdf import read_sdf
from lcmtools_sim.world_file.values import checked_name

_PLAIN = Scene("")


@dataclass(frozen=True, slots=True)
class _World:
    node: Annotated[str, checked_name(check_base_name)] = _PLAIN.node
    seed: Annotated[int, Within(0, 2**63 - 1)] = _PLAIN.seed
    dt: Annotated[float, Within(1e-4, 0.02)] = _PLAIN.dt  # [s]
    gravity: Annotated[float, Within(0, 100)] = _PLAIN.gravity  # [m/s^2]
    ground: Ground = _PLAIN.ground
    objects: Item | None = None
    robots: Item | None = None
    paths: Item | None = None


def read_scene(text: str, source: str) -> Scene:
    """Read a world file's text; ``source`` is its name, for messages and for files beside it.

    It may also be a Gazebo world, see sdf.py. InvalidFile, with file and line, if it is wrong.
    """
    if text.lstrip("\ufeff \t\r\n").startswith("<"):
        return read_sdf(text, source)
    notes: list[str] = []
    world = read(_World, load(text, source, "world"))
    scene = Scene(
        name=PurePath(source).stem,
        node=world.node,
        seed=world.seed,
        dt=world.dt,
        gravity=world.gravity,
        ground=world.ground,
        objects=read_objects(world.objects, notes) if world.objects else (),
        robots=read_robots(world.robots, notes) if world.robots else (),
        paths=read_paths(world.paths) if world.paths else (),
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
