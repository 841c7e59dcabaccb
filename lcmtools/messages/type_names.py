"""The spellings of a type's name, and finding the known name for one.

Belongs here: names as text: spellings, near misses, the order of several. Must not know the sources
of types.
"""

import re
from collections.abc import Collection, Iterable

from lcmtools.errors import UnknownType

PREFERRED = (
    *(f"std_msgs/{name}" for name in ("Empty", "Bool", "Int8", "UInt8", "Int16", "Int32", "Int64")),
    *("std_msgs/Time", "builtin_interfaces/Time", "geometry_msgs/Vector3", "geometry_msgs/Twist"),
    *("geometry_msgs/TwistStamped", "geometry_msgs/TwistWithCovariance"),
    "geometry_msgs/TwistWithCovarianceStamped",
)
"""The type that a payload is assumed to have if several have its fingerprint: the one that robots
send most. Types that are not listed follow in alphabetical order."""

STUDENTS = ("air_lab0/",)
"""Packages of lcmtools that students make in the labs: theirs replace these without a warning."""

_MARKS = {"t", "lcmt", "msg", "msgs", "type"}
"""Words in the names of types that say nothing of their content: lcmt_iiwa_command, pose_t."""

_NAME = re.compile(r"(?:([\w.]+?)[/.](?:(?:msg|srv)[/.])?)?(\w+)", re.ASCII)


def find(name: str, known: Collection[str], kind: str) -> str | None:
    """Return the known name that ``name`` refers to; None if it is unknown.

    A known name in full means that type, even if others end in it.
    """
    if name in known:
        return name
    match = _NAME.fullmatch(name)
    if not match:
        return None
    package, short = match.groups()
    if package:
        full = f"{package}/{short}"
        return full if full in known else None
    found = sorted(full for full in known if full.rpartition("/")[2] == short)
    if len(found) > 1:
        raise UnknownType(f"several {kind}s are called '{name}'", f"write {' or '.join(found)}")
    return found[0] if found else None


def full_name(name: str) -> str:
    """Return a type's name in lcmtools' own spelling, if it has a package."""
    return re.sub(r"[/.](?:(?:msg|srv)[/.])?(?=\w+$)", "/", name, flags=re.ASCII)


def near_miss(name: str, known: Iterable[str]) -> str:
    """Return a hint with the known names most similar to a mistyped one; "" if there are none."""
    import difflib

    package, _, short = re.sub(r"[/.](msg|srv)(?=[/.])", "", name).replace(".", "/").rpartition("/")
    folded: dict[str, list[str]] = {}
    for full in known:
        folded.setdefault(full.rpartition("/")[2].lower(), []).append(full)
    close = difflib.get_close_matches(short.lower(), folded, n=1)
    if not close:
        return ""
    names = folded[close[0]]
    same_package = [full for full in names if full.startswith(f"{package}/")]
    return f"did you mean {' or '.join(sorted(set(same_package or names)))}?"


def preference(name: str) -> tuple[int, str]:
    """Return a sort key by which the likeliest name comes first."""
    return (PREFERRED.index(name) if name in PREFERRED else len(PREFERRED), name)


def resemblance(name: str, channel: str) -> tuple[float, float]:
    """Return the shares of words that a type has in common with a channel, 0 to 1.

    The first is that of the name without its package, the second of the whole name.
    """
    parts, other = (_words(name.rpartition("/")[2]), _words(name)), _words(channel)
    short, whole = (len(one & other) / len(one | other or {""}) for one in parts)
    return short, whole


def _words(name: str) -> set[str]:
    """Return the words of a name in small letters, without those that mark a type."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name, re.ASCII)
    return {part.lower() for part in parts} - _MARKS
