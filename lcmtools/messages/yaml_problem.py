"""What is wrong with YAML that its parser refuses, and what to type instead.

Belongs here: the parser's words and places turned into ours. Must not know messages.
"""

import re
from typing import TYPE_CHECKING

from lcmtools.errors import ValueMismatch
from lcmtools.messages.yaml_tree import BadYaml, Mark

if TYPE_CHECKING:
    import yaml

_WORD_BEFORE_COLON = re.compile(r"\b([A-Za-z_]\w*):([^\s:/,}\]]+)")
_WHOLE_BRACKETS = {"{": "{...}", "[": "[...]"}
_SPECIAL = "@`%|>"
_COLON_PROBLEMS = ("mapping values are not allowed", "found unexpected ':'")
_NO_COMMA = "did not find expected ','"
_IN_BRACKETS = (_NO_COMMA, "did not find expected node content")


class OpenBracket(ValueMismatch):
    """The text ends within brackets; with more of it, it may be right."""


def mismatch(bad: BadYaml, first_line: int) -> ValueMismatch:
    """The error for the user; ``first_line`` is the number of the text's first line."""
    return ValueMismatch(f"bad YAML{_place(bad.mark, first_line)}: {bad.problem}", bad.hint)


def explained(error: "yaml.MarkedYAMLError", text: str, first_line: int) -> ValueMismatch:
    """What the parser complains of, as an error for the user."""
    context, problem, mark = str(error.context), str(error.problem), error.problem_mark
    if problem.startswith(_IN_BRACKETS) and mark and mark.line >= _lines(text):
        return OpenBracket(f"bad YAML{_open_bracket(error, first_line)}")
    if problem == "found unexpected end of stream" and "quoted" in context:
        return mismatch(BadYaml(error.context_mark, "this quote is not closed"), first_line)
    return mismatch(_reworded(problem, mark, text), first_line)


def forbidden_character(text: str) -> BadYaml:
    """What is wrong with a text that is not for YAML: control characters, half characters."""
    import yaml

    match = yaml.reader.Reader.NON_PRINTABLE.search(text)
    if not match:
        return BadYaml(None, "a character is not allowed")
    before = text[: match.start()]
    place = _Place(before.count("\n"), len(before) - before.rfind("\n") - 1)
    return BadYaml(place, f"the character U+{ord(match[0]):04X} is not allowed")


def _reworded(problem: str, mark: Mark | None, text: str) -> BadYaml:
    line = _line(text, mark)
    at = line[mark.column : mark.column + 1] if mark else ""
    if problem.startswith(_COLON_PROBLEMS):
        return BadYaml(mark, problem, _colon_hint(text) or _nesting_hint(mark))
    if at == "\t" or "tab character" in problem:
        return BadYaml(mark, "a tab cannot indent", "use blanks")
    if at and at in _SPECIAL:
        return BadYaml(mark, f"text cannot begin with '{at}'", "put it in quotes")
    if at and at in "]}" and "document start" in problem:
        return BadYaml(mark, f"this '{at}' closes nothing")
    return BadYaml(mark, problem, _flow_hint(problem, line))


def _nesting_hint(mark: Mark | None) -> str:
    """What to do about "linear: x: 1", and about text as "note: this"."""
    if mark and mark.line:
        return "indent fields of one message alike"
    return "put the fields of a message in { }, and text that has ': ' in it in quotes"


def _flow_hint(problem: str, line: str) -> str:
    """What to do about "a: {x: 1} b: {y: 2}", and about other marks between fields."""
    if problem == "did not find expected key" and re.search(r"[}\]]\s*,?\s*\w+\s*:", line):
        return "put all fields into { } with commas between, or each on a line of its own"
    if problem == "did not find expected key":
        return "indent fields of one message alike"
    return "put a comma between fields" if problem.startswith(_NO_COMMA) else ""


def _colon_hint(text: str) -> str:
    """What to do about "x:1", if that is what broke the YAML."""
    match = _WORD_BEFORE_COLON.search(text)
    if not match:
        return ""
    value = _WHOLE_BRACKETS.get(match[2][0], match[2])
    return f"put a space after the colon: '{match[1]}: {value}'"


def _open_bracket(error: "yaml.MarkedYAMLError", first_line: int) -> str:
    """Which bracket is not closed; the parser does not always know."""
    if not str(error.problem).startswith(_NO_COMMA):
        return f" from line {first_line} on: a bracket is not closed"
    bracket = "{" if "mapping" in str(error.context) else "["
    return f"{_place(error.context_mark, first_line)}: this '{bracket}' is not closed"


def _lines(text: str) -> int:
    """Lines up to the last that is not blank."""
    return text.rstrip().count("\n") + 1


def _line(text: str, mark: Mark | None) -> str:
    lines = text.split("\n")
    return lines[mark.line] if mark and mark.line < len(lines) else ""


def _place(mark: Mark | None, first_line: int) -> str:
    return f" at line {first_line + mark.line}, column {mark.column + 1}" if mark else ""


class _Place:
    """A place in the text, as a Mark; both count from 0."""

    def __init__(self, line: int, column: int) -> None:
        self.line = line
        self.column = column
