"""The type that was probably meant by a field of an unknown one, in a .lcm or a ROS file."""

from lcmtools.messages.fields import PRIMITIVES
from lcmtools.messages.type_source import Problem
from lcmtools.names import closest
from lcmtools.packages.lcm_parser import LcmField
from lcmtools.packages.placed_type import PlacedType

_LCM_NAMES = {
    "bool": "boolean",
    "str": "string",
    "int": "int32_t",
    "uint": "int32_t",
    **dict.fromkeys(("char", "uint8", "uint8_t"), "byte"),
    **dict.fromkeys(("float32", "float32_t"), "float"),
    **dict.fromkeys(("float64", "float64_t"), "double"),
    **{f"int{bits}": f"int{bits}_t" for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": f"int{bits}_t" for bits in (16, 32, 64)},
    **{f"uint{bits}_t": f"int{bits}_t" for bits in (16, 32, 64)},
}
"""Type names of C, Python and ROS, and LCM's names for them."""


_NEARLY_THE_SAME = 0.8  # similarity of two letters exchanged; point_t and int8_t have less


def unknown_type(one: PlacedType, field: LcmField, known: set[str]) -> Problem:
    """Return the problem for a type with a field of an unknown type."""
    missing = field.type
    short = missing.rpartition("/")[2]
    near = _LCM_NAMES.get(short) or _like_primitive(short) or _like(missing, one, known)
    same = missing.rpartition("/")[0] == one.name.rpartition("/")[0]
    written = short if same else missing.replace("/", ".")
    if one.file.package:
        written, near = written.replace(".", "/"), near.replace(".", "/")
    suffix = ".msg" if one.file.package else ".lcm"
    hint = f"did you mean {near}?" if near else f"name the folder of its {suffix} file too"
    what = f"{one.name}: unknown type '{written}'"
    return Problem(one.file.where, field.line, what, hint, one.name, (one.name,))


def _like(missing: str, one: PlacedType, known: set[str]) -> str:
    """Return the type that was probably meant, in .lcm notation; "" if none is similar."""
    package, _, short = missing.rpartition("/")
    shorts = {name.rpartition("/")[2]: name for name in sorted(known) if "/" in name or not package}
    inside = {name.rpartition("/")[2]: name for name in known if name.rpartition("/")[0] == package}
    if near := closest(short, inside):
        found = inside[near[0]]
    elif package == one.name.rpartition("/")[0]:  # written without a package
        found = next((shorts[name] for name in closest(short, shorts)), "")
    else:
        found = shorts.get(short) or next(iter(closest(missing, known)), "")
    return found.replace("/", ".")


def _like_primitive(name: str) -> str:
    """Return the primitive type of LCM that is misspelled; "" if none is."""
    from difflib import get_close_matches

    names = [*PRIMITIVES, *_LCM_NAMES] if name.islower() else []
    near = get_close_matches(name, names, 1, _NEARLY_THE_SAME)
    return _LCM_NAMES.get(near[0], near[0]) if near else ""
