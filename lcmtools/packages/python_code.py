"""lcm-gen's Python code, with keyword arguments and a base for its classes.

Belongs here: the step after lcm-gen, for lcmtools' types and for ``msg generate``. It changes text
only, and must not know which types exist. For a geometry_msgs/Pose2D with a stamp it writes

    def __init__(self, x=0.0, y=0.0, theta=0.0, stamp=None):
        self.x = x
        ...
        self.stamp = std_msgs.Time() if stamp is None else stamp

    __init__.__qualname__ = "Pose2D has the fields x, y, theta, stamp; Pose2D"

Named parameters keep ``Pose2D()`` fast: ``**fields`` would make a Vector3() take 30 % longer.
Python's own TypeError for an unknown name begins with the function's qualified name, which
therefore has the fields' names.
"""

import ast
import re
from collections.abc import Sequence

_BASE = "lcmtools.message_value.MessageValue"
_CLASS = re.compile(r"^class (\w+)\(object\):$", re.MULTILINE)
_INIT = "    def __init__(self):\n"
_AFTER_INIT = "\n    def encode(self):\n"
_DIMENSIONS = re.compile(r"^    __dimensions__ = (.*)$", re.MULTILINE)
_DEFAULT = re.compile(r"^        self\.(\w+) = (.+)$", re.MULTILINE)
_CONSTANT = re.compile(r'-?[0-9.]+|True|False|b?""')
_USED = re.compile(r"(?<![\w.])(\w+)(?=[.(])")  # modules and functions in a default value

_OPTIONAL_BASE = """\
try:
    from lcmtools.message_value import MessageValue as _Base
except ImportError:  # where lcmtools is not installed
    _Base = object
"""


def as_values(python: str) -> str:
    """Return a module of lcm-gen with its class derived from MessageValue."""
    return _derived(python, f"import {_BASE.rpartition('.')[0]}\n", _BASE)


def as_portable_values(python: str) -> str:
    """Return a module of lcm-gen whose class has the base only where lcmtools is installed."""
    return _derived(python, _OPTIONAL_BASE, "_Base")


def _derived(python: str, imports: str, base: str) -> str:
    head, init, rest = python.partition(_INIT)
    dimensions, found = _DIMENSIONS.search(head), _CLASS.search(head)
    if not (init and dimensions and found):  # an enum, or a package's own module
        return python
    body, after, tail = rest.partition(_AFTER_INIT)
    defaults = dict(_DEFAULT.findall(body))
    hidden = set(_USED.findall(" ".join(defaults.values()))) & defaults.keys()
    imports += "".join(f"_{word} = {word}\n" for word in sorted(hidden))
    lengths = {size for sizes in ast.literal_eval(dimensions[1]) for size in sizes or ()}
    order = sorted(defaults, key=lambda name: name in lengths)  # length fields come last
    head = _CLASS.sub(lambda one: f"{imports}\nclass {one[1]}({base}):", head, count=1)
    return f"{head}{_init(found[1], order, defaults, body, hidden)}{after}{tail}"


def _init(
    cls: str, order: Sequence[str], defaults: dict[str, str], body: str, hidden: set[str]
) -> str:
    """Return the constructor; ``hidden`` are words in default values that parameters hide."""
    own = "self"
    while own in order:
        own = f"_{own}"

    def assignment(match: re.Match[str]) -> str:
        name, value = match.groups()
        if _CONSTANT.fullmatch(value):
            return f"        {own}.{name} = {name}"
        value = _USED.sub(lambda word: "_" * (word[0] in hidden) + word[0], value)
        return f"        {own}.{name} = {value} if {name} is None else {name}"

    parameters = [
        f"{name}={defaults[name] if _CONSTANT.fullmatch(defaults[name]) else None}"
        for name in order
    ]
    known = f"has the fields {', '.join(order)}" if order else "has no fields"
    return (
        f"    def __init__({', '.join([own, *parameters])}):\n"
        f"{_DEFAULT.sub(assignment, body).rstrip()}\n\n"
        f'    __init__.__qualname__ = "{cls} {known}; {cls}"\n'
    )
