"""Filter expressions: ``m.data == 'x'``, ``hypot(linear.x, linear.y) > 0.5 and not isnan(angle)``.

Belongs here: which expressions there are, and their value for a message. Must not know where the
messages come from. Nothing is handed to Python's own evaluation: the expression's tree is walked,
and whatever is not listed here is refused.

``m`` is the message; its fields may also be named alone. What an expression costs is bounded by its
length and by the message: there are no loops, powers are floating point, whole numbers have a
largest value, and text and arrays can be neither added nor multiplied.
"""

import ast
import warnings
from typing import cast

from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.fields import field_name, visible_fields
from lcmtools.messages.operations import (
    ARITHMETIC,
    COMPARISONS,
    CONSTANTS,
    FUNCTIONS,
    LARGEST,
    LISTS,
    SIGNS,
    bounded,
    comparable,
    element,
    number,
)
from lcmtools.messages.path import Slice, Target, element_target, field_target, root_target
from lcmtools.messages.registry import Message

LONGEST = 500
"""Characters of an expression."""
DEEPEST = 40
"""Levels of an expression's tree."""
_SHOWN = 40  # characters of an expression that an error repeats
_FAULTS = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class Filter:
    """A condition that a message meets or not.

    Args:
        text: The expression.

    Raises:
        UsageError: It is none, is too long, or has something in it that is not allowed; it names
            the place.
    """

    def __init__(self, text: str) -> None:
        self._text = text.strip()
        self._root = _parsed(self._text)
        self._checked: set[type[Message]] = set()
        self._check_form(self._root, 0)

    def __str__(self) -> str:
        """The expression."""
        return self._text

    def check(self, cls: type[Message]) -> None:
        """Find names that messages of a type do not have, before there is one.

        Raises:
            ValueMismatch: There is such a name; with the fields there are.
        """
        if cls not in self._checked:
            self._check_names(self._root, root_target(cls))
            self._checked.add(cls)

    def matches(self, message: Message) -> bool:
        """Whether a message meets the condition.

        Raises:
            ValueMismatch: It has no such field, or a value does not fit what is done with it.
        """
        self.check(type(message))
        return bool(self._value(self._root, message))

    def _check_form(self, node: ast.AST, depth: int) -> None:
        if depth > DEEPEST:
            raise UsageError(f"filter: the expression is nested more than {DEEPEST} levels deep")
        if not _is_allowed(node):
            raise UsageError(f"filter: '{self._place(node)}' is not allowed", _hint(node))
        if isinstance(node, ast.Call):
            self._check_call(node)
        for child in _children(node):
            self._check_form(child, depth + 1)

    def _check_call(self, call: ast.Call) -> None:
        name = call.func.id if isinstance(call.func, ast.Name) else ""
        place = self._place(call)
        if name not in FUNCTIONS:
            known = f"functions: {', '.join(sorted(FUNCTIONS))}"
            raise UsageError(f"filter: no such function in '{place}'", known)
        if call.keywords or not call.args or (name in LISTS and len(call.args) > 1):
            raise UsageError(f"filter: wrong arguments in '{place}'", f"write {name}(VALUE)")

    def _check_names(self, node: ast.AST, root: Target) -> Target | None:
        """What a node is, where it is a field; None where it is worked out."""
        if isinstance(node, ast.Name):
            return self._named(node, root)
        if isinstance(node, ast.Attribute):
            owner = self._check_names(node.value, root)
            if owner is None:
                raise ValueMismatch(f"filter: '{self._place(node)}' is not a field of the message")
            return field_target(owner, node.attr, self._place(node.value))
        if isinstance(node, ast.Subscript):
            return self._check_subscript(node, root)
        for child in _children(node):
            self._check_names(child, root)
        return None

    def _named(self, node: ast.Name, root: Target) -> Target | None:
        if node.id == "m":
            return root
        if node.id in CONSTANTS and node.id not in _names(root.message_class):
            return None
        return field_target(root, node.id, "")

    def _check_subscript(self, node: ast.Subscript, root: Target) -> Target | None:
        owner = self._check_names(node.value, root)
        self._check_names(node.slice, root)
        if owner is None or (owner.type == "string" and not owner.dimensions):
            return None
        step: int | Slice = (None, None, None) if isinstance(node.slice, ast.Slice) else 0
        found = element_target(owner, step, self._place(node.value))
        # a slice's elements have no name of their own here: there is nothing to do them all with
        return Target(found.type, found.message_class, found.dimensions)

    def _value(self, node: ast.AST, message: Message) -> object:
        """The value of a node."""
        try:
            return self._evaluated(node, message)
        except _FAULTS as fault:
            reason = str(fault) or type(fault).__name__
            raise ValueMismatch(f"filter: '{self._place(node)}': {reason}") from None

    def _evaluated(self, node: ast.AST, message: Message) -> object:
        if isinstance(node, (ast.Name, ast.Attribute, ast.Subscript, ast.Slice)):
            return self._place_value(node, message)
        if isinstance(node, ast.BoolOp):
            return self._boolean(node, message)
        if isinstance(node, ast.Compare):
            return self._compared(node, message)
        if isinstance(node, ast.Constant):
            return node.value
        return self._worked_out(node, [self._value(child, message) for child in _children(node)])

    def _worked_out(self, node: ast.AST, values: list[object]) -> object:
        """The value of an operation or a function; of a list, the list."""
        if isinstance(node, ast.UnaryOp):
            return SIGNS[type(node.op)](values[0])
        if isinstance(node, ast.BinOp):
            return bounded(ARITHMETIC[type(node.op)](*map(number, values)))
        if isinstance(node, ast.Call):
            return bounded(FUNCTIONS[cast("ast.Name", node.func).id](*values))
        return tuple(values)

    def _place_value(self, node: ast.AST, message: Message) -> object:
        if isinstance(node, ast.Name):
            return _named_value(message, node.id)
        if isinstance(node, ast.Attribute):
            return _field_value(cast("Message", self._value(node.value, message)), node.attr)
        if isinstance(node, ast.Subscript):
            array = self._value(node.value, message)
            return comparable(element(array, self._value(node.slice, message)))
        bounds = cast("ast.Slice", node)
        parts = (bounds.lower, bounds.upper, bounds.step)
        return slice(*(part and self._value(part, message) for part in parts))

    def _boolean(self, node: ast.BoolOp, message: Message) -> bool:
        values = (bool(self._value(value, message)) for value in node.values)
        return all(values) if isinstance(node.op, ast.And) else any(values)

    def _compared(self, node: ast.Compare, message: Message) -> bool:
        left = self._value(node.left, message)
        for comparison, right_node in zip(node.ops, node.comparators, strict=True):
            right = self._value(right_node, message)
            if not COMPARISONS[type(comparison)](left, right):
                return False
            left = right
        return True

    def _place(self, node: ast.AST) -> str:
        """The part of the expression that a node was read from, shortened."""
        start, end = getattr(node, "col_offset", 0), getattr(node, "end_col_offset", None)
        part = self._text.encode()[start:end].decode(errors="replace")
        return part if len(part) <= _SHOWN else f"{part[: _SHOWN - 3]}..."


