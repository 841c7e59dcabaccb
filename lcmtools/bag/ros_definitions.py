"""The definitions of types in bags, and their translation for LCM.

A translated type is a .msg file that LCM can express: unsigned numbers become signed ones of the
next larger type (of uint64 there is none larger), and a field named like the length of an array
gets another name. Its comments keep ROS's own lines, of which ``original_text`` makes the
definition again.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, TypeAlias

from lcmtools.bag.ros_reading import Channel
from lcmtools.errors import InvalidFile
from lcmtools.folders import LARGEST
from lcmtools.packages.ros_files import to_lcm

RosVersion: TypeAlias = Literal[1, 2]
Definitions: TypeAlias = Mapping[str, Any]  # as in rosbags: constants and fields by type's name
FILLER = "structure_needs_at_least_one_member"  # rosbags' field in a type without fields

_MOST_VALUES = 5000  # of a type: rosbags takes seconds for so many
_DEEPEST = 100
_MARK = "  # ROS: "
_LARGER = {"uint16": "int32", "uint32": "int64", "uint64": "int64", "octet": "uint8"}
_TIMES = {"builtin_interfaces/msg/Time": "time", "builtin_interfaces/msg/Duration": "duration"}
_KINDS: dict[str, RosVersion] = {"ros1msg": 1, "ros2msg": 2, "ros2idl": 2, "omgidl": 2}
NO_FORM = ("", "unknown")  # as ROS 2 writes for a type that it does not find
_IDL_SEPARATOR = "=" * 80 + "\nIDL: "


def ros_version(channel: Channel) -> RosVersion:
    """Return the version of ROS whose types a channel's definition uses."""
    return _KINDS.get(channel.form, 1 if channel.encoding == "ros1" else 2)


def read_definition(channel: Channel, known: Definitions) -> tuple[str, Definitions]:
    """Return the name of a channel's type in rosbags' spelling, and its definition.

    Types that the definition uses and does not have are those of ROS, ``known``.

    Raises:
        InvalidFile: It cannot be read, or there is none.
    """
    name = normal_name(channel.type)
    if channel.form not in (*_KINDS, *NO_FORM):
        raise InvalidFile(f"its definition is in {channel.form}, not in a format of ROS")
    if name in known and not channel.definition.strip():
        return name, _with_known(name, {}, known)
    if channel.form in NO_FORM:
        raise InvalidFile("the bag has no definition of it, and LCMTOOLS_TYPE_PATH leads to none")
    if len(channel.definition) > LARGEST:
        raise InvalidFile(f"its definition has more than {LARGEST} characters")
    try:
        found = _parsed(channel)
    except Exception as error:  # the library's parser may raise any
        raise InvalidFile("its definition cannot be read") from error
    if name not in found:
        name = next(iter(found))
    return name, _with_known(name, found, known)


def normal_name(name: str) -> str:
    """Return a type's name in rosbags' spelling: "std_msgs/msg/String"."""
    package, _, short = name.rpartition("/")
    return name if package.endswith(("/msg", "/action")) else f"{package}/msg/{short}"


def lcm_name(name: str) -> str:
    """Return the name of the LCM type for a ROS type: "std_msgs/String"."""
    return "/".join(part for part in name.split("/") if part not in ("msg", "srv", "action"))


def parts(name: str, known: Definitions) -> Iterator[str]:
    """Yield a type and the types of its fields."""
    yield name
    for nested in nested_types(known[name]):
        yield from parts(nested, known)


def translated(name: str, known: Definitions, version: RosVersion) -> str:
    """Return a type as the text of a .msg file that LCM can express."""
    constants, fields = known[name]
    lines = [f"{_base_text(kind, 0)} {constant}={value}" for constant, kind, value in constants]
    for problem in to_lcm(Path("A.msg"), "\n".join(lines).encode(), "a").problems:
        lines[problem.line - 1] = _MARK.lstrip() + lines[problem.line - 1]
    names = renamed_fields(fields)
    for field, described in fields:
        if field != FILLER:
            line = f"{_type_text(described)} {field}"
            ours = f"{_lcm_type_text(described, version)} {names.get(field, field)}"
            lines.append(ours if ours == line else f"{ours}{_MARK}{line}")
    return "\n".join([*lines, ""])


