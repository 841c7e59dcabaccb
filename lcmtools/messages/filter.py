"""Filter expressions: ``m.data == 'x'``, ``hypot(linear.x, linear.y) > 0.5 and not isnan(angle)``.

Belongs here: the names in an expression, which are the fields of a message. ``m`` is the message;
its fields may also be named alone. Must not know where the messages come from.
"""

import ast
from typing import cast

from lcmtools.errors import ValueMismatch
from lcmtools.formats.expression import Expression, ExpressionFault, Language, operands
from lcmtools.formats.operations import CONSTANTS, comparable
from lcmtools.messages.fields import field_name, visible_fields
from lcmtools.messages.path import Slice, Target, element_target, field_target, root_target
from lcmtools.messages.registry import Message

LONGEST = 500
"""Characters of an expression."""
_LANGUAGE = Language(
    name="filter",
    example="write for example m.data > 0 and m.name == 'x' (==, and, or, not)",
    allowed="fields, numbers, text, comparisons, arithmetic, and, or, not, in are",
    longest=LONGEST,
    functions={},
    has_fields=True,
)


class Filter:
    """A condition on messages.

    Args:
        text: The expression.

    Raises:
        UsageError: It is none, is too long, or has a part that is not allowed, which is named.
    """

    def __init__(self, text: str) -> None:
        self._expression = Expression(text, _LANGUAGE)
        self._checked: set[type[Message]] = set()

    def __str__(self) -> str:
        """Return the expression."""
        return self._expression.text

    def check(self, cls: type[Message]) -> None:
        """Find names that messages of a type do not have, before there is a message.

        Raises:
            ValueMismatch: There is such a name; with the fields of the type.
        """
        if cls not in self._checked:
            self._check_names(self._expression.root, root_target(cls))
            self._checked.add(cls)

    def matches(self, message: Message) -> bool:
        """Return whether a message meets the condition.

        Raises:
            ValueMismatch: It has no such field, or a value does not fit its operation.
        """
        self.check(type(message))
        try:
            return bool(self._expression.value(_Fields(message)))
        except ExpressionFault as fault:
            raise ValueMismatch(f"filter: {fault}") from None

    def _check_names(self, node: ast.AST, root: Target) -> Target | None:
        """Return the field that a node names; None for other values."""
        place = self._expression.place
        if isinstance(node, ast.Name):
            if node.id == "m":
                return root
            is_constant = node.id in CONSTANTS and node.id not in _names(root.message_class)
            return None if is_constant else field_target(root, node.id, "")
        if isinstance(node, ast.Attribute):
            owner = self._check_names(node.value, root)
            if owner is None:
                raise ValueMismatch(f"filter: '{place(node)}' is not a field of the message")
            return field_target(owner, node.attr, place(node.value))
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
        step: int | Slice = (None, None, None) if isinstance(node.slice, ast.Slice) else 0
        found = element_target(owner, step, self._expression.place(node.value))
        # a slice's elements have no name of their own here: nothing can be done with all of them
        return Target(found.type, found.message_class, found.dimensions)


class _Fields:
    """The fields of a message, as the names of an expression."""

    def __init__(self, message: Message) -> None:
        self._message = message

    def named(self, name: str) -> object:
        if name == "m":
            return self._message
        is_constant = name in CONSTANTS and name not in _names(type(self._message))
        return CONSTANTS[name] if is_constant else self.attribute(self._message, name)

    def attribute(self, owner: object, name: str) -> object:
        cls = type(cast("Message", owner))
        return comparable(getattr(owner, field_name(cls, name)))


def _names(cls: type[Message] | None) -> set[str]:
    return {field.name for field in visible_fields(cls)} if cls else set()
