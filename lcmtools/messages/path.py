"""Field paths: ``pose.pose.position``, ``/ranges[0:5]``, ``transforms[0].header/stamp``.

Belongs here: the syntax of paths, their targets in a type, and the values they select. Must not
know the bus, files or the terminal, nor the display of values.

Names are separated by dots, as in ROS 2, or slashes, as in rostopic. Indices and slices are
Python's, and for arrays only. A name after a slice applies to each of its elements.
"""

import re
from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple, TypeAlias, cast

from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.fields import (
    Field,
    MessageClass,
    attribute,
    field_name,
    fields,
    fields_hint,
)
from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.shape import as_sequence
from lcmtools.names import did_you_mean

Slice: TypeAlias = tuple[int | None, int | None, int | None]
"""Start, stop and step, as in Python's slices."""

Step: TypeAlias = str | int | Slice
"""A field's name, an index into an array, or a slice of it."""

_STEP = re.compile(r"[./]([^./\[\]]+)|\[([^\]]*)\]")
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)
_MOST_PARTS = 3  # parts of a slice
_WIDEST = 10_000  # elements of a slice whose columns are known before its messages
_DEEPEST = 4  # levels of nested messages in which a field is searched for
_EXAMPLES = "write [0], [-1], [0:5] or [::2]"


class Path(NamedTuple):
    """The steps from a message to a value within it; none for the message itself."""

    steps: tuple[Step, ...] = ()

    def __str__(self) -> str:
        """Return the path in ROS 2's notation: ``pose.covariance[0:3]``."""
        return "".join(map(_written, self.steps)).removeprefix(".")

    @property
    def width(self) -> int:
        """The most elements of a slice at its end, as in [0:5]; 0 if there is no such limit."""
        last = self.steps[-1] if self.steps else ""
        start, stop, step = last if isinstance(last, tuple) else (0, 0, 1)
        if stop is None or min(start or 0, stop, step or 1) < 0 or stop > _WIDEST:
            return 0
        return len(range(start or 0, stop, step or 1))

    def then(self, other: "Path") -> "Path":
        """Return this path followed by another."""
        return Path(self.steps + other.steps)


class Target(NamedTuple):
    """The target of a path in messages of one type; see ``fields.Field``."""

    type: str
    message_class: MessageClass | None = None
    dimensions: tuple[int | str, ...] = ()  # the remaining dimensions
    mapped: int = 0  # lists around it caused by names after slices
    sliced: bool = False  # True if the outermost dimension is a slice; a name may follow

    @property
    def depth(self) -> int:
        """The number of lists around each element; 0 for a single value."""
        return self.mapped + len(self.dimensions)


class SelectedValue(NamedTuple):
    """A selected value."""

    value: object
    target: Target


def parse_path(text: str) -> Path:
    """Parse a path; a separator before it, or a slash at its end, is ignored.

    UsageError names the text and the mistake in it.
    """
    rest = text.removesuffix("/")
    if rest[:1] not in ("", ".", "/", "["):
        rest = f".{rest}"
    steps: list[Step] = []
    while rest:
        step = _STEP.match(rest)
        if not step and rest[0] == "[":
            raise UsageError(f"field path '{text}': '{rest}' has no closing ']'", _EXAMPLES)
        if not step:
            raise UsageError(f"field path '{text}': expected a field's name at '{rest}'")
        steps.append(step[1] or _parse_index(step[2], text))
        rest = rest[step.end() :]
    return Path(tuple(steps))


@cache
def target(cls: type[Message], path: Path) -> Target:
    """Return the target of a path in any message of a type.

    ValueMismatch names the path, and the existing fields.
    """
    found = root_target(cls)
    for done, step in enumerate(path.steps):
        where = str(Path(path.steps[:done]))
        follow = field_target if isinstance(step, str) else element_target
        found = follow(found, step, where)  # type: ignore[arg-type] # the function for this step
    return found


def select(message: Message, path: Path) -> SelectedValue:
    """Return the value at a path; ValueMismatch as in ``target``, or for an index out of range."""
    found = target(type(message), path)  # first, because it checks the names
    return SelectedValue(_walk(message, path.steps, path), found)


def splits(argument: str) -> Iterator[tuple[str, str]]:
    """Yield all splits of an argument into a topic and a field path, longest topic first."""
    yield argument, ""
    for end in range(len(argument) - 1, 0, -1):
        if argument[end] in "./[":
            yield argument[:end], argument[end:]


def root_target(cls: type[Message]) -> Target:
    """Return the target for a whole message of a type."""
    return Target(type_name(cls), cls)