def _parsed(text: str) -> ast.expr:
    if not text:
        raise UsageError("filter: the expression is empty", "write for example m.data > 0")
    if len(text) > LONGEST:
        raise UsageError(f"filter: the expression is longer than {LONGEST} characters")
    if not text.isprintable():
        raise UsageError("filter: the expression has a character that cannot be printed")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's advice to programmers
            return ast.parse(text, mode="eval").body
    except SyntaxError as error:
        start = max(0, (error.offset or 1) - 1)
        where = text[start : start + _SHOWN] or text[-_SHOWN:]
        raise UsageError(f"filter: cannot read '{where}'", _SYNTAX_HINT) from None
    except (ValueError, RecursionError, MemoryError):
        raise UsageError(f"filter: cannot read '{text[:_SHOWN]}'", _SYNTAX_HINT) from None


_SYNTAX_HINT = "write for example m.data > 0 and m.name == 'x' (==, and, or, not)"
_PLAIN_NODES = (ast.Name, ast.Subscript, ast.Slice, ast.BoolOp, ast.Compare, ast.Call, ast.Tuple)


def _is_allowed(node: ast.AST) -> bool:
    if isinstance(node, ast.Constant):
        value = node.value
        is_small = not isinstance(value, int) or abs(value) <= LARGEST
        return type(value) in (bool, int, float, str) and is_small
    if isinstance(node, ast.Attribute):
        return not node.attr.startswith("__")
    if isinstance(node, ast.BinOp):
        return type(node.op) in ARITHMETIC
    if isinstance(node, ast.UnaryOp):
        return type(node.op) in SIGNS
    if isinstance(node, ast.Compare):
        return all(type(comparison) in COMPARISONS for comparison in node.ops)
    return isinstance(node, (*_PLAIN_NODES, ast.List))


def _hint(node: ast.AST) -> str:
    """What to write instead of something that is not allowed."""
    operation = type(getattr(node, "op", None))
    if operation in (ast.BitAnd, ast.BitOr, ast.Invert):
        return "write and, or, not"
    if isinstance(node, ast.Compare):
        return "write == or !="
    if isinstance(node, ast.Constant):
        return "numbers of 64 bits, text, True and False are"
    return "fields, numbers, text, comparisons, arithmetic, and, or, not, in are"


def _children(node: ast.AST) -> list[ast.AST]:
    """The expressions in an expression, without operators and the names of functions."""
    if isinstance(node, ast.Call):
        return list(node.args)
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]


def _names(cls: type[Message] | None) -> set[str]:
    return {field.name for field in visible_fields(cls)} if cls else set()


def _named_value(message: Message, name: str) -> object:
    if name == "m":
        return message
    is_constant = name in CONSTANTS and name not in _names(type(message))
    return CONSTANTS[name] if is_constant else _field_value(message, name)


def _field_value(message: Message, name: str) -> object:
    return comparable(getattr(message, field_name(type(message), name)))
