"""The worlds that come with the simulator, and finding a world by name or file."""

from importlib.resources import files
from pathlib import Path

from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean

ALIASES = {
    "lab_0123_world": "husky",
    "lab_0123_world.py": "husky",
    "pre_assignment2": "pioneer",
    "empty_world": "empty",
}
"""Names used in the labs' texts."""
_ENDINGS = (".yaml", ".yml", ".sdf", ".world")


def world_names() -> list[str]:
    """Return the names of the worlds that come with the simulator."""
    names = (entry.name for entry in files(__name__).iterdir())
    return sorted(name.removesuffix(".yaml") for name in names if name.endswith(".yaml"))


def describe(name: str) -> str:
    """Return the description of an included world: the comment in its first line."""
    return _packaged(name).partition("\n")[0].removeprefix("#").strip()


def find_world(world: str) -> tuple[str, str]:
    """Return a world file's text and its name for messages; UsageError for an unknown name.

    ``world`` is the name of an included world, or a file: a name with a slash or the ending .yaml,
    .yml, .sdf or .world; InvalidFile if that cannot be read.
    """
    if "/" in world or world.endswith(_ENDINGS):
        from lcmtools_sim.world_file.values import read_file

        return read_file(Path(world)), world
    name = ALIASES.get(world, world)
    if name not in world_names():
        hint = did_you_mean(world, [*world_names(), *ALIASES])
        hint = hint or f"worlds: {', '.join(world_names())}; or give a file, ./{world}.yaml"
        raise UsageError(f"there is no world '{world}'", hint)
    return _packaged(name), f"{name}.yaml"


def _packaged(name: str) -> str:
    return files(__name__).joinpath(f"{name}.yaml").read_text(encoding="utf-8")
