"""Expressions in Python's syntax, checked and evaluated without Python's ``eval``.

Belongs here: the syntax tree. Every node that is not listed is refused. There are no loops, so the
cost of an expression is bounded by its length and by the arrays it is given. Must not know where
the values of names come from: see ``NameLookup``.
"""

import ast
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from keyword import kwlist
from typing import ClassVar, Protocol, cast

from lcmtools.errors import UsageError
from lcmtools.formats.operations import (
    ARITHMETIC,
    COMPARISONS,
    FUNCTIONS,
    LARGEST,
    OF_ONE_LIST,
    SIGNS,
    Function,
    bounded,
    comparable,
    joined,
    number,
)

DEEPEST = 40
"""The maximum depth of an expression's tree."""
_SHOWN = 40  # characters of an expression that an error repeats
# A field may be called "from": after a dot, or if no expression has that word, it is no keyword.
# Python reads the letters of East Asian text, which are as wide as two, as the usual ones in names
# (NFKC), but not in keywords.
_OPERATORS = {"and", "or", "not", "in", "is", "if", "else", "for", "lambda"}
_VALUES = {"True", "False", "None"}
_WIDE = {code: code + 0xFEE0 for code in range(ord("!"), ord("~") + 1)}
_NARROW = {wide: code for code, wide in _WIDE.items()}
_KEYWORD = re.compile(
    r"""'(?:\\.|[^'\\])*'|"(?:\\.|[^"\\])*"|\b\d[\w.]*"""
    rf"""|(?P<dot>\.\s*)?\b(?P<word>{"|".join(kwlist)})\b"""
)
_PLAIN_NODES = (ast.Name, ast.BoolOp, ast.Call, ast.Tuple, ast.List)
_FIELD_NODES = (ast.Attribute, ast.Subscript, ast.Slice)
_OF_VALUES = (ArithmeticError, LookupError, ValueError)
_FAULTS = (*_OF_VALUES, AttributeError, TypeError)


class NameLookup(Protocol):
    """The values of names during the evaluation of an expression."""

    def named(self, name: str) -> object:
        """Return the value of a name; raise LookupError if it has none."""

    def attribute(self, owner: object, name: str) -> object:
        """Return a field of a value."""


class ExpressionFault(Exception):  # noqa: N818 - named for what happened, as in errors.py
    """An expression cannot be evaluated with the given values."""


class NoValue(ExpressionFault):
    """An expression has no result for the given values, but may have one for others."""


@dataclass(frozen=True, slots=True)
class Language:
    """A dialect of expressions: its functions, limits and hints."""

    name: str  # in errors
    example: str  # the hint for an expression that cannot be read
    allowed: str  # the hint for a forbidden part: "fields, numbers ... are"
    longest: int  # characters
    functions: Mapping[str, Function]  # in addition to those of every expression
    has_fields: bool = False  # values have fields, and arrays have elements: m.x, a[0]
    has_choices: bool = False  # "a if b else c", and + joins text
    methods: Mapping[str, Function] = field(default_factory=dict)  # of text: x.lower(), x[0]
    counts: Mapping[str, tuple[int, int]] = field(default_factory=dict)  # of arguments, if not one