def field_target(owner: Target, name: str, where: str) -> Target:
    """Return a field's target, else raise ValueMismatch; ``where`` is the owner, for errors."""
    if owner.dimensions and not owner.sliced:
        says = f"{where} is an array of {owner.type}" if where else "it is an array"
        raise ValueMismatch(f"{says}, which has no field '{name}'", "put an index before it: [0]")
    if len(owner.dimensions) > 1 or owner.message_class is None:
        raise ValueMismatch(f"{where} is a {owner.type}, which has no field '{name}'")
    field = _field(owner.message_class, name, where)
    mapped = owner.mapped + len(owner.dimensions)
    return Target(field.type, field.message_class, field.dimensions, mapped)


def element_target(owner: Target, step: int | Slice, where: str) -> Target:
    """Return the target of an element or a slice of an array.

    ValueMismatch is raised if it is not an array, or has a fixed size without this element.
    """
    if not owner.dimensions:
        known = f" ({fields_hint(owner.message_class)})" if owner.message_class else ""
        raise ValueMismatch(f"{where or 'the message'} is not an array but a {owner.type}{known}")
    if not isinstance(step, int):
        return owner._replace(sliced=True)
    size = owner.dimensions[0]
    if isinstance(size, int) and not owner.sliced and not -size <= step < size:
        raise _outside(f"{where}[{step}]", size)
    return owner._replace(dimensions=owner.dimensions[1:], sliced=False)


def _walk(value: object, steps: tuple[Step, ...], path: Path) -> object:
    for done, step in enumerate(steps, 1):
        if isinstance(step, str):
            cls = type(cast("Message", value))
            value = getattr(value, attribute(cls, field_name(cls, step)))
        elif isinstance(step, int):
            value = _element(value, step, path)
        else:
            elements = value = _sequence(value)[slice(*step)]
            rest = steps[done:]
            if rest and isinstance(rest[0], str):
                return [_walk(element, rest, path) for element in elements]
    return value


def _element(array: object, index: int, path: Path) -> object:
    elements = _sequence(array)
    try:
        return elements[index]
    except IndexError:
        raise _outside(str(path), len(elements), f"[{index}]") from None


def _sequence(array: object) -> Sequence[object]:
    return array if isinstance(array, (bytes, NumberArray)) else as_sequence(array)


def _outside(where: str, size: int, index: str = "") -> ValueMismatch:
    count = "1 element" if size == 1 else f"{size or 'no'} elements"
    return ValueMismatch(f"{where}: the array has {count}{index and f', none at {index}'}")


def _field(cls: type[Message], name: str, where: str) -> Field:
    known = {field.name: field for field in fields(cls)}
    own_name = field_name(cls, name)
    if own_name in known:
        return known[own_name]
    path = f"{where}.{name}" if where else name
    what = f"{path}: {type_name(cls)} has no field '{name}' ({fields_hint(cls)})"
    deeper = _deeper(cls, name)
    inside = f"did you mean {f'{where}.' if where else ''}{deeper}?" if deeper else ""
    raise ValueMismatch(what, did_you_mean(name, known) or inside)


def _deeper(cls: type[Message], name: str) -> str:
    """Return the path to the outermost nested field of this name; "" if there is none."""
    level = [(field.name, field) for field in fields(cls)]
    for _ in range(_DEEPEST):
        level = [
            (f"{path}.{inner.name}", inner)
            for path, field in level
            if field.message_class and not field.dimensions
            for inner in fields(field.message_class)
        ]
        found = next((path for path, field in level if field.name == name), "")
        if found:
            return found
    return ""


def _parse_index(inside: str, text: str) -> int | Slice:
    parts = [part.strip() for part in inside.split(":")]
    wrong = next((part for part in parts if part and not _WHOLE.fullmatch(part)), None)
    if parts == [""]:
        problem = "the index in '[]' is missing"
    elif len(parts) > _MOST_PARTS:
        problem = f"'[{inside}]' has more than start, stop and step"
    elif wrong:
        problem = f"'{wrong}' is not a whole number"
    elif parts[2:] and parts[2] and int(parts[2]) == 0:
        problem = f"the step in '[{inside}]' is 0"
    elif len(parts) == 1:
        return int(parts[0])
    else:
        start, stop, step = (*(int(part) if part else None for part in parts), None)[:_MOST_PARTS]
        return start, stop, step
    raise UsageError(f"field path '{text}': {problem}", _EXAMPLES)


def _written(step: Step) -> str:
    if isinstance(step, str):
        return f".{step}"
    if isinstance(step, int):
        return f"[{step}]"
    start, stop, stride = ("" if part is None else str(part) for part in step)
    return f"[{start}:{stop}:{stride}]" if stride else f"[{start}:{stop}]"
