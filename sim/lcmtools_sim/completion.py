"""Shell completion of the simulator's arguments: worlds, engines and options.

``lcmtools``' completion finds this module by its name and calls ``complete``. Slow imports are not
allowed here: neither the parser nor pybullet.
"""

from collections.abc import Iterable, Sequence

from lcmtools_sim.worlds import world_names

_WORLD = ("--world", "--print-world")
_NAMED = ("--engine", *_WORLD)
_FILE = ("--check",)
_VALUE = ("--rate", "--seed", "--robots", "--robot", "--only", "--duration")
_FLAGS = ("--view", "--paused", "--follow", "--list-worlds", "--version", "--help")


def complete(before: Sequence[str], word: str) -> Iterable[str]:
    """Words that may follow the arguments ``before``; "" stands for files."""
    last = before[-1] if before else ""
    option, equals, _ = word.partition("=")
    if equals and option in _NAMED:
        return [f"{option}={name}" for name in _names(option)]
    if last in _FILE or (last in _WORLD and "/" in word):
        return [""]
    if last in _NAMED:
        return _names(last)
    if last in _VALUE:
        return []
    if word.startswith("-"):
        return [*_NAMED, *_FILE, *_VALUE, *_FLAGS]
    has_world = any(
        not one.startswith(("-", "_")) and ":=" not in one and option not in ("--engine", *_VALUE)
        for option, one in zip(("", *before), before, strict=False)
    )
    return [] if has_world else world_names()


def _names(option: str) -> Iterable[str]:
    return ("bullet", "mujoco") if option == "--engine" else world_names()