class Expression:
    """An expression whose syntax has been checked: its ``text`` and its syntax tree, ``root``.

    UsageError is raised for an expression that is too long or has a forbidden part, which the
    error names.
    """

    def __init__(self, text: str, language: Language) -> None:
        self.text = text.strip()
        self._language = language
        self._check_text()
        self._source = _KEYWORD.sub(_as_name, self.text) if language.has_fields else self.text
        self._functions = {**FUNCTIONS, **language.functions}
        self.root = self._parsed()
        self._check(self.root, 0)

    def value(self, scope: NameLookup) -> object:
        """Evaluate the expression; raise ExpressionFault if that fails.

        NoValue is raised if it may succeed with other values: if an index is out of range, or for
        a division by zero. "and" and "or" need only the operand that decides.
        """
        return self._value(self.root, scope)

    def place(self, node: ast.AST) -> str:
        """Return the source text of a node, shortened."""
        start, end = getattr(node, "col_offset", 0), getattr(node, "end_col_offset", None)
        part = self._source.encode()[start:end].decode(errors="replace").translate(_NARROW)
        return part if len(part) <= _SHOWN else f"{part[: _SHOWN - 3]}..."

    def _bad(self, reason: str, hint: str = "") -> UsageError:
        return UsageError(f"{self._language.name}: {reason}", hint)

    def _check_text(self) -> None:
        text, language = self.text, self._language
        if not text:
            raise self._bad("the expression is empty", language.example)
        if len(text) > language.longest:
            raise self._bad(f"the expression is longer than {language.longest} characters")
        if not text.isprintable():
            raise self._bad("the expression has a character that cannot be printed")

    def _parsed(self) -> ast.expr:
        text = self.text
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # Python's SyntaxWarnings are not for users
                return ast.parse(self._source, mode="eval").body
        except SyntaxError as error:
            start = max(0, (error.offset or 1) - 1)
            where = text[start : start + _SHOWN] or text[-_SHOWN:]
        except (ValueError, RecursionError, MemoryError):
            where = text[:_SHOWN]
        raise self._bad(f"cannot read '{where}'", self._language.example)

    def _check(self, node: ast.AST, depth: int) -> None:
        if depth > DEEPEST:
            raise self._bad(f"the expression is nested more than {DEEPEST} levels deep")
        if not self._is_allowed(node):
            raise self._bad(f"'{self.place(node)}' is not allowed", self._hint(node))
        if isinstance(node, ast.Call):
            self._check_call(node)
        for child in operands(node):
            self._check(child, depth + 1)

    def _check_call(self, call: ast.Call) -> None:
        name = call.func.id if isinstance(call.func, ast.Name) else ""
        place = self.place(call)
        if isinstance(call.func, ast.Attribute) and call.func.attr in self._language.methods:
            name = call.func.attr
        elif name not in self._functions:
            known = f"functions: {', '.join(sorted(self._functions))}"
            raise self._bad(f"no such function in '{place}'", known)
        takes_one = name in OF_ONE_LIST or name in self._language.functions
        most = 1 if takes_one else len(call.args)
        least, most = self._language.counts.get(name, (name not in self._language.methods, most))
        if call.keywords or not least <= len(call.args) <= most:
            raise self._bad(f"wrong arguments in '{place}'", f"write {name}(VALUE)")

    def _is_allowed(self, node: ast.AST) -> bool:
        if isinstance(node, ast.Constant):
            is_small = not isinstance(node.value, int) or abs(node.value) <= LARGEST
            return type(node.value) in (bool, int, float, str) and is_small
        if isinstance(node, (ast.BinOp, ast.UnaryOp)):
            return type(node.op) in ARITHMETIC or type(node.op) in SIGNS
        if isinstance(node, ast.Compare):
            return all(type(comparison) in COMPARISONS for comparison in node.ops)
        if isinstance(node, ast.Attribute) and node.attr.startswith("__"):
            return False
        if isinstance(node, (ast.Subscript, ast.Slice)) and self._language.methods:
            return True
        fields = _FIELD_NODES if self._language.has_fields else ()
        choices = (ast.IfExp,) if self._language.has_choices else ()
        return isinstance(node, (*_PLAIN_NODES, *fields, *choices))

    def _hint(self, node: ast.AST) -> str:
        """Return the hint for a forbidden part."""
        operation = type(getattr(node, "op", None))
        if operation in (ast.BitAnd, ast.BitOr, ast.Invert):
            return "write and, or, not"
        if isinstance(node, ast.Compare):
            return "write == or !="
        if isinstance(node, ast.Constant):
            return "numbers of 64 bits, text, True and False are"
        return self._language.allowed

    def _value(self, node: ast.AST, scope: NameLookup) -> object:
        try:
            return self._ways[type(node)](self, node, scope)
        except _FAULTS as fault:
            reason = str(fault) or type(fault).__name__
            depends = isinstance(fault, _OF_VALUES) and _has_names(node)
            kind = NoValue if depends else ExpressionFault
            raise kind(f"'{self.place(node)}': {reason}") from None

    def _element(self, node: ast.Subscript, scope: NameLookup) -> object:
        array = cast("tuple[object, ...]", self._value(node.value, scope))
        index = cast("int", self._value(node.slice, scope))
        try:
            return comparable(array[index])
        except IndexError:
            raise LookupError(f"it has {len(array)} elements, none at {index}") from None

    def _slice(self, node: ast.Slice, scope: NameLookup) -> object:
        bounds = (node.lower, node.upper, node.step)
        return slice(*(bound and self._value(bound, scope) for bound in bounds))

    def _call(self, node: ast.Call, scope: NameLookup) -> object:
        values = [self._value(argument, scope) for argument in node.args]
        if isinstance(node.func, ast.Attribute):
            owner = self._value(node.func.value, scope)
            if not isinstance(owner, str):
                raise TypeError(f"{owner} is no text")
            return comparable(self._language.methods[node.func.attr](owner, *values))
        return bounded(self._functions[cast("ast.Name", node.func).id](*values))

    def _choice(self, node: ast.IfExp, scope: NameLookup) -> object:
        chosen = node.body if self._value(node.test, scope) else node.orelse
        return self._value(chosen, scope)

    def _boolean(self, node: ast.BoolOp, scope: NameLookup) -> object:
        found: object = None
        missing: NoValue | None = None
        for operand in node.values:
            try:
                found = self._value(operand, scope)
            except NoValue as fault:
                missing = fault
                continue
            if bool(found) is isinstance(node.op, ast.Or):
                return found
        if missing:
            raise missing
        return found

    def _comparison(self, node: ast.Compare, scope: NameLookup) -> bool:
        left = self._value(node.left, scope)
        for comparison, right_node in zip(node.ops, node.comparators, strict=True):
            right = self._value(right_node, scope)
            if not COMPARISONS[type(comparison)](left, right):
                return False
            left = right
        return True

    def _arithmetic(self, node: ast.BinOp, scope: NameLookup) -> object:
        left, right = self._value(node.left, scope), self._value(node.right, scope)
        is_text = isinstance(left, str) and isinstance(right, str) and isinstance(node.op, ast.Add)
        if is_text and self._language.has_choices:
            return joined(cast("str", left), cast("str", right))
        return bounded(ARITHMETIC[type(node.op)](number(left), number(right)))

    def _sign(self, node: ast.UnaryOp, scope: NameLookup) -> object:
        return bounded(SIGNS[type(node.op)](self._value(node.operand, scope)))

    def _list(self, node: ast.Tuple | ast.List, scope: NameLookup) -> object:
        return tuple(self._value(element, scope) for element in node.elts)

    _ways: ClassVar[Mapping[type[ast.AST], Callable[..., object]]] = {
        ast.Constant: lambda _, node, _scope: node.value,
        ast.Name: lambda _, node, scope: scope.named(node.id),
        ast.Attribute: lambda self, node, scope: scope.attribute(
            self._value(node.value, scope), node.attr
        ),
        ast.Subscript: _element,
        ast.Slice: _slice,
        ast.Call: _call,
        ast.IfExp: _choice,
        ast.BoolOp: _boolean,
        ast.Compare: _comparison,
        ast.BinOp: _arithmetic,
        ast.UnaryOp: _sign,
        ast.Tuple: _list,
        ast.List: _list,
    }


def _has_names(node: ast.AST) -> bool:
    return isinstance(node, ast.Name) or any(map(_has_names, operands(node)))


def operands(node: ast.AST) -> list[ast.expr]:
    """Return a node's subexpressions, without operators and names of functions and methods."""
    if isinstance(node, ast.Call):
        owner = [node.func.value] if isinstance(node.func, ast.Attribute) else []
        return [*owner, *node.args]
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]


def _as_name(found: re.Match[str]) -> str:
    """Return a keyword that is a field's name in letters that make it one for Python."""
    dot, word = found["dot"] or "", found["word"]
    if word is None or not (dot or word not in _OPERATORS | _VALUES):
        return found[0]
    return dot + word.translate(_WIDE)
