"""Shell completion of the simulator's arguments: worlds and options.

``lcmtools``' completion finds this module by its name and calls ``complete``; nothing here may be
slow to import: neither the parser nor pybullet.
"""

from collections.abc import Iterable, Sequence

from lcmtools_sim.worlds import world_names

_WORLD = ("--world", "--print-world")
_FILE = ("--check",)
_VALUE = ("--rate", "--seed", "--robots", "--robot", "--only", "--duration")
_FLAGS = ("--view", "--paused", "--follow", "--list-worlds", "--help")


def complete(before: Sequence[str], word: str) -> Iterable[str]:
    """Words that may follow the arguments ``before``; "" stands for files."""
    last = before[-1] if before else ""
    option, equals, _ = word.partition("=")
    if equals and option in _WORLD:
        return [f"{option}={name}" for name in world_names()]
    if last in _WORLD:
        return world_names() if "/" not in word else [""]
    if last in _FILE:
        return [""]
    if last in _VALUE:
        return []
    if word.startswith("-"):
        return [*_WORLD, *_FILE, *_VALUE, *_FLAGS]
    has_world = any(not one.startswith(("-", "_")) and ":=" not in one for one in before)
    return [] if has_world else world_names()
