"""Hints for imports of message types from where they are not: lcmtools.types.geometry_msgs.msg."""

from lcmtools.messages.registry import shipped_types
from lcmtools.names import closest

_PARTS = ("msg", "srv")


def import_hint(module: str, name: str) -> str:
    """Return the import that was probably meant by a name that a module of lcmtools lacks."""
    source = shipped_types()
    names = [*source.fingerprints, *source.services]
    packages = sorted({one.partition("/")[0] for one in names})
    package = module.removeprefix(source.module).removesuffix(".msg").removesuffix(".srv")[1:]
    if module in ("lcmtools", source.module):
        near = [name] if name in packages else closest(name, packages)
        return f"write: from {source.module} import {near[0]}" if near else ""
    if package not in packages:
        return ""
    place, shorts = f"{source.module}.{package}", _names_in(package, names)
    if name in _PARTS:
        return f"here it is {place}"
    near = [name] if name in shorts else closest(name, shorts)
    return f"write: from {place} import {near[0]}" if near else f"it has {', '.join(shorts)}"


def _names_in(package: str, names: list[str]) -> list[str]:
    return sorted(one.partition("/")[2] for one in names if one.startswith(f"{package}/"))
