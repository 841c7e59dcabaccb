"""Physics engines behind one protocol (engine.py), and the choice between them."""

import os
import platform
import sys
from importlib.util import find_spec

from lcmtools.errors import MissingExtra, UsageError, extra_hint
from lcmtools.names import did_you_mean
from lcmtools_sim.engines.engine import Engine
from lcmtools_sim.engines.native import suppressed_output

ENGINES = ("bullet", "mujoco")  # in order of preference
VARIABLE = "LCMTOOLS_ENGINE"

_PACKAGES = {"bullet": "pybullet", "mujoco": "mujoco"}
_HINT = extra_hint("sim")


def chosen_engine(wanted: str = "") -> str:
    """Return the engine to use: ``wanted``, $LCMTOOLS_ENGINE, or the first one installed.

    Imports nothing. UsageError for an unknown name; MissingExtra without it, numpy or Pillow.
    """
    name, source = wanted or os.environ.get(VARIABLE, ""), "--engine" if wanted else VARIABLE
    if name and name not in ENGINES:
        hint = did_you_mean(name, ENGINES) or f"engines: {', '.join(ENGINES)}"
        raise UsageError(f"{source}: unknown engine '{name}'", hint)
    there = [*filter(is_installed, ENGINES)]
    if not there or not find_spec("PIL"):
        raise MissingExtra("the simulator needs numpy, pillow, and pybullet or mujoco", _HINT)
    if name and name not in there:
        way = f"type: pip install {_PACKAGES[name]}; or"
        if name == "bullet" and not _has_bullet_wheel():
            way = "pybullet has wheels for Python 3.10 and 3.11 on Linux x86_64 only;"
        hint = f"{way} take {there[0]}"
        raise MissingExtra(f"{source}: the engine {name} is not installed", hint)
    return name or there[0]


def _has_bullet_wheel() -> bool:
    """Return whether pybullet has a wheel for this system, by the markers of the extra ``sim``."""
    is_usual = sys.platform == "linux" and platform.machine() == "x86_64"
    return is_usual and sys.version_info < (3, 12)


def is_installed(name: str) -> bool:
    """Return whether an engine's package is installed, without importing it."""
    return find_spec(_PACKAGES[name]) is not None


def engine_version(name: str) -> str:
    """Return an engine's name and version, as text ("pybullet 3.2.7")."""
    from importlib.metadata import PackageNotFoundError, version

    package = _PACKAGES[name]
    try:
        return f"{package} {version(package)}"
    except PackageNotFoundError:
        return f"{package} {version(f'{package}-core')}"  # MuJoCo's engine only


def start_engine(name: str) -> Engine:
    """Return an empty world of an engine; MissingExtra if it is not installed."""
    try:
        if name == "bullet":
            with suppressed_output():  # the import prints a line
                from lcmtools_sim.engines.bullet import Bullet
            return Bullet()
        from lcmtools_sim.engines.mujoco import Mujoco
    except ImportError as error:
        raise MissingExtra(f"the engine {name} cannot be imported: {error}", _HINT) from None
    return Mujoco()