def renamed_fields(described: Iterable[tuple[str, Any]]) -> dict[str, str]:
    """Return the fields of a ROS type that are named like an array's length, with other names."""
    from rosbags.interfaces import Nodetype

    kinds = {name: kind for name, (kind, _) in described}
    lengths = {f"{name}_length" for name, kind in kinds.items() if kind == Nodetype.SEQUENCE}
    found: dict[str, str] = {}
    for name in (one for one in kinds if one in lengths):
        ours = f"{name}_"
        while ours in kinds or ours in lengths or ours in found.values():
            ours += "_"
        found[name] = ours
    return found


def original_text(text: str) -> str:
    """Return the definition of which a translated text was made."""
    return re.sub(rf"(?m)^.*{re.escape(_MARK.lstrip())}", "", text)


def _parsed(channel: Channel) -> Definitions:
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    if channel.form.endswith("msg"):
        return get_types_from_msg(channel.definition, normal_name(channel.type))
    texts = channel.definition.split(_IDL_SEPARATOR)
    if len(texts) > 1:  # each has its name on its first line
        texts = [one.partition("\n")[2] for one in texts[1:]]
    return {name: one for text in texts for name, one in get_types_from_idl(text).items()}


def _with_known(name: str, found: Definitions, known: Definitions) -> Definitions:
    """Return definitions with those of ROS for the types that they lack."""
    total, waiting = dict(found), [name]
    for one in waiting:
        if one.endswith("/wstring"):  # to the library, a type of the package
            raise InvalidFile("its strings of the type wstring cannot be read")
        if one not in total and one not in known:
            raise InvalidFile(f"the bag has no definition of {lcm_name(one)}, which it contains")
        total.setdefault(one, known.get(one))
        waiting += [nested for nested in nested_types(total[one]) if nested not in waiting]
    check_size(name, total)
    return total


def check_size(name: str, known: Definitions) -> None:
    """Raise InvalidFile for a type for which rosbags would write too much code.

    It writes a few lines for each field, and for each element of an array of fixed size.
    """
    if _size(name, known, {}, ()) > _MOST_VALUES:
        what = f"{lcm_name(name)} has more than {_MOST_VALUES} fields and elements of fixed arrays"
        raise InvalidFile(what)


def _size(name: str, known: Definitions, sizes: dict[str, int], above: tuple[str, ...]) -> int:
    from rosbags.interfaces import Nodetype

    if name in above or len(above) > _DEEPEST:
        raise InvalidFile(f"{lcm_name(name)} contains itself, or types nested too deeply")
    if name not in sizes:
        total = 0
        for _, (kind, of) in known[name][1]:
            is_array = kind in (Nodetype.ARRAY, Nodetype.SEQUENCE)
            element, base = of[0] if is_array else (kind, of)
            one = 1
            if element == Nodetype.NAME:
                one += _size(base, known, sizes, (*above, name))
            is_copied = element == Nodetype.BASE and base[0] != "string"  # numbers, at once
            total += one * of[1] if kind == Nodetype.ARRAY and not is_copied else one
        sizes[name] = total
    return sizes[name]


def nested_types(definition: tuple[Any, Any]) -> Iterator[str]:
    """Yield the types of the fields in a definition."""
    from rosbags.interfaces import Nodetype

    for _, (kind, of) in definition[1]:
        nested_kind, nested = of[0] if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE) else (kind, of)
        if nested_kind == Nodetype.NAME:
            yield nested


def _type_text(described: Any) -> str:  # noqa: ANN401 - of the library
    """Return a field's type as in a .msg file of ROS."""
    return _text(described, _base_text, lambda name: _TIMES.get(name) or name.replace("/msg/", "/"))


def _lcm_type_text(described: Any, version: RosVersion) -> str:  # noqa: ANN401 - of the library
    larger = {**_LARGER, "byte": "uint8"} if version == 2 else _LARGER  # noqa: PLR2004 - of ROS

    def base(name: str, limit: int) -> str:
        return larger.get(name) or _base_text(name, limit)

    return _text(described, base, lambda name: _TIMES.get(name) or lcm_name(name))


def _base_text(name: str, limit: int) -> str:
    name = "byte" if name == "octet" else name
    return f"{name}<={limit}" if limit else name


def _text(described: Any, base: Any, named: Any) -> str:  # noqa: ANN401 - likewise
    from rosbags.interfaces import Nodetype

    kind, of = described
    if kind == Nodetype.BASE:
        return str(base(*of))
    if kind == Nodetype.NAME:
        return str(named(of))
    element, size = of
    count = str(size) if kind == Nodetype.ARRAY else f"<={size}" * bool(size)
    return f"{_text(element, base, named)}[{count}]"
