"""Filter expressions: ``m.data == 'x'``, ``hypot(linear.x, linear.y) > 0.5 and not isnan(angle)``.

Belongs here: the names in an expression, which are the fields and constants of a message. ``m`` is
the message; its fields may also be used without it. Must not know where the messages come from.
"""

import ast
import contextlib
from collections import Counter
from collections.abc import Sequence
from functools import cache
from typing import cast

from lcmtools.errors import ValueMismatch
from lcmtools.formats.expression import Expression, ExpressionFault, Language, NoValue, operands
from lcmtools.formats.operations import CONSTANTS, comparable
from lcmtools.messages.enums import EnumType
from lcmtools.messages.fields import attribute, constants, field_name, fields
from lcmtools.messages.path import Slice, Target, element_target, field_target, root_target
from lcmtools.messages.registry import Message

LONGEST = 500  # characters of an expression
_LANGUAGE = Language(
    name="filter",
    example="write for example m.data > 0 and m.name == 'x' (==, and, or, not)",
    allowed="fields, numbers, text, comparisons, arithmetic, and, or, not, in are",
    longest=LONGEST,
    functions={},
    has_fields=True,
)


class Filter:
    """A condition on messages; UsageError names a part that is wrong or not allowed."""

    def __init__(self, text: str) -> None:
        self._expression = Expression(text, _LANGUAGE)
        self._checked: set[type[Message]] = set()

    def __str__(self) -> str:
        """Return the expression."""
        return self._expression.text

    def check(self, cls: type[Message]) -> None:
        """Raise ValueMismatch, with a type's fields, for a name that its messages do not have."""
        if cls not in self._checked:
            self._check_names(self._expression.root, root_target(cls))
            self._checked.add(cls)

    def matches(self, message: Message) -> bool:
        """Return whether a message meets the condition; False if it has no value there.

        Raise ValueMismatch if there is no such field, or a value does not suit its operation.
        """
        self.check(type(message))
        try:
            return bool(self._expression.value(_Fields(message)))
        except NoValue:  # an index beyond the end of an array, a division by zero
            return False
        except ExpressionFault as fault:
            raise ValueMismatch(f"filter: {fault}") from None

    def _check_names(self, node: ast.AST, root: Target) -> Target | None:
        """Return the field that a node names; None for other values."""
        place = self._expression.place
        if isinstance(node, ast.Name):
            if node.id == "m":
                return root
            cls = cast("type[Message]", root.message_class)
            return None if _is_constant(node.id, cls) else _named_target(root, node.id, "")
        if isinstance(node, ast.Attribute):
            owner = self._check_names(node.value, root)
            if owner is None:
                raise ValueMismatch(f"filter: '{place(node)}' is not a field of the message")
            return _named_target(owner, node.attr, place(node.value))
        if isinstance(node, ast.Subscript):
            return self._check_subscript(node, root)
        for child in operands(node):
            self._check_names(child, root)
        return None

    def _check_subscript(self, node: ast.Subscript, root: Target) -> Target | None:
        owner = self._check_names(node.value, root)
        self._check_names(node.slice, root)
        if owner is None or (owner.type == "string" and not owner.dimensions):
            return None
        step: int | Slice = (None, None, None)
        if not isinstance(node.slice, ast.Slice):
            step = _constant(node.slice)
        found = element_target(owner, step, self._expression.place(node.value))
        # a slice has no further names: there are no operations on all of its elements
        return Target(found.type, found.message_class, found.dimensions)


class _Fields:
    """The fields of a message, for the names in an expression."""

    def __init__(self, message: Message) -> None:
        self._message = message

    def named(self, name: str) -> object:
        if name == "m":
            return self._message
        if _is_constant(name, type(self._message)):
            return CONSTANTS[name]
        return self.attribute(self._message, name)

    def attribute(self, owner: object, name: str) -> object:
        cls = type(cast("Message", owner))
        if name in _enum_values(cls):
            return _enum_values(cls)[name]
        own_name = field_name(cls, name)
        value = getattr(owner, attribute(cls, own_name))
        kind = next((part.type for part in fields(cls) if part.name == own_name), "")
        if isinstance(kind, EnumType):  # which equals its name too
            value = list(map(kind.cls, value)) if isinstance(value, Sequence) else kind.cls(value)
        return comparable(value)


def _named_target(owner: Target, name: str, where: str) -> Target | None:
    """Return the target of a field; None for a constant of the owner's type, or of its enums."""
    if owner.message_class is not None and not owner.dimensions:
        cls = owner.message_class
        if name in constants(cls) or name in _enum_values(cls):
            return None
    return field_target(owner, name, where)


@cache
def _enum_values(cls: type[Message]) -> dict[str, int]:
    """Return the values of the enums of a type's fields, but for names of fields and others."""
    kinds = {part.type.cls for part in fields(cls) if isinstance(part.type, EnumType)}
    named = [item for kind in kinds for item in kind.__members__.items()]
    taken = {part.name for part in fields(cls)} | constants(cls).keys()
    several = Counter(name for name, _ in set(named))
    return {name: value for name, value in named if name not in taken and several[name] == 1}


def _is_constant(name: str, cls: type[Message]) -> bool:
    return name in CONSTANTS and all(field.name != name for field in fields(cls))


def _constant(index: ast.expr) -> int:
    """Return an index that is written as a number; 0 if it depends on the message."""
    with contextlib.suppress(ValueError, TypeError):
        return int(ast.literal_eval(index))
    return 0
