"""Expressions in ``$(eval ...)``: arithmetic, comparisons, text and the file's arguments.

Belongs here: which expressions there are, and their values. As for filters, nothing is handed to
Python's own evaluation: the tree is walked, and what is not listed is refused. What an expression
costs is bounded by its length: numbers and text have a largest size, and there are no loops.
"""

import ast
import contextlib
import warnings
from collections.abc import Callable, Mapping
from typing import TypeAlias, cast

from lcmtools.errors import UsageError
from lcmtools.messages.operations import (
    ARITHMETIC,
    COMPARISONS,
    CONSTANTS,
    FUNCTIONS,
    LISTS,
    SIGNS,
    bounded,
    number,
)

Value: TypeAlias = object
Functions: TypeAlias = Mapping[str, Callable[[str], str]]

LONGEST = 1000
"""Characters of an expression."""
LONGEST_TEXT = 10_000
"""Characters of a text that one makes."""
_DEEPEST = 40
_NAMED: Mapping[str, Value] = {**CONSTANTS, "true": True, "false": False}
_CASTS: Mapping[str, Callable[[object], Value]] = {
    "str": str,
    "int": lambda value: bounded(int(cast("float", value))),
    "float": lambda value: float(cast("float", value)),
    "bool": bool,
}
_FAULTS = (ArithmeticError, LookupError, TypeError, ValueError)


def evaluate(text: str, arguments: Mapping[str, str], functions: Functions) -> str:
    """The value of an expression, as text.

    Args:
        text: The expression.
        arguments: What names stand for; "2" is a number, "true" a boolean.
        functions: What may be called besides the usual ones: ``arg('x')``, ``env('HOME')``.

    Raises:
        UsageError: It is none, or cannot be worked out.
    """
    root = _parsed(text.strip())
    try:
        return str(_Evaluation(arguments, functions).value(root, 0))
    except _FAULTS as fault:
        reason = str(fault) or type(fault).__name__
        raise UsageError(f"cannot work out '{text.strip()}': {reason}", _HINT) from None


def typed(text: str) -> Value:
    """What a text stands for where nobody says what it is: true or false, a number, or itself."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    with contextlib.suppress(ValueError, OverflowError):
        return bounded(int(text))
    with contextlib.suppress(ValueError):
        return float(text)
    return text


class _Evaluation:
    def __init__(self, arguments: Mapping[str, str], functions: Functions) -> None:
        self._arguments = arguments
        self._functions = functions

    def value(self, node: ast.AST, depth: int) -> Value:
        if depth > _DEEPEST:
            raise ValueError(f"it is nested more than {_DEEPEST} levels deep")
        if isinstance(node, ast.Constant):
            return _constant(node)
        if isinstance(node, ast.Name):
            return self._named(node.id)
        if isinstance(node, ast.Call):
            return self._called(node, depth + 1)
        if isinstance(node, (ast.BoolOp, ast.IfExp, ast.Compare)):
            return self._decided(node, depth + 1)
        return self._worked_out(node, depth + 1)

    def _named(self, name: str) -> Value:
        if name in self._arguments:
            return typed(self._arguments[name])
        if name in _NAMED:
            return _NAMED[name]
        raise LookupError(f"there is no '{name}'")

    def _called(self, call: ast.Call, depth: int) -> Value:
        name = call.func.id if isinstance(call.func, ast.Name) else ""
        values = [self.value(argument, depth) for argument in call.args]
        if call.keywords:
            raise ValueError("arguments have no names here")
        if name in self._functions:
            found = self._functions[name](*map(str, values))
            return typed(found) if name == "arg" else found
        if name in _CASTS and len(values) == 1:
            return _CASTS[name](values[0])
        if name not in FUNCTIONS or not values or (name in LISTS and len(values) > 1):
            raise LookupError(f"there is no function '{ast.unparse(call)}'")
        return bounded(FUNCTIONS[name](*values))

    def _decided(self, node: ast.BoolOp | ast.IfExp | ast.Compare, depth: int) -> Value:
        if isinstance(node, ast.IfExp):
            return self.value(node.body if self.value(node.test, depth) else node.orelse, depth)
        if isinstance(node, ast.Compare):
            return self._compared(node, depth)
        found: Value = None
        for operand in node.values:
            found = self.value(operand, depth)
            if bool(found) is isinstance(node.op, ast.Or):
                return found
        return found

    def _compared(self, node: ast.Compare, depth: int) -> bool:
        left = self.value(node.left, depth)
        for comparison, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.value(right_node, depth)
            compare = COMPARISONS.get(type(comparison))
            if compare is None:
                raise ValueError("write == or !=")
            if not compare(left, right):
                return False
            left = right
        return True

    def _worked_out(self, node: ast.AST, depth: int) -> Value:
        if isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC:
            left, right = self.value(node.left, depth), self.value(node.right, depth)
            if isinstance(node.op, ast.Add) and isinstance(left, str) and isinstance(right, str):
                return _joined(left, right)
            return bounded(ARITHMETIC[type(node.op)](number(left), number(right)))
        if isinstance(node, ast.UnaryOp) and type(node.op) in SIGNS:
            return SIGNS[type(node.op)](self.value(node.operand, depth))
        if isinstance(node, (ast.Tuple, ast.List)):
            return tuple(self.value(element, depth) for element in node.elts)
        raise ValueError(f"'{ast.unparse(node)}' is not allowed")


def _joined(left: str, right: str) -> str:
    if len(left) + len(right) > LONGEST_TEXT:
        raise ValueError(f"the text is longer than {LONGEST_TEXT} characters")
    return left + right


def _constant(node: ast.Constant) -> Value:
    if type(node.value) not in (bool, int, float, str):
        raise ValueError(f"'{ast.unparse(node)}' is not allowed")
    return bounded(node.value)


def _parsed(text: str) -> ast.expr:
    if len(text) > LONGEST:
        raise UsageError(f"an expression is longer than {LONGEST} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's advice to programmers
            return ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise UsageError(f"cannot read the expression '{text}'", _HINT) from None


_HINT = "write for example $(eval arg('count') * 2 + 1)"
